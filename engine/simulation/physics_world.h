// Rigid bodies by Bullet: static meshes stand, movers on paths push, entities with a RigidBody fall, roll and slide.
// One thread and a fixed step: the same calls in the same order give the same world, bit for bit, on one machine.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"

#include <memory>
#include <optional>

namespace sunfleck::simulation {

// An upright capsule, by the middle of its lowest point.
struct Capsule {
    vec3 foot{0.0f};
    float radius = 0.3f; // m
    float height = 1.7f; // m, in all
};

struct SweepHit {
    float fraction = 1.0f; // of the way
    vec3 normal{0.0f};     // of the obstacle, towards the capsule
    vec3 point{0.0f};
    ecs::Entity entity;
    float mass = 0.0f; // kg; 0: an obstacle that does not give way
};

class PhysicsWorld {
public:
    // Takes the registry as it is: world transforms must be up to date. Later steps follow its movers; entities that
    // are created or destroyed afterwards need a new world.
    PhysicsWorld(ecs::Registry& registry, const scene::MeshStore& meshes);
    ~PhysicsWorld();
    PhysicsWorld(const PhysicsWorld&) = delete;
    PhysicsWorld& operator=(const PhysicsWorld&) = delete;

    // One fixed step: movers on paths go to their Transforms, then bodies move and their Transforms follow.
    void step(ecs::Registry& registry);

    // The capsule's way from its place by `motion`. `ignored` is not hit.
    std::optional<SweepHit> sweep(const Capsule& capsule, vec3 motion, ecs::Entity ignored = ecs::null_entity) const;
    // How to move the capsule out of what it overlaps: the sum of the deepest overlaps, or zero.
    vec3 way_out(const Capsule& capsule) const;
    bool overlaps(const Capsule& capsule) const;
    // The first thing on a ray of this length.
    std::optional<SweepHit> ray(vec3 origin, vec3 motion, ecs::Entity ignored = ecs::null_entity) const;
    // Momentum, N s, at a world point. Nothing happens to what is not a body.
    void push(ecs::Entity entity, vec3 momentum, vec3 point);
    // Puts a body elsewhere, at rest.
    void place(ecs::Registry& registry, ecs::Entity entity, const scene::Transform& transform);
    // How a point that stands on the entity moved in the last step; zero for what is static or a free body.
    vec3 carried_by(ecs::Entity entity, vec3 point) const;
    // Box around all static geometry.
    const Bounds& bounds() const;
    // Bodies that left the level and were put back where they began.
    std::uint64_t rescued() const;
    std::uint32_t body_count() const;

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace sunfleck::simulation
