#version 460
#extension GL_EXT_control_flow_attributes : require
#extension GL_GOOGLE_include_directive : require
// Textures and patterns at the target's size (see subpixel_edges.h), where subpixel_places.comp has listed them and
// no edge: one sample a pixel.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint doubling = 0;
layout(set = 0, binding = 0, rgba8) uniform readonly image2D source;
layout(set = 0, binding = 1) uniform writeonly image2D target;
#include "engine/render/subpixel_places.glsl"
layout(set = 0, binding = 5) uniform usampler2D surface_image; // of the source's size
layout(set = 0, binding = 7) uniform sampler2DMS surface_samples; // of the target's
layout(push_constant) uniform Constants {
    ivec2 source_size, target_size;
    float exposed; // from irradiance to what a white surface reflects of it, exposed
} constants;

#include "engine/render/diffuse_light.glsl"
#include "engine/render/sample_surface.glsl"

bool are_of_one_surface(ivec2 first) {
    uint surfaces[4];
    [[unroll]] for (int i = 0; i < 4; ++i)
        surfaces[i] = texelFetch(surface_image, source_pixel(first, i), 0).r;
    return surfaces[0] == surfaces[1] && surfaces[0] == surfaces[2] && surfaces[0] == surfaces[3];
}

// `place`: from the first of the four pixels about it.
void write(FourPixels pixels, vec2 place, ivec2 pixel) {
    const vec4 surface = texelFetch(surface_samples, pixel, 0);
    if (is_detailed(surface))
        imageStore(target, pixel, vec4(detailed_colour(pixels, bilinear_shares(place), surface.rgb), 1.0));
}

void main() {
    const uint at = place_index();
    if (at >= places.counts[detail_list].count)
        return;
    const ivec2 listed = unpack_place(places.all[places.all.length() - 1 - at]);
    const vec2 place = (vec2(listed) + 0.5) * vec2(constants.source_size) / vec2(constants.target_size) - 0.5;
    const ivec2 first = doubling != 0 ? listed : ivec2(floor(place));
    if (!are_of_one_surface(first))
        return; // which of them a pixel shows, planes would have to tell; and without contrast, it hardly shows
    FourPixels pixels;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 pixel = source_pixel(first, i);
        find_light(pixels, i, pixel, imageLoad(source, pixel).rgb);
    }
    if (doubling == 0) {
        write(pixels, place - vec2(first), listed);
        return;
    }
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 within = ivec2(i & 1, i >> 1), pixel = 2 * first + 1 + within;
        if (pixel == clamp(pixel, ivec2(0), constants.target_size - 1))
            write(pixels, 0.25 + 0.5 * vec2(within), pixel);
    }
}
