// A light sample (VPL) as shaders read it.
#ifndef SUNFLECK_GI_TRANSPORT_LIGHT_ROW_SHARED_H
#define SUNFLECK_GI_TRANSPORT_LIGHT_ROW_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// Samples are classed by how they radiate; a dispatch processes one class, so that its inner loop does not branch.
SHARED_CONSTANT uint light_class_surface = 0u;     // cosine lobe, hemispherical map
SHARED_CONSTANT uint light_class_point = 1u;       // point and spot lights, spherical map or map of a cone
SHARED_CONSTANT uint light_class_directional = 2u; // parallel light, orthographic map

struct LightRow {
    vec4 position_bound; //  0: xyz; w: bound of the geometry term, 1/m2 (surface class); scale of the cone's map or 0:
                         //  spherical map (point class)
    vec4 normal_offset;  // 16: xyz: axis; w: cone offset (point class), 1 / (2 * radius) (directional class)
    vec4 intensity_slot; // 32: rgb: radiant intensity on the axis W/sr, or irradiance W/m2; w: shadow map slot
    vec4 tangent_scale;  // 48: xyz: first axis of the map; w: cone scale (point), 1 / radius (directional)
    vec4 bitangent;      // 64: xyz: second axis of the map; w: how far movers have moved since the map was drawn, m
};

SHARED_CONSTANT uint lights_per_batch = 512u; // 40 KiB: within the uniform buffer range of every supported device

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::LightRow) == 80);
#endif
#endif
