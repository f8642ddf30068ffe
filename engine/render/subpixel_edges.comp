#version 460
#extension GL_EXT_control_flow_attributes : require
#extension GL_GOOGLE_include_directive : require
// Subpixel reconstruction (see subpixel_edges.h), where subpixel_places.comp has listed edges.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint doubling = 0;
layout(set = 0, binding = 0, rgba8) uniform readonly image2D source;
layout(set = 0, binding = 1) uniform writeonly image2D target;
#include "engine/render/subpixel_places.glsl"
layout(set = 0, binding = 3) uniform sampler2D depth_image; // this and the next two: of the source's size
layout(set = 0, binding = 4) uniform usampler2D normals_image;
layout(set = 0, binding = 5) uniform usampler2D surface_image;
layout(set = 0, binding = 6) uniform sampler2DMS depth_samples; // this and the next: of the target's size
layout(set = 0, binding = 7) uniform sampler2DMS surface_samples;
layout(set = 0, binding = 8) uniform Camera { CameraRow camera; }; // of the source's pixels
layout(push_constant) uniform Constants {
    ivec2 source_size, target_size;
    float exposed; // from irradiance to what a white surface reflects of it, exposed
} constants;

#include "engine/render/diffuse_light.glsl"
#include "engine/render/sample_surface.glsl"

// Where Vulkan's standard places the samples of a pixel. (A device may place them elsewhere, and says so: edges are then
// off by some of the distance.)
const vec2 sample_places[4] = {vec2(0.375, 0.125), vec2(0.875, 0.375), vec2(0.125, 0.625), vec2(0.625, 0.875)};
// A sample is on the plane that it is nearest to, and on others that are farther from it by less than this: in pixels
// of the source, plus what depths and normals are rounded by, as a share of the distance.
const float tolerance_pixels = 0.1, rounding = 1e-4;
// That of another surface that emits counts as so much farther, in pixels: two may share a plane.
const float other_surface = 0.5;

// The four source pixels about a place, and the planes that they show: distance of a sample from plane i, in pixels, is
// |level[i] + across[i] * x + down[i] * y - factor[i] * depth|, with x and y from the first of the four.
struct Planes {
    vec3 colours[4];
    vec4 level, across, down, factor;
    vec4 surfaces;    // emitting_surface
    FourPixels pixels;
};

// Depth (near / distance along the axis) is linear on a plane, in the picture. Of the sky, all but depth 0 is far.
Planes planes_about(ivec2 first) {
    const float pixel_size = length(camera.right.xyz) * 2.0 / camera.forward.w; // at distance 1
    const float near = camera.position.w;
    const vec3 corner = camera_ray(camera, vec2(first) + 0.5);
    const vec3 right = camera.right.xyz * (2.0 / camera.forward.w), below = camera.down.xyz * (2.0 / camera.right.w);
    Planes planes;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 pixel = source_pixel(first, i);
        const float depth = texelFetch(depth_image, pixel, 0).r;
        const vec3 normal = unpack_normal(texelFetch(normals_image, pixel, 0).g) / pixel_size;
        const vec3 ray = camera_ray(camera, vec2(pixel) + 0.5);
        const bool sky = depth <= 0.0;
        planes.colours[i] = imageLoad(source, pixel).rgb;
        find_light(planes.pixels, i, pixel, planes.colours[i]);
        planes.surfaces[i] = emitting_surface(texelFetch(surface_image, pixel, 0).r);
        planes.level[i] = sky ? 0.0 : dot(normal, corner);
        planes.across[i] = sky ? 0.0 : dot(normal, right);
        planes.down[i] = sky ? 0.0 : dot(normal, below);
        planes.factor[i] = sky ? 1e9 / near : dot(normal, ray) / max(depth, 1e-12);
    }
    return planes;
}

// What a sample shows, at a place from the first of the four: the mean of those whose surface it is on, with its own
// albedo.
vec3 sample_colour(Planes planes, vec2 place, ivec2 pixel, int index) {
    const float depth = texelFetch(depth_samples, pixel, index).r;
    const vec4 surface = texelFetch(surface_samples, pixel, index);
    const vec4 off = abs(planes.level + planes.across * place.x + planes.down * place.y - planes.factor * depth) +
                     mix(vec4(other_surface), vec4(0.0), lessThan(abs(planes.surfaces - surface.a), vec4(0.5 / 255.0)));
    const float least = min(min(off.x, off.y), min(off.z, off.w));
    const float tolerance = tolerance_pixels + rounding * camera.forward.w / (2.0 * length(camera.right.xyz));
    vec4 shares = clamp(1.0 - (off - least) / tolerance, 0.0, 1.0) * (bilinear_shares(place) + 1e-3);
    shares /= shares.x + shares.y + shares.z + shares.w;
    return is_detailed(surface) ? detailed_colour(planes.pixels, shares, surface.rgb) : weighted(planes.colours, shares);
}

void write_one(ivec2 pixel) {
    const vec2 scale = vec2(constants.source_size) / vec2(constants.target_size);
    vec3 mean = vec3(0.0);
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const vec2 place = (vec2(pixel) + sample_places[i]) * scale - 0.5;
        const ivec2 first = ivec2(floor(place));
        mean += 0.25 * sample_colour(planes_about(first), place - vec2(first), pixel, i);
    }
    imageStore(target, pixel, vec4(mean, 1.0));
}

void write_four(ivec2 first) {
    const Planes planes = planes_about(first);
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 within = ivec2(i & 1, i >> 1), pixel = 2 * first + 1 + within;
        const ivec2 read = clamp(pixel, ivec2(0), constants.target_size - 1);
        vec3 mean = vec3(0.0);
        [[unroll]] for (int s = 0; s < 4; ++s)
            mean += 0.25 * sample_colour(planes, 0.5 * (vec2(within) + sample_places[s]), read, s);
        if (pixel == read)
            imageStore(target, pixel, vec4(mean, 1.0));
    }
}

void main() {
    const uint at = place_index();
    if (at >= places.counts[edge_list].count)
        return;
    const ivec2 place = unpack_place(places.all[at]);
    if (doubling != 0)
        write_four(place);
    else
        write_one(place);
}
