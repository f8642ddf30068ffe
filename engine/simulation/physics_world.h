// Rigid bodies by Bullet: static meshes are fixed, movers on paths push, entities with a RigidBody fall, roll and
// slide; a Lantern and what is below it are no bodies. One thread and a fixed step: on one machine, the same calls in
// the same order give the same world, bit for bit.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/mesh_store.h"

#include <memory>
#include <optional>

namespace sunfleck::simulation {

// An upright capsule, positioned by its lowest point.
struct Capsule {
    vec3 foot{0.0f};
    float radius = 0.3f; // m
    float height = 1.7f; // m, in total
};

struct SweepHit {
    float fraction = 1.0f; // of the motion
    vec3 normal{0.0f};     // of the obstacle, towards the capsule
    vec3 point{0.0f};
    ecs::Entity entity;
    float mass = 0.0f; // kg; 0: an immovable obstacle
};

class PhysicsWorld {
public:
    // Built from the registry's current state: world transforms must be up to date. Later steps follow its movers; if
    // entities are created or destroyed afterwards, create a new world.
    PhysicsWorld(ecs::Registry& registry, const scene::MeshStore& meshes);
    ~PhysicsWorld();
    PhysicsWorld(const PhysicsWorld&) = delete;
    PhysicsWorld& operator=(const PhysicsWorld&) = delete;

    // One fixed step: kinematic movers follow their Transforms, then bodies move and update theirs.
    void step(ecs::Registry& registry);

    // Sweeps the capsule by `motion`. `ignored` is not hit.
    std::optional<SweepHit> sweep(const Capsule& capsule, vec3 motion, ecs::Entity ignored = ecs::null_entity) const;
    // Displacement that resolves the capsule's deepest overlap, or zero: with anything, or with what never moves.
    enum class Obstacles { all, fixed };
    vec3 depenetration(const Capsule& capsule, Obstacles obstacles = Obstacles::all) const;
    bool overlaps(const Capsule& capsule) const;
    // The first hit of a ray of this length.
    std::optional<SweepHit> ray(vec3 origin, vec3 motion, ecs::Entity ignored = ecs::null_entity) const;
    // Applies an impulse, N s, at a world point. Has no effect on entities that are not bodies.
    void push(ecs::Entity entity, vec3 momentum, vec3 point);
    // Teleports a body, at rest; `transform`: relative to its parent, if it has one.
    void place(ecs::Registry& registry, ecs::Entity entity, const scene::Transform& transform);
    // Displacement in the last step of a point that moves with the entity; zero for static entities and free bodies.
    vec3 displacement_at(ecs::Entity entity, vec3 point) const;
    // The same, of free bodies, too, and of those that of their middle: a ball rolls on below what stands on it.
    vec3 motion_at(ecs::Entity entity, vec3 point) const;
    // Box around all static geometry.
    const Bounds& bounds() const;
    // Bodies that left the level and were put back at their start.
    std::uint64_t rescued() const;
    std::uint32_t body_count() const;

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace sunfleck::simulation
