// One row of the instance buffer, as shaders read it.
#ifndef SUNFLECK_ENGINE_SCENE_INSTANCE_SHARED_H
#define SUNFLECK_ENGINE_SCENE_INSTANCE_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

struct InstanceRow {
    mat4 model;          //   0: object to world
    mat4 previous_model; //  64: the same in the previous frame
    mat4 normal_matrix;  // 128: cofactors of `model`, for normals (upper 3x3)
    vec4 base_colour;    // 192: rgb
    vec4 emission;       // 208: rgb, radiance W/(sr m2); w: 1 for the surface of an AreaLight
    vec4 pattern;        // 224: rgb of the second colour; w: scale, m
    uvec4 material;      // 240: x: row of the material buffer, for textured surfaces; y: material_unlit and the like;
                         // z: metallic and roughness, 16 bits each; w: bits of the coat's index of refraction, 0: none
};

SHARED_CONSTANT uint material_unlit = 1u;
SHARED_CONSTANT uint material_moves = 2u;    // the instance is a mover
SHARED_CONSTANT uint material_stippled = 4u; // alpha mode blend

// A surface id in the G-buffer: instance row + 1 in the low bits; 0 for the background.
SHARED_CONSTANT uint surface_row_mask = 0x07ffffffu;
SHARED_CONSTANT uint surface_area_light = 0x80000000u; // the surface of an AreaLight
SHARED_CONSTANT uint surface_emits = 0x40000000u;      // its material emits
SHARED_CONSTANT uint surface_unlit = 0x20000000u;      // shows its base colour, unaffected by light
SHARED_CONSTANT uint surface_glossy = 0x10000000u;     // reflects by microfacets, as metal or under a coat
SHARED_CONSTANT uint surface_stippled = 0x08000000u;   // lets light through, and is drawn at a share of its pixels

// What drawing one instance into the G-buffer needs of its row, as push constants: a CPU device reads those once per
// draw, but a buffer once per vertex or pixel.
struct DrawConstants {
    vec4 model[3];         //  0: rows of the model matrix, object to world
    vec4 normal_colour[3]; // 48: columns of the normal matrix; w: red, green, blue of the base colour
    vec4 emission;         // 96: rgb, radiance W/(sr m2)
    uint surface;          // 112: surface id, as above
    uint gloss;            // 116: metallic and roughness, as in InstanceRow
};

// Row of a surface id that is not 0.
SHARED_FUNCTION uint surface_row(uint surface) {
    return (surface & surface_row_mask) - 1u;
}
SHARED_FUNCTION vec3 base_colour_of(DrawConstants draw) {
    return vec3(draw.normal_colour[0].w, draw.normal_colour[1].w, draw.normal_colour[2].w);
}

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::InstanceRow) == 256);
static_assert(sizeof(sunfleck::shared::DrawConstants) == 120);
#endif
#endif
