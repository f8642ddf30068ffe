// One row of the material buffer: the data of a textured surface beyond its InstanceRow.
#ifndef SUNFLECK_ENGINE_SCENE_MATERIAL_SHARED_H
#define SUNFLECK_ENGINE_SCENE_MATERIAL_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// Texture transform: matrix (columns) and offset of the coordinates, and which set.
struct TextureRow {
    vec4 matrix;
    vec4 offset_set; // xy offset; z: 0 or 1, the set
};

struct MaterialRow {
    TextureRow base_colour;
    TextureRow normal;
    TextureRow emission;
    TextureRow metallic_roughness;
    vec4 factors; // x: alpha; y: what alpha is compared with (mask: the cutoff; blend: -1, stippled);
                  // z: scale of the normal map, 0 without one; w: 1 if emission has a texture
};

SHARED_FUNCTION vec2 texture_place(TextureRow row, vec4 coordinates) {
    const float u = row.offset_set.z < 0.5f ? coordinates.x : coordinates.z;
    const float v = row.offset_set.z < 0.5f ? coordinates.y : coordinates.w;
    return vec2(row.matrix.x * u + row.matrix.z * v + row.offset_set.x,
                row.matrix.y * u + row.matrix.w * v + row.offset_set.y);
}

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::MaterialRow) == 144);
#endif
#endif
