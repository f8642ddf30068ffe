// Which places of an enlarged picture are drawn again, as subpixel_places.comp lists them: those with edges, for
// subpixel_edges.comp, and others with textures, for texture_detail.comp. If the picture is doubled, a place is the cell
// between four of its pixels, by the first, else a pixel of the enlarged picture; x and y are 1 more, in 16 bits each.
#ifdef LISTS_PLACES
#define PLACES_ACCESS
#else
#define PLACES_ACCESS readonly
#endif
struct PlaceCount {
    uint groups[3]; // for vkCmdDispatchIndirect, row by row
    uint count;
};
layout(set = 0, binding = 2) PLACES_ACCESS buffer Places {
    PlaceCount counts[2]; // by list
    uint all[];           // edges from the front, details from the back
} places;
const uint edge_list = 0u, detail_list = 1u;
const uint places_of_group = 64u, most_groups = 65535u; // of a row: what every device can

uint pack_place(ivec2 place) { return uint(place.x + 1) | uint(place.y + 1) << 16u; }
ivec2 unpack_place(uint place) { return ivec2(place & 0xffffu, place >> 16u) - 1; }

#ifndef LISTS_PLACES
uint place_index() {
    return (gl_WorkGroupID.y * most_groups + gl_WorkGroupID.x) * places_of_group + gl_LocalInvocationIndex;
}
#endif
