// Procedural patterns (scene::SurfacePattern): weight of the second colour at a point, for shaders and rays alike.
#ifndef SUNFLECK_ENGINE_SCENE_PATTERN_SHARED_H
#define SUNFLECK_ENGINE_SCENE_PATTERN_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_CONSTANT uint pattern_none = 0u;
SHARED_CONSTANT uint pattern_checker = 1u;
SHARED_CONSTANT uint pattern_planks = 2u;
SHARED_CONSTANT uint pattern_bricks = 3u;
SHARED_CONSTANT uint pattern_marble = 4u;

// Hash of a cell to [0, 1).
SHARED_FUNCTION float pattern_noise(float x, float y, float z) {
    const float mixed = sin(x * 12.9898f + y * 78.233f + z * 37.719f) * 43758.5453f;
    return mixed - floor(mixed);
}

// Smooth value noise with unit cells, in [0, 1).
SHARED_FUNCTION float pattern_smooth_noise(vec3 at) {
    const vec3 cell = floor(at);
    vec3 t = at - cell;
    t = t * t * (vec3(3.0f, 3.0f, 3.0f) - 2.0f * t);
    float sum = 0.0f;
    for (int i = 0; i < 8; ++i) {
        const float x = float(i & 1), y = float((i >> 1) & 1), z = float((i >> 2) & 1);
        const float weight =
            (x > 0.5f ? t.x : 1.0f - t.x) * (y > 0.5f ? t.y : 1.0f - t.y) * (z > 0.5f ? t.z : 1.0f - t.z);
        sum += weight * pattern_noise(cell.x + x, cell.y + y, cell.z + z);
    }
    return sum;
}

// `position` in the mesh's space; `normal` there says which plane the pattern lies in. `scale`: m.
SHARED_FUNCTION float pattern_share(uint kind, float scale, vec3 position, vec3 normal) {
    const vec3 p = position / scale;
    if (kind == pattern_checker) {
        const float cells = floor(p.x + 0.001f) + floor(p.y + 0.001f) + floor(p.z + 0.001f);
        return cells - 2.0f * floor(0.5f * cells);
    }
    if (kind == pattern_marble) {
        const float bent = pattern_smooth_noise(p) + 0.5f * pattern_smooth_noise(2.1f * p);
        const float vein = abs(sin(3.1f * (p.x + p.y + p.z) + 5.0f * bent));
        return 1.0f - min(1.0f, 3.0f * vein);
    }
    // Coordinates in the surface's plane: u along, v across.
    const vec3 facing = abs(normal);
    float u = p.x, v = p.z;
    if (facing.y < max(facing.x, facing.z)) {
        u = facing.x > facing.z ? p.z : p.x;
        v = p.y;
    }
    if (kind == pattern_planks) {
        // Rows one plank wide; planks eight times as long, each of its own tone, with dark joints.
        const float row = floor(v);
        const float along = u / 8.0f + 0.37f * row;
        const float tone = pattern_noise(floor(along), row, 1.0f);
        const float joint =
            min(min(v - row, row + 1.0f - v), 8.0f * min(along - floor(along), floor(along) + 1.0f - along));
        return joint < 0.03f ? 1.0f : 0.55f * tone;
    }
    if (kind == pattern_bricks) {
        const float row = floor(v * 2.0f);
        const float along = u + 0.5f * (row - 2.0f * floor(0.5f * row));
        const float joint = min(min(along - floor(along), floor(along) + 1.0f - along),
                                0.5f * min(v * 2.0f - row, row + 1.0f - v * 2.0f));
        return joint < 0.03f ? 1.0f : 0.3f * pattern_noise(floor(along), row, 2.0f);
    }
    return 0.0f;
}

SHARED_END
#endif
