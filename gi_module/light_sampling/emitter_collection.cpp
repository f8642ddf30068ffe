#include "engine/core/log.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/transport/scene_sphere.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

bool usable(vec3 value) {
    return is_finite(value) && value.x >= 0.0f && value.y >= 0.0f && value.z >= 0.0f;
}

bool is_uniform(const mat4& scaling) {
    constexpr float tolerance = 1e-3f;
    const float first = glm::length(vec3(scaling[0]));
    return std::abs(glm::length(vec3(scaling[1])) - first) <= tolerance * first &&
           std::abs(glm::length(vec3(scaling[2])) - first) <= tolerance * first;
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
        emitter.ball = is_uniform(matrix);
        emitter.closed = true;
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
    vec3 facing(0.0f); // of all triangles, by area
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        vec3 p[3];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = vec3(matrix * vec4(mesh.positions[mesh.indices[i + k]], 1.0f));
        if (mirrored)
            std::swap(p[1], p[2]);
        const vec3 area = 0.5f * glm::cross(p[1] - p[0], p[2] - p[0]);
        sum += double(glm::length(area));
        facing += area;
        emitter.corners.insert(emitter.corners.end(), {p[0], p[1], p[2]});
        emitter.cumulative_area.push_back(float(sum));
    }
    emitter.area = float(sum);
    emitter.closed = glm::length(facing) < 0.5f * emitter.area;
    return emitter;
}

Emitter environment_of(const ecs::Registry& registry, ecs::Entity entity, const scene::Environment& environment) {
    Emitter emitter;
    emitter.kind = EmitterKind::environment;
    emitter.entity = entity;
    emitter.radiance = environment.radiance;
    if (const auto* map = registry.try_get<scene::EnvironmentMap>(entity); map != nullptr && map->image) {
        emitter.map = *map;
        emitter.map_scale = environment.radiance;
        emitter.radiance *= map->image->mean();
    }
    return emitter;
}

// Collects emitters; those that cannot light anything are dropped, with a warning where that is a mistake.
class Collector {
public:
    Collector(ecs::Registry& registry, const scene::MeshStore& meshes, const Bounds& scene,
              const std::set<ecs::Entity>& keep_dark, const scene::SceneSpace& space, std::set<ecs::Entity>* warned_of)
        : registry_(registry), meshes_(meshes), keep_dark_(keep_dark), warned_of_(warned_of), space_(space),
          radius_(bounding_radius(scene)), centre_(scene.empty() ? vec3(0.0f) : scene.centre()) {}

    void add_area_lights() {
        registry_.view<scene::AreaLight, scene::WorldTransform>().each(
            [&](ecs::Entity entity, const scene::AreaLight& light, const scene::WorldTransform& world) {
                // A sphere that has a mesh is sampled on that mesh (of the same area): rays and shadow maps see the
                // mesh.
                const scene::MeshInstance* instance = registry_.try_get<scene::MeshInstance>(entity);
                if (light.shape == scene::AreaShape::sphere && instance != nullptr && instance->mesh < meshes_.size()) {
                    scene::Material material;
                    material.emission = light.radiance;
                    Emitter emitter = mesh_light(meshes_[instance->mesh], material, place(world));
                    const Emitter sphere = area_light(light, place(world));
                    emitter.ball = sphere.ball;
                    emitter.radius = sphere.radius;
                    add(entity, std::move(emitter), place(world));
                    return;
                }
                add(entity, area_light(light, place(world)), place(world));
            });
    }

    void add_emissive_meshes() {
        registry_.view<scene::Material, scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity entity, const scene::Material& material, const scene::MeshInstance& instance,
                const scene::WorldTransform& world) {
                if (registry_.has<scene::AreaLight>(entity) ||
                    (material.emission == vec3(0.0f) && !keep_dark_.count(entity)) || instance.mesh >= meshes_.size())
                    return;
                Emitter emitter = mesh_light(meshes_[instance.mesh], material, place(world));
                if (const auto* textures = registry_.try_get<scene::MaterialTextures>(entity);
                    textures && textures->emission) {
                    emitter.radiance *= textures->emission_average;
                    emitter.textured = true;
                }
                add(entity, std::move(emitter), place(world));
            });
    }

    // Point, spot and directional lights.
    void add_punctual_lights() {
        registry_.view<scene::PointLight, scene::WorldTransform>().each(
            [&](ecs::Entity entity, const scene::PointLight& light, const scene::WorldTransform& world) {
                add(entity, delta_light(EmitterKind::point, strength(light.intensity), 4.0f * pi), place(world));
            });
        registry_.view<scene::SpotLight, scene::WorldTransform>().each(
            [&](ecs::Entity entity, const scene::SpotLight& light, const scene::WorldTransform& world) {
                Emitter emitter = delta_light(EmitterKind::spot, strength(light.intensity), 0.0f);
                emitter.outer_cosine = std::cos(light.outer_angle);
                emitter.inner_cosine = std::max(std::cos(light.inner_angle), emitter.outer_cosine);
                emitter.flux = spot_solid_angle(emitter) * emitter.intensity;
                add(entity, emitter, place(world));
            });
        registry_.view<scene::DirectionalLight, scene::WorldTransform>().each(
            [&](ecs::Entity entity, const scene::DirectionalLight& light, const scene::WorldTransform& world) {
                add(entity, delta_light(EmitterKind::directional, light.irradiance, pi * radius_ * radius_),
                    place(world));
            });
    }

    void add_environments() {
        registry_.view<scene::Environment>().each([&](ecs::Entity entity, const scene::Environment& environment) {
            if (!environment.lights)
                return;
            Emitter emitter = environment_of(registry_, entity, environment);
            emitter.flux = 4.0f * pi * pi * radius_ * radius_ * emitter.radiance;
            add(entity, emitter, mat4(1.0f));
        });
    }

    std::vector<Emitter> sorted() {
        std::stable_sort(emitters_.begin(), emitters_.end(),
                         [](const Emitter& a, const Emitter& b) { return a.entity.index < b.entity.index; });
        return std::move(emitters_);
    }

private:
    mat4 place(const scene::WorldTransform& world) const { return space_.place(world.matrix); }
    // Of a point: irradiance is intensity over the square of a distance, which is counted in units of the space.
    vec3 strength(vec3 intensity) const { return intensity / (space_.unit * space_.unit); }

    static Emitter delta_light(EmitterKind kind, vec3 intensity, float flux_scale) {
        Emitter emitter;
        emitter.kind = kind;
        emitter.intensity = intensity;
        emitter.flux = flux_scale * intensity;
        return emitter;
    }

    void warn(ecs::Entity entity, const char* what) const {
        if (warned_of_ != nullptr && warned_of_->insert(entity).second)
            log_warning("light of entity " + std::to_string(entity.index) + " is ignored: " + what);
    }

    void add(ecs::Entity entity, Emitter emitter, const mat4& matrix) {
        emitter.entity = entity;
        emitter.matrix = matrix;
        emitter.scene_radius = radius_;
        emitter.scene_centre = centre_;
        emitter.is_lamp = registry_.has<scene::AreaLight>(entity);
        const bool area_kind = emitter.kind <= EmitterKind::mesh;
        // Of points of a smaller emitter, coordinates are the same in single precision, and densities overflow.
        const float spacing = 0x1p-24f * radius_;
        if (!(emitter.area > spacing * spacing))
            emitter.area = 0.0f;
        if (area_kind)
            emitter.flux = pi * emitter.area * emitter.radiance;
        if (!usable(emitter.radiance) || !usable(emitter.intensity) || !is_finite(emitter.flux)) {
            warn(entity, "its strength is negative, infinite or not a number");
            return;
        }
        if (area_kind && emitter.radiance != vec3(0.0f) && !(emitter.area > 0.0f))
            warn(entity, "its emitter has no area");
        emitter.moves = !scene::is_static(registry_, entity);
        if (luminance(emitter.flux) > 0.0f || (keep_dark_.count(entity) && (!area_kind || emitter.area > 0.0f)))
            emitters_.push_back(std::move(emitter));
    }

    ecs::Registry& registry_;
    const scene::MeshStore& meshes_;
    const std::set<ecs::Entity>& keep_dark_;
    std::set<ecs::Entity>* warned_of_;
    const scene::SceneSpace space_;
    float radius_; // of the scene's bounding sphere
    vec3 centre_;
    std::vector<Emitter> emitters_;
};

} // namespace

std::vector<Emitter> collect_emitters(ecs::Registry& registry, const scene::MeshStore& meshes, const Bounds& scene,
                                      const std::set<ecs::Entity>& keep_dark, const scene::SceneSpace& space,
                                      std::set<ecs::Entity>* warned_of) {
    Collector collector(registry, meshes, scene, keep_dark, space, warned_of);
    collector.add_area_lights();
    collector.add_emissive_meshes();
    collector.add_punctual_lights();
    collector.add_environments();
    return collector.sorted();
}

void find_punctual(std::vector<Emitter>& emitters, std::uint32_t most) {
    std::vector<Emitter*> candidates;
    for (Emitter& emitter : emitters) {
        emitter.punctual = false;
        if (emitter.is_delta())
            candidates.push_back(&emitter);
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Emitter* a, const Emitter* b) { return luminance(a->flux) > luminance(b->flux); });
    for (std::size_t i = 0; i < std::min<std::size_t>(most, candidates.size()); ++i)
        candidates[i]->punctual = true;
}

std::vector<Emitter> collect_backgrounds(ecs::Registry& registry) {
    std::vector<Emitter> result;
    registry.view<scene::Environment>().each([&](ecs::Entity entity, const scene::Environment& environment) {
        if (!environment.lights)
            result.push_back(environment_of(registry, entity, environment));
    });
    return result;
}

} // namespace sunfleck::gi
