// What becomes of lanterns: in the hand, put down, and on what moves below them.
#include "engine/simulation/parent_space.h"
#include "engine/simulation/simulation.h"

#include <algorithm>

namespace sunfleck::simulation {
namespace {

constexpr vec3 hand(0.30f, -0.36f, -0.62f); // of the carried lantern, from the eye: right, up, back

} // namespace

// How tall they are, and what they stand on at first.
void Simulation::find_lanterns(ecs::Registry& registry, const scene::MeshStore& meshes) {
    registry.view<scene::Lantern>().each(
        [&](ecs::Entity entity, const scene::Lantern&) { lantern_heights_.emplace_back(entity, 0.0f); });
    registry.view<scene::MeshInstance>().each([&](ecs::Entity entity, const scene::MeshInstance& instance) {
        const ecs::Entity lantern = owner_of<scene::Lantern>(registry, entity);
        if (lantern.is_null() || instance.mesh >= meshes.size())
            return;
        const Bounds box = transform_bounds(scene::world_matrix(registry, entity), meshes.bounds(instance.mesh));
        for (auto& [known, height] : lantern_heights_)
            if (known == lantern)
                height = std::max(height, box.maximum.y - scene::world_matrix(registry, lantern)[3].y);
    });
    for (const auto& [lantern, height] : lantern_heights_)
        if (lantern != carried_)
            stand_where_it_is(registry, lantern);
}

// Of the angle between the view and the lantern's upright axis.
float Simulation::cosine_to_lantern(const ecs::Registry& registry, ecs::Entity lantern) const {
    float height = 0.0f;
    for (const auto& [known, tall] : lantern_heights_)
        if (known == lantern)
            height = tall;
    const vec3 ahead = player_.forward(), axis(0.0f, height, 0.0f);
    const vec3 to_foot = vec3(scene::world_matrix(registry, lantern)[3]) - player_.eye();
    // The point of the axis that is next to the view's line.
    const vec3 across = axis - glm::dot(axis, ahead) * ahead, off = to_foot - glm::dot(to_foot, ahead) * ahead;
    const float squared = glm::dot(across, across);
    const float share = squared > 0.0f ? std::clamp(-glm::dot(across, off) / squared, 0.0f, 1.0f) : 0.0f;
    const vec3 to = to_foot + share * axis;
    return glm::dot(to, ahead) / std::max(glm::length(to), 1e-6f);
}

void Simulation::take(ecs::Registry& registry, ecs::Entity lantern) {
    forget_standing(lantern);
    carried_ = lantern;
    registry.patch<scene::Lantern>(carried_, [](scene::Lantern& state) { state.carried = true; });
}

void Simulation::forget_standing(ecs::Entity lantern) {
    std::erase_if(standing_, [&](const Standing& standing) { return standing.lantern == lantern; });
}

// On what is just below it. One with a parent goes with that.
void Simulation::stand_where_it_is(ecs::Registry& registry, ecs::Entity lantern) {
    forget_standing(lantern);
    if (registry.has<scene::Parent>(lantern) || !registry.has<scene::Transform>(lantern))
        return;
    constexpr float near = 0.05f; // m
    const scene::Transform& place = registry.get<scene::Transform>(lantern);
    if (const auto ground = physics_.ray(place.position + vec3(0.0f, near, 0.0f), vec3(0.0f, -2.0f * near, 0.0f)))
        stand(registry, {lantern, ground->entity, place.position, place.rotation});
}

// After a step of the bodies: a lantern goes along with what it stands on, and not with its parent.
void Simulation::move_standing(ecs::Registry& registry) {
    for (Standing& standing : standing_) {
        if (!registry.alive(standing.lantern) || !registry.has<scene::Transform>(standing.lantern))
            continue;
        standing.place += physics_.motion_at(standing.ground, standing.place);
        registry.update<scene::Transform>(standing.lantern,
                                          transform_at(registry, standing.lantern, standing.place, standing.rotation));
    }
}

// On whatever lies one step ahead, or at the person's feet if nothing does.
void Simulation::put_down(ecs::Registry& registry) {
    if (carried_.is_null())
        return;
    const vec3 middle = player_.capsule().foot + vec3(0.0f, 0.6f * player_.capsule().height, 0.0f);
    const vec3 ahead(-std::sin(player_.yaw()), 0.0f, -std::cos(player_.yaw()));
    float reach = 0.7f;
    if (const auto wall = physics_.ray(middle, (reach + 0.15f) * ahead, carried_))
        reach = std::max(0.0f, wall->fraction * (reach + 0.15f) - 0.15f);
    const vec3 above = middle + reach * ahead;
    const auto ground = physics_.ray(above, vec3(0.0f, -2.5f, 0.0f), carried_);
    if (!ground)
        return;
    const Standing standing{carried_, ground->entity, ground->point,
                            glm::angleAxis(player_.yaw(), vec3(0.0f, 1.0f, 0.0f))};
    let_go(registry, transform_at(registry, standing.lantern, standing.place, standing.rotation));
    stand(registry, standing);
}

// Where neither what is below it nor a parent moves, there is nothing to do for it.
void Simulation::stand(const ecs::Registry& registry, const Standing& standing) {
    if (!scene::is_static(registry, standing.ground) || registry.has<scene::Parent>(standing.lantern))
        standing_.push_back(standing);
}

void Simulation::let_go(ecs::Registry& registry, const scene::Transform& transform) {
    registry.patch<scene::Lantern>(carried_, [](scene::Lantern& lantern) { lantern.carried = false; });
    physics_.place(registry, carried_, transform);
    carried_ = ecs::null_entity;
}

void Simulation::hand_lantern(ecs::Registry& registry, ecs::Entity lantern) {
    if (carried_ == lantern)
        return;
    if (!carried_.is_null())
        let_go(registry, scene::Transform(registry.get<scene::Transform>(carried_)));
    take(registry, lantern);
}

void Simulation::put_lantern(ecs::Registry& registry, ecs::Entity lantern, const scene::Transform& transform) {
    if (carried_ == lantern)
        let_go(registry, transform);
    else
        physics_.place(registry, lantern, transform);
    stand_where_it_is(registry, lantern);
}

// In the hand it hangs upright, lags slightly behind the view, and stays out of walls.
void Simulation::carry(ecs::Registry& registry) {
    if (carried_.is_null())
        return;
    const quat turned = glm::angleAxis(player_.yaw(), vec3(0.0f, 1.0f, 0.0f));
    const vec3 eye = player_.eye();
    vec3 way = turned * hand;
    way.y += 0.25f * player_.forward().y;
    if (const auto hit = physics_.ray(eye, 1.3f * way, carried_))
        way *= std::min(1.0f, std::max(0.0f, hit->fraction * 1.3f - 0.3f));
    const vec3 place = eye + way - vec3(0.0f, 0.12f, 0.0f);
    registry.update<scene::Transform>(carried_, transform_at(registry, carried_, place, turned));
}

} // namespace sunfleck::simulation
