#include "editor/window/scene_play.h"

#include "engine/scene/animation.h"
#include "engine/scene/simulation_components.h"
#include "engine/simulation/path_movers.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::editor {
namespace {

// Also in the signs of zeros, which a body at rest may lose.
bool same_bits(const scene::Transform& a, const scene::Transform& b) {
    const auto same = [](const auto& one, const auto& other) { return std::memcmp(&one, &other, sizeof one) == 0; };
    return same(a.position, b.position) && same(a.rotation, b.rotation) && same(a.scale, b.scale);
}

// What decides how bodies move: places, shapes, and who is there at all.
bool concerns_bodies(const ecs::Registry& registry, const Update& update) {
    const TypeDescription* type = update.pool->description();
    return update.value == nullptr || !registry.alive(update.entity) || type == nullptr ||
           type == &scene::Transform::description() || type == &scene::Parent::description() ||
           type == &scene::RigidBody::description() || type == &scene::Mover::description() ||
           type == &scene::MeshInstance::description();
}

} // namespace

bool ScenePlay::would_move(ecs::Registry& registry) {
    bool moves = false;
    registry.view<scene::Mover>().each([&](Entity, const scene::Mover& mover) {
        moves = moves || (mover.path != scene::MoverPath::none && mover.activation == scene::MoverActivation::clock);
    });
    registry.view<scene::Animation>().each([&](Entity, const scene::Animation&) { moves = true; });
    registry.view<scene::RigidBody>().each([&](Entity, const scene::RigidBody&) { moves = true; });
    return moves;
}

ScenePlay::ScenePlay(ecs::Registry& registry, const scene::MeshStore& meshes) : edited_(places(registry)) {
    simulation::set_movers_to_step(registry, 0);
    if (!edited_.empty())
        physics_ = std::make_unique<simulation::PhysicsWorld>(registry, meshes);
}

ScenePlay::Places ScenePlay::places(ecs::Registry& registry) {
    Places result;
    registry.view<scene::RigidBody, scene::Transform>().each(
        [&](Entity entity, const scene::RigidBody&, const scene::Transform& transform) { result[entity] = transform; });
    return result;
}

void ScenePlay::put(ecs::Registry& registry, const Places& places) {
    for (const auto& [entity, place] : places)
        if (const auto* now = registry.try_get<scene::Transform>(entity); now != nullptr && !same_bits(*now, place))
            registry.patch<scene::Transform>(entity,
                                             [&, to = &place](scene::Transform& transform) { transform = *to; });
}

void ScenePlay::step(ecs::Registry& registry) {
    simulation::set_movers_to_step(registry, ++steps_);
    if (physics_ == nullptr)
        return;
    physics_->step(registry);
    scene::update_world_transforms(registry);
}

Status ScenePlay::edit(ecs::Registry& registry, const scene::MeshStore& meshes, const std::vector<Update>& updates,
                       const std::function<Status()>& change) {
    const bool concerns = std::any_of(updates.begin(), updates.end(),
                                      [&](const Update& update) { return concerns_bodies(registry, update); });
    if (!concerns)
        return change();
    Places now = places(registry);
    const Places before = edited_;
    put(registry, edited_);
    Status status = change();
    edited_ = places(registry);
    for (const auto& [entity, place] : edited_)
        if (const auto known = before.find(entity); known == before.end() || !same_bits(known->second, place))
            now[entity] = place;
    // What is no body any more stands as edited; nothing would put it back at the end.
    std::erase_if(now, [&](const auto& one) { return edited_.count(one.first) == 0; });
    // A mover's path begins where it was edited to be, not where physics has brought it.
    simulation::set_movers_to_step(registry, 0);
    put(registry, now);
    simulation::set_movers_to_step(registry, steps_);
    physics_ = edited_.empty() ? nullptr : std::make_unique<simulation::PhysicsWorld>(registry, meshes);
    return status;
}

void ScenePlay::end(ecs::Registry& registry) const {
    put(registry, edited_);
    simulation::set_movers_to_step(registry, 0);
}

} // namespace sunfleck::editor
