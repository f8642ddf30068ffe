#include "engine/simulation/path_movers.h"

#include <cmath>

namespace sunfleck::simulation {
namespace {

scene::Transform pose(const scene::Mover& mover, const scene::Transform& origin, double seconds) {
    scene::Transform result = origin;
    const double turns = seconds / double(mover.period) + double(mover.phase);
    const float angle = float((turns - std::floor(turns)) * 2.0 * 3.14159265358979323846);
    const vec3 axis = glm::length(mover.axis) > 0.0f ? glm::normalize(mover.axis) : vec3(0.0f, 1.0f, 0.0f);
    switch (mover.path) {
    case scene::MoverPath::none:
        break;
    case scene::MoverPath::line:
        result.position = origin.position + std::sin(angle) * mover.travel;
        break;
    case scene::MoverPath::circle:
        result.position = mover.centre + glm::angleAxis(angle, axis) * (origin.position - mover.centre);
        break;
    case scene::MoverPath::spin:
        result.rotation = glm::angleAxis(angle, axis) * origin.rotation;
        break;
    }
    if (mover.spin_period > 0.0f) {
        const double spins = seconds / double(mover.spin_period);
        const float turn = float((spins - std::floor(spins)) * 2.0 * 3.14159265358979323846);
        result.rotation = glm::angleAxis(turn, vec3(0.0f, 1.0f, 0.0f)) * result.rotation;
    }
    return result;
}

} // namespace

void set_movers_to_step(ecs::Registry& registry, std::uint64_t step) {
    const double seconds = double(step) * step_seconds;
    registry.view<scene::Mover, scene::Transform>().each(
        [&](ecs::Entity entity, const scene::Mover& mover, const scene::Transform& transform) {
            if (mover.path == scene::MoverPath::none)
                return;
            const scene::MoverOrigin* origin = registry.try_get<scene::MoverOrigin>(entity);
            if (origin == nullptr)
                registry.defer(
                    [entity, transform](ecs::Registry& r) { r.emplace<scene::MoverOrigin>(entity, {transform}); });
            const scene::Transform next = pose(mover, origin != nullptr ? origin->transform : transform, seconds);
            if (next.position != transform.position || next.rotation != transform.rotation)
                registry.patch<scene::Transform>(entity, [&](scene::Transform& t) { t = next; });
        });
    scene::update_world_transforms(registry);
}

} // namespace sunfleck::simulation
