#version 460
#extension GL_EXT_control_flow_attributes : require
#extension GL_GOOGLE_include_directive : require
// A bilinear enlargement, which says where edges and textures are that it does not show: see subpixel_edges.h.

// Twice the size is the usual case: there, four pixels share the four that they are made of.
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint doubling = 0;
layout(set = 0, binding = 0, rgba8) uniform readonly image2D source;
layout(set = 0, binding = 1) uniform writeonly image2D target;
#define LISTS_PLACES
#include "engine/render/subpixel_places.glsl"
layout(set = 0, binding = 3) uniform sampler2D albedo_image;      // of the source's size
layout(set = 0, binding = 4) uniform sampler2DMS surface_samples; // of the target's
layout(push_constant) uniform Constants {
    ivec2 source_size, target_size;
} constants;

#include "engine/render/four_pixels.glsl"
#include "engine/render/sample_surface.glsl"

// Display values that differ by less than this show no edge; square roots of albedo, no texture.
const float least_contrast = 1.0 / 32.0, least_detail = 1.0 / 256.0;

struct Pixels {
    vec3 colours[4];
    vec3 roots[4]; // of albedo
};

Pixels pixels_about(ivec2 first) {
    Pixels pixels;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 pixel = source_pixel(first, i);
        pixels.colours[i] = imageLoad(source, pixel).rgb;
        pixels.roots[i] = texelFetch(albedo_image, pixel, 0).rgb;
    }
    return pixels;
}

// Writes a pixel of the target, `place` from the first of the four. True if it shows another albedo than they do.
bool write(Pixels pixels, vec2 place, ivec2 pixel) {
    const vec4 shares = bilinear_shares(place);
    if (all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, constants.target_size)))
        imageStore(target, pixel, vec4(weighted(pixels.colours, shares), 1.0));
    const vec4 surface = texelFetch(surface_samples, clamp(pixel, ivec2(0), constants.target_size - 1), 0);
    const vec3 difference = abs(surface.rgb - weighted(pixels.roots, shares));
    return is_detailed(surface) && any(greaterThan(difference, vec3(least_detail)));
}

// The next index in a list. Counts its groups of work, too.
uint next_in(uint list) {
    const uint at = atomicAdd(places.counts[list].count, 1u), group = at / places_of_group;
    if (at % places_of_group == 0u && group < most_groups)
        atomicAdd(places.counts[list].groups[0], 1u);
    else if (at % places_of_group == 0u)
        atomicMax(places.counts[list].groups[1], group / most_groups + 1u);
    return at;
}

void list_place(ivec2 place, vec3 contrast, bool has_detail) {
    const uint packed = pack_place(place);
    if (max(contrast.r, max(contrast.g, contrast.b)) >= least_contrast)
        places.all[next_in(edge_list)] = packed;
    else if (has_detail)
        places.all[places.all.length() - 1 - next_in(detail_list)] = packed;
}

void write_one(ivec2 pixel) {
    if (any(greaterThanEqual(pixel, constants.target_size)))
        return;
    const vec2 scale = vec2(constants.source_size) / vec2(constants.target_size);
    const vec2 place = (vec2(pixel) + 0.5) * scale - 0.5;
    const ivec2 first = ivec2(floor(place)), from = ivec2(floor(vec2(pixel) * scale - 0.5));
    const bool has_detail = write(pixels_about(first), place - vec2(first), pixel);
    vec3 lowest = vec3(1.0), highest = vec3(0.0);
    [[unroll]] for (int i = 0; i < 9; ++i) { // all that its samples lie between
        const vec3 colour = imageLoad(source, clamp(from + ivec2(i % 3, i / 3), ivec2(0), constants.source_size - 1)).rgb;
        lowest = min(lowest, colour);
        highest = max(highest, colour);
    }
    list_place(pixel, highest - lowest, has_detail);
}

void write_four(ivec2 first) {
    if (any(greaterThanEqual(first, constants.source_size)))
        return;
    const Pixels pixels = pixels_about(first);
    bool has_detail = false;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 within = ivec2(i & 1, i >> 1);
        has_detail = write(pixels, 0.25 + 0.5 * vec2(within), 2 * first + 1 + within) || has_detail;
    }
    const vec3 lowest = min(min(pixels.colours[0], pixels.colours[1]), min(pixels.colours[2], pixels.colours[3]));
    const vec3 highest = max(max(pixels.colours[0], pixels.colours[1]), max(pixels.colours[2], pixels.colours[3]));
    list_place(first, highest - lowest, has_detail);
}

void main() {
    const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (doubling != 0)
        write_four(place - 1);
    else
        write_one(place);
}
