#include "gi_module/reference/surface_distance.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"
#include "gi_module/light_sampling/emitters.h"

#include <algorithm>

namespace sunfleck::gi::reference {

namespace {

float distance_to_others(const raytrace::RayScene& rays, const raytrace::Ray& view, std::uint32_t directions) {
    const auto hit = rays.closest_hit(view);
    if (!hit)
        return 0.0f;
    const raytrace::SurfacePoint point = rays.surface(view, *hit);
    const float side = glm::dot(point.geometric_normal, view.direction) < 0.0f ? 1.0f : -1.0f;
    const vec3 normal = side * point.geometric_normal;
    float nearest = 1e30f;
    for (std::uint32_t k = 0; k < directions; ++k) {
        const SobolGroup numbers(1, k, 0);
        vec3 direction = sample_sphere_direction(to_unit_float(numbers.bits(0)), to_unit_float(numbers.bits(1)));
        if (glm::dot(direction, normal) < 0.0f)
            direction = -direction;
        const raytrace::Ray ray{point.on_triangle + point.offset * normal, direction, 0.0f, nearest};
        if (const auto found = rays.closest_hit(ray))
            nearest = found->distance;
    }
    return nearest;
}

} // namespace

std::vector<float> surface_distances(const raytrace::RayScene& rays, const scene::CameraView& camera,
                                     std::uint32_t width, std::uint32_t height, std::uint32_t directions) {
    const shared::CameraRow row = scene::make_camera_row(camera, width, height);
    std::vector<float> distances(std::size_t(width) * height, 0.0f);
    parallel_for_chunks(distances.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t line = i / width;
            const vec2 centre(float(i % width) + 0.5f, float(line) + 0.5f);
            const raytrace::Ray view{vec3(row.position), shared::camera_ray(row, centre), 0.0f, 1e30f};
            distances[i] = distance_to_others(rays, view, directions);
        }
    });
    return distances;
}

} // namespace sunfleck::gi::reference
