// Where a picture that is enlarged shows edges, as upscale.comp lists them for subpixel_edges.comp: cells between four
// of its pixels, by the first, if it is doubled, or pixels of the enlarged picture. x and y are 1 more, in 16 bits each.
#ifdef LISTS_EDGES
#define PLACES_ACCESS
#else
#define PLACES_ACCESS readonly
#endif
layout(set = 0, binding = 2) PLACES_ACCESS buffer Places {
    uint groups[3]; // for vkCmdDispatchIndirect, row by row
    uint count;
    uint places[];
} edges;
const uint places_of_group = 64u, most_groups = 65535u; // of a row: what every device can
