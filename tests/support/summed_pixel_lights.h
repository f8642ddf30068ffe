// The sum of pixel lights by a program of its own, for the techniques that draw them.
#pragma once

#include "gi_module/transport/pixel_light.h"
#include "tests/support/gpu_world.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace sunfleck::tests {

// Irradiance that pixel lights give each pixel, W/m2, of those that give it at least `least`: the sum of
// docs/techniques, splatting, by rays through the pixels' centres. Pixels whose centre lies on an edge may show another
// surface.
inline std::vector<vec3> summed_light(GpuWorld& world, std::span<const gi::PixelLight> lights, float clamp_scale,
                                      float least = 0.0f) {
    const viewer::FrameRequest& request = world.request;
    const shared::CameraRow camera =
        scene::make_camera_row(world.renderer->space().view(request.camera), request.width, request.height);
    std::vector<vec3> sums(std::size_t(request.width) * request.height, vec3(0.0f));
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const std::size_t row = i / request.width;
        const vec2 centre(float(i % request.width) + 0.5f, float(row) + 0.5f);
        const raytrace::Ray ray{vec3(camera.position), shared::camera_ray(camera, centre), 0.0f, 1e30f};
        const auto hit = world.renderer->rays().closest_hit(ray);
        if (!hit)
            continue;
        const raytrace::SurfacePoint point = world.renderer->rays().surface(ray, *hit);
        const float side = glm::dot(point.geometric_normal, ray.direction) < 0.0f ? 1.0f : -1.0f;
        const auto add = [&](vec3 given) {
            sums[i] += std::max({given.x, given.y, given.z}) >= least ? given : vec3(0);
        };
        for (const gi::PixelLight& light : lights) {
            const vec3 way = light.position - point.position;
            const float squared = glm::dot(way, way), distance = std::sqrt(squared);
            const float arriving = glm::dot(side * point.shading_normal, way) / distance;
            if (arriving <= 0.0f || side * glm::dot(point.geometric_normal, way) <= 0.0f)
                continue;
            if (light.exponent <= 1.0f) { // softened by 0.6 of the width of a square of its area
                const float soft = 0.36f * light.area * 2.0f / clamp_scale, along = -glm::dot(light.normal, way);
                if (along > 0.0f)
                    add(light.flux / pi * std::sqrt(along * along + soft) * arriving * distance /
                        ((squared + soft) * (squared + soft)));
                continue;
            }
            // A lobe widens where it is no wider than the surface that it stands for.
            const float reach =
                light.exponent > 1.0f ? std::sqrt(0.5f * (light.exponent + 1.0f) * light.area / pi) : 0.0f;
            const float intensity = shared::pixel_light_intensity(light.axis, light.normal, light.exponent, reach,
                                                                  -way / distance, distance);
            add(light.flux * std::min(intensity * arriving / squared, clamp_scale / light.area));
        }
    }
    return sums;
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
