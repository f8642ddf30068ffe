#ifndef SUNFLECK_GI_MANY_LIGHT_LIGHT_MAPS_SHARED_H
#define SUNFLECK_GI_MANY_LIGHT_LIGHT_MAPS_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// What happens to a part of one patch's light map, or of a chart of a curved surface (baked light): its texels are
// cleared or kept, then samples are added and subtracted.
struct LightMapJob {
    vec4 corner; // flat: world space
    vec4 u_edge;
    vec4 v_edge;
    vec4 normal;
    vec4 height;      // curved: what of a point's place counts as height, and what is added
    uint first_point; // curved: of its CurvedPoints; flat: no_points
    float cell;       // curved: side of a cell in units of height
    uint unused[2];
    uint first_texel;
    uint columns;
    uint rows;
    uint clear;
    uint first_change;
    uint change_count;
    uint first; // which of its texels: large maps with many changes are several jobs
    uint count;
};

SHARED_CONSTANT uint no_points = 0xffffffffu;

// A change is a sample's row, and perhaps:
SHARED_CONSTANT uint light_map_subtract = 0x80000000u; // subtract it instead of adding it
SHARED_CONSTANT uint light_map_test = 0x40000000u;     // baked light: only where the static shadow map lets it pass
SHARED_CONSTANT uint light_map_sample_mask = 0x3fffffffu;

struct LightMapConstants {
    float fixed_point; // steps per W/m2
    uint jobs;         // work groups lie in rows: a dispatch is limited in each direction
    uint row_length;
    uint map_resolution;   // baked light
    float roughness_limit; // baked light
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::LightMapJob) == 128);
#endif
#endif
