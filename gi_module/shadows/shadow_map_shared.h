#ifndef SUNFLECK_GI_SHADOWS_SHADOW_MAP_SHARED_H
#define SUNFLECK_GI_SHADOWS_SHADOW_MAP_SHARED_H
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

// One instance of a draw: an occluder seen from one light through one face. Instance attributes hold all that a vertex
// needs: a CPU device reads those once for all lanes, but buffers once per lane.
struct ShadowJob {
    vec4 x, y, w;    // clip position = dot(row, (p, 1)) of point p in the occluder's space; see octahedral_map.h
    vec4 z;          // the same for light-space z; for directional lights, depth
    vec4 tile;       // xy: centre, z: scale of the part of the map that is drawn (MapTile); w: by how much faces are
                     // drawn wider, in w, see shadow_projection.glsl
    uint layer_face; // layer of the staging image in the low 16 bits, face in bits 16 to 19, light class from bit 20
    uint row;        // instance row of the occluder
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::ShadowJob) == 88);
#endif
#endif
