#include "engine/simulation/path_movers.h"

#include "engine/scene/animation.h"
#include "engine/scene/deformation.h"
#include "engine/scene/simulation_components.h"

#include <cmath>

namespace sunfleck::simulation {
namespace {

using scene::MoverActivation;
using scene::MoverPath;

float fraction(double value) {
    return float(value - std::floor(value));
}

float smooth(float t) {
    return t * t * (3.0f - 2.0f * t);
}

// Position along the travel, -1 to 1, at a fraction of the period.
float swing(scene::MoverEasing easing, float share) {
    if (easing == scene::MoverEasing::sine)
        return std::sin(share * 2.0f * pi);
    const float triangle = 4.0f * std::abs(fraction(double(share) - 0.25) - 0.5f) - 1.0f; // 1 at a quarter
    if (easing == scene::MoverEasing::linear)
        return triangle;
    const float clipped = glm::clamp(2.0f * triangle, -1.0f, 1.0f);
    return 2.0f * smooth(0.5f * clipped + 0.5f) - 1.0f;
}

// Position and direction of travel on the closed curve; `share`: fraction of the curve, uniform in control points.
void on_spline(const scene::SplinePath& path, float share, vec3& position, vec3& direction) {
    const vec3 points[] = {path.point_1, path.point_2, path.point_3, path.point_4, path.point_5, path.point_6};
    const std::uint32_t n = glm::clamp(path.count, 2u, scene::SplinePath::max_points);
    const float place = share * float(n);
    const std::uint32_t i = std::min(std::uint32_t(place), n - 1);
    const float t = place - float(i);
    const vec3 a = points[(i + n - 1) % n], b = points[i], c = points[(i + 1) % n], d = points[(i + 2) % n];
    const vec3 k1 = 0.5f * (c - a), k2 = a - 2.5f * b + 2.0f * c - 0.5f * d, k3 = 1.5f * (b - c) + 0.5f * (d - a);
    position = b + t * (k1 + t * (k2 + t * k3));
    direction = k1 + t * (2.0f * k2 + t * 3.0f * k3);
}

scene::Transform pose(const scene::Mover& mover, const scene::Transform& origin, const scene::MoverState* state,
                      const scene::SplinePath* spline, double seconds) {
    scene::Transform result = origin;
    const float share = fraction(seconds / double(mover.period) + double(mover.phase));
    const bool activated = mover.activation != MoverActivation::clock;
    const float along = activated ? smooth(state != nullptr ? state->progress : 0.0f) : swing(mover.easing, share);
    const vec3 axis = glm::length(mover.axis) > 0.0f ? glm::normalize(mover.axis) : vec3(0.0f, 1.0f, 0.0f);
    switch (mover.path) {
    case MoverPath::none:
        break;
    case MoverPath::line:
        result.position = origin.position + along * mover.travel;
        break;
    case MoverPath::circle:
        result.position = mover.centre + glm::angleAxis(share * 2.0f * pi, axis) * (origin.position - mover.centre);
        break;
    case MoverPath::spin:
        result.rotation = glm::angleAxis(share * 2.0f * pi, axis) * origin.rotation;
        break;
    case MoverPath::hinge: {
        const quat turn = glm::angleAxis(along * mover.angle, axis);
        result.position = mover.centre + turn * (origin.position - mover.centre);
        result.rotation = turn * origin.rotation;
        break;
    }
    case MoverPath::spline:
        if (spline != nullptr) {
            vec3 direction;
            on_spline(*spline, share, result.position, direction);
            direction.y = 0.0f;
            if (spline->face_travel && glm::length(direction) > 1e-6f)
                result.rotation = glm::angleAxis(std::atan2(-direction.x, -direction.z), vec3(0.0f, 1.0f, 0.0f));
        }
        break;
    }
    if (mover.spin_period > 0.0f) {
        const float turn = fraction(seconds / double(mover.spin_period)) * 2.0f * pi;
        result.rotation = glm::angleAxis(turn, vec3(0.0f, 1.0f, 0.0f)) * result.rotation;
    }
    return result;
}

} // namespace

void set_movers_to_step(ecs::Registry& registry, std::uint64_t step) {
    const double seconds = double(step) * step_seconds;
    registry.view<scene::Mover, scene::Transform>().each(
        [&](ecs::Entity entity, const scene::Mover& mover, const scene::Transform& transform) {
            if (mover.path == MoverPath::none)
                return;
            const scene::MoverOrigin* origin = registry.try_get<scene::MoverOrigin>(entity);
            if (origin == nullptr)
                registry.defer(
                    [entity, transform](ecs::Registry& r) { r.emplace<scene::MoverOrigin>(entity, {transform}); });
            const scene::Transform next =
                pose(mover, origin != nullptr ? origin->transform : transform,
                     registry.try_get<scene::MoverState>(entity), registry.try_get<scene::SplinePath>(entity), seconds);
            if (next.position != transform.position || next.rotation != transform.rotation)
                registry.patch<scene::Transform>(entity, [&](scene::Transform& t) { t = next; });
        });
    registry.view<scene::Animation, scene::Transform>().each([&](ecs::Entity entity, const scene::Animation& animation,
                                                                 const scene::Transform& transform) {
        scene::Transform next = transform;
        animation.apply(seconds, next);
        if (next.position != transform.position || next.rotation != transform.rotation || next.scale != transform.scale)
            registry.patch<scene::Transform>(entity, [&](scene::Transform& t) { t = next; });
    });
    registry.view<scene::Animation, scene::MorphWeights>().each(
        [&](ecs::Entity entity, const scene::Animation& animation, const scene::MorphWeights& stored) {
            std::vector<float> weights = animation.weights_at(seconds);
            if (!weights.empty() && weights != stored.weights)
                registry.patch<scene::MorphWeights>(
                    entity, [&](scene::MorphWeights& target) { target.weights = std::move(weights); });
        });
    scene::update_world_transforms(registry);
}

std::vector<vec3> mover_path(const ecs::Registry& registry, ecs::Entity entity, std::uint32_t count) {
    std::vector<vec3> places;
    const auto* mover = registry.try_get<scene::Mover>(entity);
    const auto* transform = registry.try_get<scene::Transform>(entity);
    if (mover == nullptr || transform == nullptr || mover->path == MoverPath::none || count < 2)
        return places;
    const scene::MoverOrigin* origin = registry.try_get<scene::MoverOrigin>(entity);
    const scene::Transform start = origin != nullptr ? origin->transform : *transform;
    const mat4 world = scene::world_matrix(registry, entity);
    const mat4 parent = world * glm::inverse(transform->matrix());
    scene::MoverState state;
    places.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const double share = double(i) / double(count - 1);
        state.progress = float(share);
        const scene::Transform at =
            pose(*mover, start, &state, registry.try_get<scene::SplinePath>(entity), share * double(mover->period));
        places.push_back(vec3(parent * vec4(at.position, 1.0f)));
    }
    return places;
}

} // namespace sunfleck::simulation
