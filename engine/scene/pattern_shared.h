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

// --- Filtered: the mean over what a pixel shows -------------------------------------------------------------------
// Means over [x - width/2, x + width/2], from integrals; widths below this are as good as none.
SHARED_CONSTANT float least_pattern_width = 1e-4f;

// Of a wave that is 1 in [0, 1), -1 in [1, 2), and so on.
SHARED_FUNCTION float square_wave_integral(float x) {
    return 1.0f - abs(x - 2.0f * floor(0.5f * x) - 1.0f);
}
SHARED_FUNCTION float square_wave_mean(float place, float width) {
    const float w = max(width, least_pattern_width),
                x = place - 2.0f * floor(0.5f * place); // small: no digits are lost
    return (square_wave_integral(x + 0.5f * w) - square_wave_integral(x - 0.5f * w)) / w;
}

// Of lines at the integers, 1 within `reach` of them and else 0; soft: falling from 1 in the middle to 0 there.
SHARED_FUNCTION float line_integral(float x, float reach, bool soft) {
    const float nearest = floor(x + 0.5f);
    const float beside = max(-reach, min(x - nearest, reach));
    return soft ? reach * nearest + beside - beside * abs(beside) / (2.0f * reach) : 2.0f * reach * nearest + beside;
}
SHARED_FUNCTION float line_mean(float place, float reach, float width, bool soft) {
    const float w = max(width, least_pattern_width), x = place - floor(place);
    return (line_integral(x + 0.5f * w, reach, soft) - line_integral(x - 0.5f * w, reach, soft)) / w;
}

// Of what a pixel shows beside a joint in the middle of which two rectangles meet, the share that is the next one's.
// `apart`: from the pixel's middle to the joint's.
SHARED_FUNCTION float share_beyond_joint(float apart, float reach, float width) {
    const float half_width = 0.5f * max(width, least_pattern_width);
    const float hidden = max(min(reach, apart + half_width) - max(apart - half_width, 0.0f), 0.0f);
    const float own = half_width + min(apart, half_width) - hidden, beyond = max(half_width - apart - reach, 0.0f);
    return beyond / max(own + beyond, least_pattern_width);
}

// Rectangles of unit size, each of its own tone: over pixels that reach over an edge, or an end, into the next one.
// `shifts`: what a place in the row before, and in the row after, has as its x, beside this one.
SHARED_FUNCTION float tone_mean(vec2 place, vec2 width, vec2 reach, vec2 shifts, float layer) {
    const vec2 edge = floor(place + vec2(0.5f, 0.5f)), apart = abs(place - edge);
    const float row = floor(place.y), next_row = place.y < edge.y ? edge.y : edge.y - 1.0f;
    const float next_column = place.x < edge.x ? edge.x : edge.x - 1.0f;
    const float beside = floor(place.x + (next_row > row ? shifts.y : shifts.x));
    const float own = pattern_noise(floor(place.x), row, layer);
    return own + share_beyond_joint(apart.x, reach.x, width.x) * (pattern_noise(next_column, row, layer) - own) +
           share_beyond_joint(apart.y, reach.y, width.y) * (pattern_noise(beside, next_row, layer) - own);
}

// Rectangles with joints, `tones` at most; the same over pixels that show many.
SHARED_FUNCTION float joints_and_tones(vec2 place, vec2 width, vec2 reach, float tones, float layer, vec2 shifts) {
    const float joints = 1.0f - (1.0f - line_mean(place.x, reach.x, width.x, false)) *
                                    (1.0f - line_mean(place.y, reach.y, width.y, false));
    const float many = min(max(max(width.x, width.y) - 1.0f, 0.0f), 1.0f);
    const float tone = tones * tone_mean(place, width, reach, shifts, layer);
    const float mixed = tone + (0.5f * tones - tone) * many;
    return mixed + (1.0f - mixed) * joints;
}

// pattern_share over a pixel: `footprint`, by axis of the mesh's space, is how far it reaches there.
SHARED_FUNCTION float filtered_pattern_share(uint kind, float scale, vec3 position, vec3 normal, vec3 footprint) {
    const vec3 p = position / scale, w = footprint / scale;
    if (kind == pattern_checker)
        return 0.5f - 0.5f * square_wave_mean(p.x + 0.001f, w.x) * square_wave_mean(p.y + 0.001f, w.y) *
                          square_wave_mean(p.z + 0.001f, w.z);
    if (kind == pattern_marble) {
        // The vein's phase in halves of a turn, and how far a pixel reaches in it; veins are lines of that.
        const float bent = pattern_smooth_noise(p) + 0.5f * pattern_smooth_noise(2.1f * p);
        const float phase = (3.1f * (p.x + p.y + p.z) + 5.0f * bent) / 3.14159265f;
        const float reach = 0.1082f, width = 2.0f * max(max(w.x, w.y), w.z);
        const float sharp = 1.0f - min(1.0f, 3.0f * abs(sin(3.14159265f * phase)));
        return sharp + (line_mean(phase, reach, width, true) - sharp) * min(width / reach, 1.0f);
    }
    const vec3 facing = abs(normal);
    vec2 at = vec2(p.x, p.z), width = vec2(w.x, w.z);
    if (facing.y < max(facing.x, facing.z)) {
        at = facing.x > facing.z ? vec2(p.z, p.y) : vec2(p.x, p.y);
        width = facing.x > facing.z ? vec2(w.z, w.y) : vec2(w.x, w.y);
    }
    if (kind == pattern_planks)
        return joints_and_tones(vec2(at.x / 8.0f + 0.37f * floor(at.y), at.y), vec2(width.x / 8.0f, width.y),
                                vec2(0.03f / 8.0f, 0.03f), 0.55f, 1.0f, vec2(-0.37f, 0.37f));
    if (kind == pattern_bricks) {
        const float row = floor(at.y * 2.0f);
        const float shift = 0.5f * (row - 2.0f * floor(0.5f * row)), back = shift > 0.25f ? -0.5f : 0.5f;
        return joints_and_tones(vec2(at.x + shift, at.y * 2.0f), vec2(width.x, width.y * 2.0f), vec2(0.03f, 0.06f),
                                0.3f, 2.0f, vec2(back, back));
    }
    return 0.0f;
}

SHARED_END
#endif
