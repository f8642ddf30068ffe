#ifndef SUNFLECK_GI_SHADOWS_SHADOW_MAP_SHARED_H
#define SUNFLECK_GI_SHADOWS_SHADOW_MAP_SHARED_H
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

// One instance of a draw: an occluder seen from one light through one face.
struct ShadowJob {
    uint layer_face; // layer of the staging image in the low 16 bits, face in bits 16 to 19, light class from bit 20
    uint row;        // instance row of the occluder
};

struct ShadowConstants {
    float half_texel_margin; // faces are drawn this much wider (in w), see shadow_map.vert
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::ShadowJob) == 8);
#endif
#endif
