// Where a picture that is enlarged shows edges, as upscale.comp lists them for subpixel_edges.comp: cells between four
// of its pixels, by the first, if it is doubled, or pixels of the enlarged picture. x and y are 1 more, in 16 bits each.
#ifdef LISTS_EDGES
#define PLACES_ACCESS
#else
#define PLACES_ACCESS readonly
#endif
layout(set = 0, binding = 2) PLACES_ACCESS buffer Places {
    uint groups[3]; // of 64 places each, for vkCmdDispatchIndirect
    uint count;
    uint places[];
} edges;
