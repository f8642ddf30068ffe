#ifndef SUNFLECK_GI_SHADOWS_SHADOW_MAP_SHARED_H
#define SUNFLECK_GI_SHADOWS_SHADOW_MAP_SHARED_H
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

// One instance of a draw: an occluder seen from one light through one face. Instance attributes hold all that a vertex
// needs: a CPU device reads those once for all lanes, but buffers once per lane.
struct ShadowJob {
    vec4 x, y, w;    // clip position = dot(row, (p, 1)) of point p in the occluder's space; see octahedral_map.h
    vec4 z;          // the same for light-space z; for directional lights, depth
    uint layer_face; // layer of the staging image in the low 16 bits, face in bits 16 to 19, light class from bit 20
    uint row;        // instance row of the occluder
};

struct ShadowConstants {
    float half_texel_margin; // faces are drawn this much wider (in w), see shadow_projection.glsl
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::ShadowJob) == 72);
#endif
#endif
