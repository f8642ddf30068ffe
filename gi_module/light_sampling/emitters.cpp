#include "gi_module/light_sampling/emitters.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

// World-space direction of the entity's -Z axis.
vec3 forward_of(const mat4& matrix) {
    const vec3 axis(matrix[2]);
    const float length = glm::length(axis);
    return length > 0.0f ? -axis / length : vec3(0.0f, -1.0f, 0.0f);
}

EmittedPoint sample_mesh_point(const Emitter& emitter, float u, float v) {
    // The first number picks a triangle by area; the remainder is uniform again and picks the point.
    const float target = u * emitter.cumulative_area.back();
    const auto found = std::upper_bound(emitter.cumulative_area.begin(), emitter.cumulative_area.end(), target);
    const std::size_t triangle =
        std::min<std::size_t>(std::size_t(found - emitter.cumulative_area.begin()), emitter.cumulative_area.size() - 1);
    const float before = triangle > 0 ? emitter.cumulative_area[triangle - 1] : 0.0f;
    const float share = emitter.cumulative_area[triangle] - before;
    const float rest = share > 0.0f ? std::clamp((target - before) / share, 0.0f, 1.0f) : 0.5f;
    const float root = std::sqrt(rest);
    const vec3* p = &emitter.corners[triangle * 3];
    return {p[0] + (root * (1.0f - v)) * (p[1] - p[0]) + (root * v) * (p[2] - p[0]),
            glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])), std::uint32_t(triangle), root * (1.0f - v), root * v};
}

// Uniform in the outer cone, weighted by the falloff.
EmittedRay sample_spot_ray(const Emitter& emitter, const float numbers[4]) {
    EmittedRay ray;
    const vec3 axis = forward_of(emitter.matrix);
    const float cosine = 1.0f - numbers[2] * (1.0f - emitter.outer_cosine);
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), angle = 2.0f * pi * numbers[3];
    vec3 side, up;
    orthonormal_basis(axis, side, up);
    float scale, offset;
    spot_cone(emitter, scale, offset);
    const float falloff = std::clamp(cosine * scale + offset, 0.0f, 1.0f);
    ray.origin = vec3(emitter.matrix[3]);
    ray.direction = cosine * axis + sine * (std::cos(angle) * side + std::sin(angle) * up);
    ray.weight = falloff * falloff * 2.0f * pi * (1.0f - emitter.outer_cosine) / spot_solid_angle(emitter);
    return ray;
}

// From a disc that covers the scene's bounding sphere.
EmittedRay sample_distant_ray(const Emitter& emitter, const float numbers[4]) {
    EmittedRay ray;
    if (emitter.kind == EmitterKind::directional) {
        ray.direction = forward_of(emitter.matrix);
    } else if (emitter.map.image) {
        const scene::EnvironmentImage::Draw drawn = emitter.map.image->draw(numbers[2], numbers[3]);
        ray.direction = -emitter.map.to_world(drawn.direction);
        // Radiance over density, relative to the mean over the sphere, which `flux` is made from.
        const vec3 mean = 4.0f * pi * emitter.map.image->mean();
        for (int c = 0; c < 3; ++c)
            ray.tint[c] = mean[c] > 0.0f && drawn.density > 0.0f ? drawn.radiance[c] / (drawn.density * mean[c]) : 0.0f;
    } else {
        ray.direction = sample_sphere_direction(numbers[2], numbers[3]);
    }
    vec3 side, up;
    orthonormal_basis(ray.direction, side, up);
    const float r = emitter.scene_radius * std::sqrt(numbers[0]), angle = 2.0f * pi * numbers[1];
    ray.origin = emitter.scene_centre - emitter.scene_radius * 1.01f * ray.direction +
                 r * (std::cos(angle) * side + std::sin(angle) * up);
    return ray;
}

} // namespace

EmittedPoint sample_emitter_point(const Emitter& emitter, float u, float v) {
    const vec3 origin(emitter.matrix[3]);
    const auto axis = [&](int i) {
        const vec3 a(emitter.matrix[i]);
        return a / std::max(glm::length(a), 1e-30f);
    };
    switch (emitter.kind) {
    case EmitterKind::rectangle:
        return {origin + axis(0) * (emitter.width * (u - 0.5f)) + axis(1) * (emitter.height * (v - 0.5f)),
                glm::normalize(glm::cross(axis(0), axis(1)))};
    case EmitterKind::disc: {
        const float r = emitter.radius * std::sqrt(u), angle = 2.0f * pi * v;
        return {origin + axis(0) * (r * std::cos(angle)) + axis(1) * (r * std::sin(angle)),
                glm::normalize(glm::cross(axis(0), axis(1)))};
    }
    case EmitterKind::sphere: {
        const vec3 normal = sample_sphere_direction(u, v);
        return {origin + emitter.radius * normal, normal};
    }
    case EmitterKind::mesh:
        return sample_mesh_point(emitter, u, v);
    default:
        return {origin, forward_of(emitter.matrix)};
    }
}

vec3 sample_cosine_direction(vec3 normal, float u, float v) {
    // A point on the unit sphere about the normal's tip: directions to such points are cosine-weighted.
    const vec3 direction = normal + sample_sphere_direction(u, v);
    const float length = glm::length(direction);
    return length > 1e-4f ? direction / length : normal;
}

vec3 sample_sphere_direction(float u, float v) {
    const float z = 1.0f - 2.0f * u, r = std::sqrt(std::max(0.0f, 1.0f - z * z)), angle = 2.0f * pi * v;
    return {r * std::cos(angle), r * std::sin(angle), z};
}

// With x = (cos - outer) / (inner - outer) the square falloff
// between the cones integrates to a third of their difference in cosine.
float spot_solid_angle(const Emitter& emitter) {
    return 2.0f * pi * (1.0f - emitter.inner_cosine + (emitter.inner_cosine - emitter.outer_cosine) / 3.0f);
}

void spot_cone(const Emitter& emitter, float& scale, float& offset) {
    scale = 1.0f / std::max(emitter.inner_cosine - emitter.outer_cosine, 1e-3f);
    offset = -emitter.outer_cosine * scale;
}

EmittedRay sample_emitter_ray(const Emitter& emitter, const float numbers[4]) {
    EmittedRay ray;
    switch (emitter.kind) {
    case EmitterKind::point:
        ray.origin = vec3(emitter.matrix[3]);
        ray.direction = sample_sphere_direction(numbers[2], numbers[3]);
        return ray;
    case EmitterKind::spot:
        return sample_spot_ray(emitter, numbers);
    case EmitterKind::directional:
    case EmitterKind::environment:
        return sample_distant_ray(emitter, numbers);
    default: {
        const EmittedPoint point = sample_emitter_point(emitter, numbers[0], numbers[1]);
        ray.origin = point.position;
        ray.normal = point.normal;
        ray.direction = sample_cosine_direction(point.normal, numbers[2], numbers[3]);
        return ray;
    }
    }
}

} // namespace sunfleck::gi
