#include "gi_module/light_sampling/emitters.h"

#include "engine/core/log.h"

#include <algorithm>
#include <set>

namespace sunfleck::gi {
namespace {

bool usable(vec3 value) {
    return is_finite(value) && value.x >= 0.0f && value.y >= 0.0f && value.z >= 0.0f;
}

void warn_once(ecs::Entity entity, const char* what) {
    static std::set<EntityBits> warned;
    if (warned.insert(entity.bits()).second)
        log_warning("light of entity " + std::to_string(entity.index) + " is ignored: " + what);
}

// Integral of the cone's falloff over the sphere, sr. With x = (cos - outer) / (inner - outer) the square falloff
// between the cones integrates to a third of their difference in cosine.
float spot_solid_angle(const Emitter& emitter) {
    return 2.0f * pi * (1.0f - emitter.inner_cosine + (emitter.inner_cosine - emitter.outer_cosine) / 3.0f);
}

Emitter area_light(const scene::AreaLight& light, const mat4& matrix) {
    Emitter emitter;
    const float scale_x = glm::length(vec3(matrix[0])), scale_y = glm::length(vec3(matrix[1]));
    emitter.radiance = light.radiance;
    switch (light.shape) {
    case scene::AreaShape::rectangle:
        emitter.kind = EmitterKind::rectangle;
        emitter.width = light.width * scale_x;
        emitter.height = light.height * scale_y;
        emitter.area = emitter.width * emitter.height;
        break;
    case scene::AreaShape::disc:
        emitter.kind = EmitterKind::disc;
        emitter.radius = light.radius * scale_x;
        emitter.area = pi * emitter.radius * emitter.radius;
        break;
    case scene::AreaShape::sphere:
        emitter.kind = EmitterKind::sphere;
        emitter.radius = light.radius * scale_x;
        emitter.area = 4.0f * pi * emitter.radius * emitter.radius;
        break;
    }
    return emitter;
}

Emitter mesh_light(const scene::Mesh& mesh, const scene::Material& material, const mat4& matrix) {
    Emitter emitter;
    emitter.kind = EmitterKind::mesh;
    emitter.radiance = material.emission;
    const bool mirrored = glm::determinant(mat3(matrix)) < 0.0f;
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        vec3 p[3];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = vec3(matrix * vec4(mesh.positions[mesh.indices[i + k]], 1.0f));
        if (mirrored)
            std::swap(p[1], p[2]);
        sum += 0.5 * double(glm::length(glm::cross(p[1] - p[0], p[2] - p[0])));
        emitter.corners.insert(emitter.corners.end(), {p[0], p[1], p[2]});
        emitter.cumulative_area.push_back(float(sum));
    }
    emitter.area = float(sum);
    return emitter;
}

// Direction of an entity's -Z axis.
vec3 forward_of(const mat4& matrix) {
    const vec3 axis(matrix[2]);
    const float length = glm::length(axis);
    return length > 0.0f ? -axis / length : vec3(0.0f, -1.0f, 0.0f);
}

} // namespace

std::vector<Emitter> collect_emitters(ecs::Registry& registry, const scene::MeshStore& meshes, const Bounds& scene,
                                      const std::set<ecs::Entity>& keep_dark) {
    std::vector<Emitter> emitters;
    const float radius = std::max(0.5f * glm::length(scene.extent()), 1e-3f);
    const vec3 centre = scene.empty() ? vec3(0.0f) : scene.centre();
    const auto add = [&](ecs::Entity entity, Emitter emitter, const mat4& matrix) {
        emitter.entity = entity;
        emitter.matrix = matrix;
        emitter.scene_radius = radius;
        emitter.scene_centre = centre;
        emitter.is_lamp = registry.has<scene::AreaLight>(entity);
        const bool area_kind = emitter.kind <= EmitterKind::mesh;
        if (area_kind)
            emitter.flux = pi * emitter.area * emitter.radiance;
        if (!usable(emitter.radiance) || !usable(emitter.intensity) || !is_finite(emitter.flux)) {
            warn_once(entity, "its strength is negative, infinite or not a number");
            return;
        }
        if (area_kind && emitter.radiance != vec3(0.0f) && !(emitter.area > 0.0f))
            warn_once(entity, "its emitter has no area");
        emitter.moves = !scene::is_static(registry, entity);
        if (luminance(emitter.flux) > 0.0f || (keep_dark.count(entity) && (!area_kind || emitter.area > 0.0f)))
            emitters.push_back(std::move(emitter));
    };
    registry.view<scene::AreaLight, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::AreaLight& light, const scene::WorldTransform& world) {
            // A sphere that has a mesh is sampled on that mesh (of the same area): rays and maps see the mesh.
            const scene::MeshInstance* instance = registry.try_get<scene::MeshInstance>(entity);
            if (light.shape == scene::AreaShape::sphere && instance != nullptr && instance->mesh < meshes.size()) {
                scene::Material material;
                material.emission = light.radiance;
                add(entity, mesh_light(meshes[instance->mesh], material, world.matrix), world.matrix);
                return;
            }
            add(entity, area_light(light, world.matrix), world.matrix);
        });
    registry.view<scene::Material, scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::Material& material, const scene::MeshInstance& instance,
            const scene::WorldTransform& world) {
            if (registry.has<scene::AreaLight>(entity) ||
                (material.emission == vec3(0.0f) && !keep_dark.count(entity)) || instance.mesh >= meshes.size())
                return;
            Emitter emitter = mesh_light(meshes[instance.mesh], material, world.matrix);
            if (const auto* textures = registry.try_get<scene::MaterialTextures>(entity);
                textures && textures->emission) {
                emitter.radiance *= textures->emission_average;
                emitter.textured = true;
            }
            add(entity, std::move(emitter), world.matrix);
        });
    registry.view<scene::PointLight, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::PointLight& light, const scene::WorldTransform& world) {
            Emitter emitter;
            emitter.kind = EmitterKind::point;
            emitter.intensity = light.intensity;
            emitter.flux = 4.0f * pi * light.intensity;
            add(entity, emitter, world.matrix);
        });
    registry.view<scene::SpotLight, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::SpotLight& light, const scene::WorldTransform& world) {
            Emitter emitter;
            emitter.kind = EmitterKind::spot;
            emitter.intensity = light.intensity;
            emitter.outer_cosine = std::cos(light.outer_angle);
            emitter.inner_cosine = std::max(std::cos(light.inner_angle), emitter.outer_cosine);
            emitter.flux = spot_solid_angle(emitter) * light.intensity;
            add(entity, emitter, world.matrix);
        });
    registry.view<scene::DirectionalLight, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::DirectionalLight& light, const scene::WorldTransform& world) {
            Emitter emitter;
            emitter.kind = EmitterKind::directional;
            emitter.intensity = light.irradiance;
            emitter.flux = pi * radius * radius * light.irradiance;
            add(entity, emitter, world.matrix);
        });
    registry.view<scene::Environment>().each([&](ecs::Entity entity, const scene::Environment& environment) {
        if (!environment.lights)
            return;
        Emitter emitter;
        emitter.kind = EmitterKind::environment;
        emitter.radiance = environment.radiance;
        if (const auto* map = registry.try_get<scene::EnvironmentMap>(entity); map != nullptr && map->image) {
            emitter.map = *map;
            emitter.map_scale = environment.radiance;
            emitter.radiance *= map->image->mean();
        }
        emitter.flux = 4.0f * pi * pi * radius * radius * emitter.radiance;
        add(entity, emitter, mat4(1.0f));
    });
    std::stable_sort(emitters.begin(), emitters.end(),
                     [](const Emitter& a, const Emitter& b) { return a.entity.index < b.entity.index; });
    return emitters;
}

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
    case EmitterKind::mesh: {
        // The first number picks a triangle by area, and what is left of it serves again.
        const float target = u * emitter.cumulative_area.back();
        const auto found = std::upper_bound(emitter.cumulative_area.begin(), emitter.cumulative_area.end(), target);
        const std::size_t triangle = std::min<std::size_t>(std::size_t(found - emitter.cumulative_area.begin()),
                                                           emitter.cumulative_area.size() - 1);
        const float before = triangle > 0 ? emitter.cumulative_area[triangle - 1] : 0.0f;
        const float share = emitter.cumulative_area[triangle] - before;
        const float rest = share > 0.0f ? std::clamp((target - before) / share, 0.0f, 1.0f) : 0.5f;
        const float root = std::sqrt(rest);
        const vec3* p = &emitter.corners[triangle * 3];
        return {p[0] + (root * (1.0f - v)) * (p[1] - p[0]) + (root * v) * (p[2] - p[0]),
                glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])), std::uint32_t(triangle), root * (1.0f - v),
                root * v};
    }
    default:
        return {origin, forward_of(emitter.matrix)};
    }
}

vec3 sample_cosine_direction(vec3 normal, float u, float v) {
    // A point on the unit sphere around the normal's tip; by projection this is cosine-weighted.
    const vec3 direction = normal + sample_sphere_direction(u, v);
    const float length = glm::length(direction);
    return length > 1e-4f ? direction / length : normal;
}

vec3 sample_sphere_direction(float u, float v) {
    const float z = 1.0f - 2.0f * u, r = std::sqrt(std::max(0.0f, 1.0f - z * z)), angle = 2.0f * pi * v;
    return {r * std::cos(angle), r * std::sin(angle), z};
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
    case EmitterKind::spot: {
        // Uniform in the outer cone, weighted by the falloff.
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
    case EmitterKind::directional:
    case EmitterKind::environment: {
        if (emitter.kind == EmitterKind::directional) {
            ray.direction = forward_of(emitter.matrix);
        } else if (emitter.map.image) {
            const scene::EnvironmentImage::Draw drawn = emitter.map.image->draw(numbers[2], numbers[3]);
            ray.direction = -emitter.map.to_world(drawn.direction);
            // Radiance over density, relative to the mean over the sphere that `flux` stands for.
            const vec3 mean = 4.0f * pi * emitter.map.image->mean();
            for (int c = 0; c < 3; ++c)
                ray.tint[c] =
                    mean[c] > 0.0f && drawn.density > 0.0f ? drawn.radiance[c] / (drawn.density * mean[c]) : 0.0f;
        } else {
            ray.direction = sample_sphere_direction(numbers[2], numbers[3]);
        }
        // From a disc that covers the scene's bounding sphere.
        vec3 side, up;
        orthonormal_basis(ray.direction, side, up);
        const float r = emitter.scene_radius * std::sqrt(numbers[0]), angle = 2.0f * pi * numbers[1];
        ray.origin = emitter.scene_centre - emitter.scene_radius * 1.01f * ray.direction +
                     r * (std::cos(angle) * side + std::sin(angle) * up);
        return ray;
    }
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
