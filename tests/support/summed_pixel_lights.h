// The sum of pixel lights by a program of its own, for the techniques that draw them.
#pragma once

#include "gi_module/transport/pixel_light.h"
#include "tests/support/gpu_world.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace sunfleck::tests {

// What each pixel light gives each pixel, W/m2, by rays through the pixels' centres: `visit(pixel, given)`. Pixels
// whose centre lies on an edge may show another surface.
template <typename Visit>
void for_each_light(GpuWorld& world, std::span<const gi::PixelLight> lights, float clamp_scale, const Visit& visit) {
    const viewer::FrameRequest& request = world.request;
    const shared::CameraRow camera =
        scene::make_camera_row(world.renderer->space().view(request.camera), request.width, request.height);
    for (std::size_t i = 0; i < std::size_t(request.width) * request.height; ++i) {
        const std::size_t row = i / request.width;
        const vec2 centre(float(i % request.width) + 0.5f, float(row) + 0.5f);
        const raytrace::Ray ray{vec3(camera.position), shared::camera_ray(camera, centre), 0.0f, 1e30f};
        const auto hit = world.renderer->rays().closest_hit(ray);
        if (!hit)
            continue;
        const raytrace::SurfacePoint point = world.renderer->rays().surface(ray, *hit);
        const float side = glm::dot(point.geometric_normal, ray.direction) < 0.0f ? 1.0f : -1.0f;
        for (const gi::PixelLight& light : lights) {
            const vec3 way = light.position - point.position;
            const float squared = glm::dot(way, way), distance = std::sqrt(squared);
            const float arriving = glm::dot(side * point.shading_normal, way) / distance;
            if (arriving <= 0.0f || side * glm::dot(point.geometric_normal, way) <= 0.0f)
                continue;
            if (light.exponent <= 1.0f) { // softened by 0.6 of the width of a square of its area
                const float soft = 0.36f * light.area * 2.0f / clamp_scale, along = -glm::dot(light.normal, way);
                if (along > 0.0f)
                    visit(i, light.flux / pi * std::sqrt(along * along + soft) * arriving * distance /
                                 ((squared + soft) * (squared + soft)));
                continue;
            }
            // A lobe widens where it is no wider than the surface that it stands for.
            const float reach =
                light.exponent > 1.0f ? std::sqrt(0.5f * (light.exponent + 1.0f) * light.area / pi) : 0.0f;
            const float intensity = shared::pixel_light_intensity(light.axis, light.normal, light.exponent, reach,
                                                                  -way / distance, distance);
            visit(i, light.flux * std::min(intensity * arriving / squared, clamp_scale / light.area));
        }
    }
}

inline bool is_above(vec3 given, float least) {
    return std::max({given.x, given.y, given.z}) >= least;
}

// Irradiance that pixel lights give each pixel, W/m2, of those that give it at least `least`: the sum of
// docs/techniques, splatting.
inline std::vector<vec3> summed_light(GpuWorld& world, std::span<const gi::PixelLight> lights, float clamp_scale,
                                      float least = 0.0f) {
    std::vector<vec3> sums(std::size_t(world.request.width) * world.request.height, vec3(0.0f));
    for_each_light(world, lights, clamp_scale,
                   [&](std::size_t pixel, vec3 given) { sums[pixel] += is_above(given, least) ? given : vec3(0); });
    return sums;
}

// How many times a light gives a pixel at least `least`: the evaluations that a threshold leaves at best.
inline double pairs_above(GpuWorld& world, std::span<const gi::PixelLight> lights, float clamp_scale, float least) {
    double count = 0.0;
    for_each_light(world, lights, clamp_scale,
                   [&](std::size_t, vec3 given) { count += is_above(given, least) ? 1.0 : 0.0; });
    return count;
}

// Of those that show a surface. Pictures, and fluxes in maps, have 16 bits a channel, 0.1 %.
inline double share_of_equal_pixels(const io::Picture& picture, const std::vector<vec3>& expected) {
    std::size_t equal = 0, all = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (picture.pixels[i].w <= 0.0f)
            continue;
        ++all;
        equal += glm::length(vec3(picture.pixels[i]) - expected[i]) <= 0.003f * glm::length(expected[i]) + 1e-5f;
    }
    return double(equal) / double(all);
}

} // namespace sunfleck::tests
