#ifndef SUNFLECK_GI_MANY_LIGHT_LIGHT_MAPS_SHARED_H
#define SUNFLECK_GI_MANY_LIGHT_LIGHT_MAPS_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// An update of a part of one patch's light map, or of a curved surface's chart (baked light): texels are cleared or
// kept, then samples are added and subtracted.
struct LightMapJob {
    vec4 corner; // flat: world space
    vec4 u_edge;
    vec4 v_edge;
    vec4 normal;
    vec4 height;      // curved: height = dot(height, (position, 1))
    uint first_point; // curved: first of its CurvedPoints; flat: no_points
    float cell;       // curved: side of a cell in height units
    uint unused[2];
    uint first_texel;
    uint columns;
    uint rows;
    uint clear; // of a job that finishes cells: 1 if rough cells are marked again
    uint first_change;
    uint change_count;
    uint first; // first of the texels to update: large maps with many changes are split into several jobs
    uint count;
};

SHARED_CONSTANT uint no_points = 0xffffffffu;

// A change is the index of a sample's row, with these flags:
SHARED_CONSTANT uint light_map_subtract = 0x80000000u; // subtract it instead of adding it
SHARED_CONSTANT uint light_map_test = 0x40000000u;     // baked light: shadow-tested against the static shadow map
// The row after the sample's is the same sample with the intensity that it had, which is subtracted: what reaches a
// texel of the two is computed once.
SHARED_CONSTANT uint light_map_replace = 0x20000000u;
SHARED_CONSTANT uint light_map_sample_mask = 0x1fffffffu;

struct LightMapConstants {
    float fixed_point; // steps per W/m2
    uint jobs;         // a work group each, in rows since a dispatch is limited in each direction
    uint row_length;
    uint map_resolution;   // baked light
    float roughness_limit; // baked light
    uint refined;          // baked light: 1 if cells are judged by refined light
    float inset;           // baked light: columns that its outermost texels are moved inwards
};

// Of refined_light.comp.
struct RefinedLightConstants {
    uint texels;
    uint row_length; // texels of a row of work groups, since a dispatch is limited in each direction
    float own_steps; // of the frame's samples' sums, to a step of refined ones
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::LightMapJob) == 128);
#endif
#endif
