#include "engine/simulation/physics_world.h"

#include "engine/scene/simulation_components.h"
#include "engine/simulation/parent_space.h"
#include "engine/simulation/path_movers.h"

#include <algorithm>
#include <btBulletDynamicsCommon.h>
#include <unordered_map>
#include <vector>

namespace sunfleck::simulation {
namespace {

constexpr float margin = 0.01f;             // m, of Bullet's collision shapes
constexpr std::size_t max_hull_points = 64; // meshes with more vertices collide as their bounding box or as triangles
constexpr float fall_limit = 3.0f;          // m below the level

btVector3 to_bullet(vec3 v) {
    return {v.x, v.y, v.z};
}
vec3 from_bullet(const btVector3& v) {
    return {float(v.x()), float(v.y()), float(v.z())};
}

// Bodies have no scale: shapes are created at the entity's scale.
btTransform rigid_transform(const mat4& world) {
    mat3 rotation(world);
    for (int i = 0; i < 3; ++i)
        rotation[i] /= std::max(glm::length(rotation[i]), 1e-20f);
    const quat q = glm::normalize(glm::quat_cast(rotation));
    return btTransform(btQuaternion(q.x, q.y, q.z, q.w), to_bullet(vec3(world[3])));
}

vec3 scale_of(const mat4& world) {
    return {glm::length(vec3(world[0])), glm::length(vec3(world[1])), glm::length(vec3(world[2]))};
}

bool is_convex(const scene::Mesh& mesh) {
    const float slack = 1e-4f * glm::length(mesh.bounds().extent());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const vec3 a = mesh.positions[mesh.indices[i]];
        const vec3 normal =
            glm::cross(mesh.positions[mesh.indices[i + 1]] - a, mesh.positions[mesh.indices[i + 2]] - a);
        const float length = glm::length(normal);
        for (const vec3 p : mesh.positions)
            if (glm::dot(p - a, normal) > slack * length)
                return false;
    }
    return true;
}

} // namespace

struct PhysicsWorld::Implementation {
    struct Body {
        ecs::Entity entity;
        std::unique_ptr<btCollisionShape> shape;
        std::unique_ptr<btTriangleMesh> triangles;
        std::unique_ptr<btRigidBody> body;
        btTransform start, previous;
        bool kinematic = false;
        vec3 offset{0.0f}; // from the entity's origin to the shape's centre, in the body's frame
    };
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    std::vector<std::unique_ptr<Body>> bodies;
    std::unordered_map<ecs::Entity, Body*> by_entity;
    Bounds bounds;
    std::uint64_t rescued = 0;

    ~Implementation() {
        for (auto& body : bodies)
            world.removeRigidBody(body->body.get());
    }

    void add(std::unique_ptr<Body> body, float mass, const scene::RigidBody& described, const mat4& matrix) {
        body->shape->setMargin(margin);
        body->start = rigid_transform(matrix);
        body->start.setOrigin(body->start * to_bullet(body->offset));
        body->previous = body->start;
        btVector3 inertia(0, 0, 0);
        if (mass > 0.0f)
            body->shape->calculateLocalInertia(mass, inertia);
        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, body->shape.get(), inertia);
        info.m_startWorldTransform = body->start;
        info.m_friction = described.friction;
        info.m_restitution = described.restitution;
        info.m_rollingFriction = described.rolling_friction;
        info.m_linearDamping = 0.02f;
        info.m_angularDamping = 0.08f;
        body->body = std::make_unique<btRigidBody>(info);
        body->body->setUserIndex(int(bodies.size()));
        if (body->kinematic) {
            body->body->setCollisionFlags(body->body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
            body->body->setActivationState(DISABLE_DEACTIVATION);
        } else if (mass > 0.0f) {
            // Continuous collision detection: small, fast bodies do not tunnel through floors.
            btVector3 low, high;
            body->shape->getAabb(btTransform::getIdentity(), low, high);
            const float smallest = float((high - low)[(high - low).minAxis()]);
            body->body->setCcdMotionThreshold(0.5f * smallest);
            body->body->setCcdSweptSphereRadius(0.3f * smallest);
        }
        world.addRigidBody(body->body.get());
        by_entity[body->entity] = body.get();
        bodies.push_back(std::move(body));
    }

    void make_shape(Body& body, const scene::Mesh& mesh, vec3 scale, scene::BodyShape kind, bool may_be_hollow) {
        const Bounds box = mesh.bounds();
        if (kind == scene::BodyShape::sphere) {
            body.offset = scale * box.centre();
            const vec3 half = 0.5f * scale * box.extent();
            body.shape = std::make_unique<btSphereShape>(std::max({half.x, half.y, half.z}));
            return;
        }
        const bool convex = !may_be_hollow || (mesh.positions.size() <= max_hull_points && is_convex(mesh));
        if (!convex) {
            body.triangles = std::make_unique<btTriangleMesh>();
            for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
                body.triangles->addTriangle(to_bullet(scale * mesh.positions[mesh.indices[i]]),
                                            to_bullet(scale * mesh.positions[mesh.indices[i + 1]]),
                                            to_bullet(scale * mesh.positions[mesh.indices[i + 2]]));
            body.shape = std::make_unique<btBvhTriangleMeshShape>(body.triangles.get(), true);
            return;
        }
        const bool is_box = kind == scene::BodyShape::box && (!may_be_hollow || mesh.positions.size() == 24);
        if (is_box) {
            body.offset = scale * box.centre();
            const vec3 half = glm::max(0.5f * scale * box.extent(), vec3(margin));
            body.shape = std::make_unique<btBoxShape>(to_bullet(half));
            return;
        }
        auto hull = std::make_unique<btConvexHullShape>();
        const std::size_t stride = std::max<std::size_t>(1, mesh.positions.size() / 128);
        for (std::size_t i = 0; i < mesh.positions.size(); i += stride)
            hull->addPoint(to_bullet(scale * mesh.positions[i]), false);
        hull->recalcLocalAabb();
        body.shape = std::move(hull);
    }

    // Moves a body on a path to its entity's pose and wakes what it may push.
    void move_kinematic(Body& body, const mat4& matrix) {
        btTransform now = rigid_transform(matrix);
        now.setOrigin(now * to_bullet(body.offset));
        body.previous = body.body->getWorldTransform();
        // Bullet derives the speed of a pusher from the difference.
        body.body->setInterpolationWorldTransform(body.previous);
        body.body->setWorldTransform(now);
        const btVector3 speed = (now.getOrigin() - body.previous.getOrigin()) / float(step_seconds);
        body.body->setLinearVelocity(speed);
        if (speed.length2() > 1e-8f)
            for (auto& other : bodies)
                if (!other->kinematic && other->body->getInvMass() > 0.0f)
                    other->body->activate();
    }

    // Copies a free body's pose to its entity; a body that left the level goes back to its start.
    void write_back(Body& body, ecs::Registry& registry) {
        btTransform place = body.body->getWorldTransform();
        const vec3 middle = from_bullet(place.getOrigin());
        if (!is_finite(middle) || middle.y < bounds.minimum.y - fall_limit) {
            ++rescued;
            body.body->setWorldTransform(body.start);
            body.body->setLinearVelocity({0, 0, 0});
            body.body->setAngularVelocity({0, 0, 0});
            place = body.start;
        }
        place.setOrigin(place * to_bullet(-body.offset));
        const btQuaternion q = place.getRotation();
        const vec3 position = from_bullet(place.getOrigin());
        const quat rotation(float(q.w()), float(q.x()), float(q.y()), float(q.z()));
        registry.update<scene::Transform>(body.entity, transform_at(registry, body.entity, position, rotation));
    }
};

PhysicsWorld::PhysicsWorld(ecs::Registry& registry, const scene::MeshStore& meshes)
    : implementation_(std::make_unique<Implementation>()) {
    Implementation& self = *implementation_;
    self.world.setGravity(btVector3(0.0f, -9.81f, 0.0f));
    self.world.getSolverInfo().m_solverMode &= ~SOLVER_RANDMIZE_ORDER;
    // Sorted by entity, so that the order of pools does not matter.
    std::vector<ecs::Entity> entities;
    registry.view<scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::MeshInstance&, const scene::WorldTransform&) {
            entities.push_back(entity);
        });
    std::sort(entities.begin(), entities.end());
    for (const ecs::Entity entity : entities) {
        const scene::RigidBody* described = registry.try_get<scene::RigidBody>(entity);
        const std::uint32_t mesh = registry.get<scene::MeshInstance>(entity).mesh;
        if (mesh >= meshes.size() || meshes[mesh].indices.empty() ||
            (described != nullptr && described->shape == scene::BodyShape::none))
            continue;
        // A lantern is carried past everything and put down anywhere: neither it nor what is below it is in the way.
        if (!owner_of<scene::Lantern>(registry, entity).is_null())
            continue;
        const mat4& matrix = registry.get<scene::WorldTransform>(entity).matrix;
        auto body = std::make_unique<Implementation::Body>();
        body->entity = entity;
        const bool moves = !scene::is_static(registry, entity);
        const float mass = moves && described != nullptr ? described->mass : 0.0f;
        body->kinematic = moves && mass <= 0.0f;
        const scene::RigidBody usual;
        self.make_shape(*body, meshes[mesh], scale_of(matrix), described != nullptr ? described->shape : usual.shape,
                        !moves);
        self.add(std::move(body), mass, described != nullptr ? *described : usual, matrix);
        if (!moves)
            self.bounds.add(transform_bounds(matrix, meshes.bounds(mesh)));
    }
}

PhysicsWorld::~PhysicsWorld() = default;

void PhysicsWorld::step(ecs::Registry& registry) {
    Implementation& self = *implementation_;
    for (auto& body : self.bodies)
        if (body->kinematic && registry.alive(body->entity))
            self.move_kinematic(*body, registry.get<scene::WorldTransform>(body->entity).matrix);
        else
            body->previous = body->body->getWorldTransform();
    self.world.stepSimulation(float(step_seconds), 0);
    for (auto& body : self.bodies)
        if (!body->kinematic && body->body->getInvMass() > 0.0f && registry.alive(body->entity))
            self.write_back(*body, registry);
}

namespace {

// A query callback that ignores one entity.
template <typename Callback, typename Bodies>
struct Ignoring : Callback {
    template <typename... Arguments>
    Ignoring(const Bodies& all, ecs::Entity ignored_entity, Arguments... arguments)
        : Callback(arguments...), bodies(all), ignored(ignored_entity) {}
    bool needsCollision(btBroadphaseProxy* proxy) const override {
        const auto* object = static_cast<const btCollisionObject*>(proxy->m_clientObject);
        return Callback::needsCollision(proxy) && bodies[std::size_t(object->getUserIndex())]->entity != ignored;
    }
    const Bodies& bodies;
    ecs::Entity ignored;
};

btTransform capsule_place(const Capsule& capsule) {
    return btTransform(btQuaternion::getIdentity(), to_bullet(capsule.foot + vec3(0.0f, 0.5f * capsule.height, 0.0f)));
}

btCapsuleShape capsule_shape(const Capsule& capsule) {
    return {capsule.radius, std::max(capsule.height - 2.0f * capsule.radius, 0.01f)};
}

} // namespace

std::optional<SweepHit> PhysicsWorld::sweep(const Capsule& capsule, vec3 motion, ecs::Entity ignored) const {
    const Implementation& self = *implementation_;
    const btCapsuleShape shape = capsule_shape(capsule);
    const btTransform from = capsule_place(capsule);
    btTransform to = from;
    to.setOrigin(from.getOrigin() + to_bullet(motion));
    Ignoring<btCollisionWorld::ClosestConvexResultCallback, decltype(self.bodies)> closest(
        self.bodies, ignored, from.getOrigin(), to.getOrigin());
    self.world.convexSweepTest(&shape, from, to, closest, 0.0f);
    if (!closest.hasHit())
        return std::nullopt;
    const auto& body = *self.bodies[std::size_t(closest.m_hitCollisionObject->getUserIndex())];
    SweepHit hit;
    hit.fraction = closest.m_closestHitFraction;
    hit.normal = from_bullet(closest.m_hitNormalWorld);
    hit.point = from_bullet(closest.m_hitPointWorld);
    hit.entity = body.entity;
    hit.mass = body.body->getInvMass() > 0.0f ? float(1.0f / body.body->getInvMass()) : 0.0f;
    return hit;
}

namespace {

// What follows its Transform counts as static with Bullet, too, since its mass is none.
bool is_fixed(const btCollisionObject& object) {
    return object.isStaticObject() && !object.isKinematicObject();
}

struct DeepestContacts : btCollisionWorld::ContactResultCallback {
    // Bullet's own parameters. NOLINTNEXTLINE(readability-function-size)
    btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* first, int, int,
                             const btCollisionObjectWrapper* second, int, int) override {
        const bool self_first = first->getCollisionObject() == self;
        const btCollisionObject* other = (self_first ? second : first)->getCollisionObject();
        if (point.getDistance() >= 0.0f || (fixed_alone && !is_fixed(*other)))
            return 0.0f;
        const float sign = self_first ? 1.0f : -1.0f;
        const vec3 out = from_bullet(point.m_normalWorldOnB) * (-float(point.getDistance()) * sign);
        if (glm::length(out) > glm::length(deepest))
            deepest = out;
        return 0.0f;
    }
    const btCollisionObject* self = nullptr;
    bool fixed_alone = false;
    vec3 deepest{0.0f};
};

} // namespace

vec3 PhysicsWorld::depenetration(const Capsule& capsule, Obstacles obstacles) const {
    btCapsuleShape shape = capsule_shape(capsule);
    btCollisionObject object;
    object.setCollisionShape(&shape);
    object.setWorldTransform(capsule_place(capsule));
    DeepestContacts contacts;
    contacts.self = &object;
    contacts.fixed_alone = obstacles == Obstacles::fixed;
    implementation_->world.contactTest(&object, contacts);
    return contacts.deepest;
}

bool PhysicsWorld::overlaps(const Capsule& capsule) const {
    return glm::length(depenetration(capsule)) > 1e-3f;
}

std::optional<SweepHit> PhysicsWorld::ray(vec3 origin, vec3 motion, ecs::Entity ignored) const {
    const Implementation& self = *implementation_;
    const btVector3 from = to_bullet(origin), to = to_bullet(origin + motion);
    Ignoring<btCollisionWorld::ClosestRayResultCallback, decltype(self.bodies)> closest(self.bodies, ignored, from, to);
    self.world.rayTest(from, to, closest);
    if (!closest.hasHit())
        return std::nullopt;
    const auto& body = *self.bodies[std::size_t(closest.m_collisionObject->getUserIndex())];
    return SweepHit{float(closest.m_closestHitFraction), from_bullet(closest.m_hitNormalWorld),
                    from_bullet(closest.m_hitPointWorld), body.entity,
                    body.body->getInvMass() > 0.0f ? float(1.0f / body.body->getInvMass()) : 0.0f};
}

void PhysicsWorld::push(ecs::Entity entity, vec3 momentum, vec3 point) {
    const auto found = implementation_->by_entity.find(entity);
    if (found == implementation_->by_entity.end() || found->second->body->getInvMass() <= 0.0f)
        return;
    btRigidBody& body = *found->second->body;
    body.activate();
    body.applyImpulse(to_bullet(momentum), to_bullet(point) - body.getCenterOfMassPosition());
}

void PhysicsWorld::place(ecs::Registry& registry, ecs::Entity entity, const scene::Transform& transform) {
    registry.patch<scene::Transform>(entity, [&](scene::Transform& t) { t = transform; });
    const auto found = implementation_->by_entity.find(entity);
    if (found == implementation_->by_entity.end())
        return;
    btTransform now = rigid_transform(in_world(registry, entity, transform));
    now.setOrigin(now * to_bullet(found->second->offset));
    found->second->previous = now;
    btRigidBody& body = *found->second->body;
    body.setWorldTransform(now);
    body.setInterpolationWorldTransform(now);
    body.setLinearVelocity({0, 0, 0});
    body.setAngularVelocity({0, 0, 0});
    body.activate();
}

vec3 PhysicsWorld::displacement_at(ecs::Entity entity, vec3 point) const {
    const auto found = implementation_->by_entity.find(entity);
    if (found == implementation_->by_entity.end() || !found->second->kinematic)
        return vec3(0.0f);
    const btTransform& now = found->second->body->getWorldTransform();
    const btVector3 local = found->second->previous.inverse() * to_bullet(point);
    return from_bullet(now * local) - point;
}

vec3 PhysicsWorld::motion_at(ecs::Entity entity, vec3 point) const {
    const auto found = implementation_->by_entity.find(entity);
    if (found == implementation_->by_entity.end() ||
        found->second->body->getWorldTransform() == found->second->previous)
        return vec3(0.0f);
    if (found->second->kinematic)
        return displacement_at(entity, point);
    return from_bullet(found->second->body->getWorldTransform().getOrigin() - found->second->previous.getOrigin());
}

const Bounds& PhysicsWorld::bounds() const {
    return implementation_->bounds;
}
std::uint64_t PhysicsWorld::rescued() const {
    return implementation_->rescued;
}
std::uint32_t PhysicsWorld::body_count() const {
    return std::uint32_t(implementation_->bodies.size());
}

} // namespace sunfleck::simulation
