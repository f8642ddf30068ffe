#include "game_demo/in_sight.h"

namespace sunfleck::demo {

bool in_sight(const raytrace::RayScene& rays, vec3 eye, ecs::Entity entity, const Bounds& bounds) {
    constexpr float within = 0.9f; // of the way from the middle to a corner
    const vec3 middle = bounds.centre(), half = 0.5f * within * bounds.extent();
    constexpr int places = 9;
    for (int i = 0; i < places; ++i) {
        const vec3 corner(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z);
        const raytrace::Ray ray{eye, middle + (i < 8 ? corner : vec3(0.0f)) - eye, 0.0f, 1.0f};
        const auto hit = rays.closest_hit(ray);
        if (!hit || rays.surface(ray, *hit).entity == entity)
            return true;
    }
    return false;
}

bool gives_light(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* material = registry.try_get<scene::Material>(entity);
    return registry.has<scene::AreaLight>(entity) || registry.has<scene::PointLight>(entity) ||
           registry.has<scene::SpotLight>(entity) || registry.has<scene::DirectionalLight>(entity) ||
           (material != nullptr && material->emission != vec3(0.0f));
}

} // namespace sunfleck::demo
