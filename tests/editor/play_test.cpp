// The scene in motion: bodies fall and are pushed, edits in the middle of it are taken, and when it ends all stands as
// edited, to the bit.
#include "editor/window/scene_play.h"

#include "editor/document/edits.h"
#include "editor/window/scene_copy.h"
#include "engine/scene/procedural.h"
#include "engine/scene/simulation_components.h"
#include "engine/simulation/path_movers.h"
#include "tests/editor/random_edits.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace sunfleck::editor {
namespace {

// A document of a floor, a box that falls on it, a ball that rolls, and a mover that pushes; and the scene thread's
// copy of it, without a device.
class EditorPlay : public testing::Test {
protected:
    EditorPlay() {
        document = std::make_shared<Document>();
        document->begin("Make");
        const std::uint32_t box = document->add_mesh(scene::make_box(vec3(1.0f)));
        floor = add("floor", box, vec3(0.0f, -0.5f, 0.0f), vec3(20.0f, 1.0f, 20.0f));
        crate = add("crate", box, vec3(0.0f, 3.0f, 0.0f), vec3(0.6f));
        other = add("other", box, vec3(1.5f, 0.3f, 0.0f), vec3(0.6f));
        pusher = add("pusher", box, vec3(-2.5f, 0.3f, 0.0f), vec3(0.6f));
        for (const Entity body : {crate, other}) {
            set(body, scene::RigidBody{});
            scene::Mover at_rest;
            at_rest.path = scene::MoverPath::none;
            set(body, at_rest);
        }
        scene::Mover path;
        path.path = scene::MoverPath::line;
        path.travel = vec3(3.5f, 0.0f, 0.0f);
        path.period = 4.0f;
        path.phase = 0.25f; // it starts away from its origin
        set(pusher, path);
        document->commit();
        const SceneChange all = ChangeCollector::everything(document);
        copy.apply(all);
    }
    Entity add(const char* name, std::uint32_t mesh, vec3 place, vec3 scale) {
        const Entity entity = document->create();
        set(entity, scene::Name{name});
        scene::Transform transform;
        transform.position = place;
        transform.scale = scale;
        set(entity, transform);
        scene::MeshInstance instance;
        instance.mesh = mesh;
        set(entity, instance);
        return entity;
    }
    template <typename T>
    void set(Entity entity, const T& value) {
        document->set(entity, pool_of<T>(*document), std::make_shared<T>(value));
    }
    scene::Transform place(Entity entity) { return copy.registry.get<scene::Transform>(entity); }
    // All places, bit for bit.
    std::vector<std::byte> bits() {
        std::vector<std::byte> result;
        const auto append = [&](const auto& value) {
            const auto* first = reinterpret_cast<const std::byte*>(&value);
            result.insert(result.end(), first, first + sizeof value);
        };
        for (const Entity entity : {floor, crate, other, pusher}) {
            const scene::Transform transform = place(entity);
            append(transform.position);
            append(transform.rotation);
            append(transform.scale);
            append(copy.registry.get<scene::WorldTransform>(entity).matrix);
        }
        return result;
    }
    // As the viewport shows the scene that does not play.
    void stand() { simulation::set_movers_to_step(copy.registry, 0); }

    std::shared_ptr<Document> document;
    Entity floor, crate, other, pusher;
    PlainCopy copy;
};

TEST_F(EditorPlay, BodiesFallAreMetAndStandAgainAsEdited) {
    stand();
    const std::vector<std::byte> edited = bits();
    ScenePlay play(copy.registry, copy.meshes);
    EXPECT_EQ(play.bodies(), 2u);
    for (int i = 0; i < 20; ++i)
        play.step(copy.registry);
    // A third of a second in free fall: g t^2 / 2 = 0.54 m; a fixed step of h adds at most g t h / 2 = 0.03 m.
    EXPECT_NEAR(place(crate).position.y, 3.0f - 0.5f * 9.81f / 9.0f, 0.04f);
    for (int i = 0; i < 240; ++i)
        play.step(copy.registry);
    EXPECT_NEAR(place(crate).position.y, 0.3f, 0.05f) << "it lies on the floor";
    EXPECT_GT(glm::length(place(crate).position - vec3(0.0f, 0.3f, 0.0f)), 0.5f) << "the mover has pushed it";
    EXPECT_EQ(play.steps(), 260u);
    play.end(copy.registry);
    EXPECT_EQ(bits(), edited);
    // And again: the same steps give the same world.
    ScenePlay again(copy.registry, copy.meshes), twice(copy.registry, copy.meshes);
    for (int i = 0; i < 100; ++i)
        again.step(copy.registry);
    const std::vector<std::byte> first = bits();
    again.end(copy.registry);
    for (int i = 0; i < 100; ++i)
        twice.step(copy.registry);
    EXPECT_EQ(bits(), first);
    twice.end(copy.registry);
    EXPECT_EQ(bits(), edited);
}

// What physics gives back is as large, but not always the same.
TEST_F(EditorPlay, SignsOfZerosComeBack) {
    scene::Transform transform = document->registry().get<scene::Transform>(other);
    transform.position = vec3(-0.0f, 5.0f, -0.0f);
    transform.rotation = quat(1.0f, -0.0f, 0.0f, -0.0f);
    document->begin("Move");
    set(other, transform);
    document->commit();
    PlainCopy moved;
    moved.apply(ChangeCollector::everything(document));
    ScenePlay play(moved.registry, moved.meshes);
    play.step(moved.registry);
    play.end(moved.registry);
    const auto& now = moved.registry.get<scene::Transform>(other);
    EXPECT_TRUE(std::signbit(now.position.x) && std::signbit(now.position.z));
    EXPECT_TRUE(std::signbit(now.rotation.x) && !std::signbit(now.rotation.y) && std::signbit(now.rotation.z));
}

// An edit of a body puts it where the edit says, and there it stands when play ends; all others go on.
TEST_F(EditorPlay, EditsInTheMiddleStay) {
    stand();
    ChangeCollector collector;
    static_cast<void>(collector.collect(document));
    ScenePlay play(copy.registry, copy.meshes);
    for (int i = 0; i < 30; ++i)
        play.step(copy.registry);
    const vec3 falling = place(crate).position;
    ecs::PoolBase& transforms = pool_of<scene::Transform>(*document);
    ASSERT_TRUE(edit_field(*document, {other}, transforms, transforms.description()->fields[0], "2,1,2"));
    const std::optional<SceneChange> change = collector.collect(document);
    ASSERT_TRUE(change);
    ASSERT_TRUE(play.edit(copy.registry, copy.meshes, change->updates, [&]() -> Status {
        copy.apply(*change);
        return {};
    }));
    EXPECT_EQ(place(other).position, vec3(2.0f, 1.0f, 2.0f));
    EXPECT_EQ(place(crate).position, falling) << "what was not edited stays in motion";
    for (int i = 0; i < 60; ++i)
        play.step(copy.registry);
    EXPECT_NEAR(place(other).position.y, 0.3f, 0.05f);
    play.end(copy.registry);
    EXPECT_EQ(place(other).position, vec3(2.0f, 1.0f, 2.0f));
    EXPECT_EQ(place(crate).position, vec3(0.0f, 3.0f, 0.0f));
}

// Random edits of all kinds, some while it plays: when it ends, the copy is that of a fresh start.
TEST_F(EditorPlay, RandomEditsAndPlayLeaveTheDocument) {
    for (std::uint32_t seed = 1; seed <= tests::by_size(4u, 100u); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        ChangeCollector collector;
        PlainCopy played;
        played.apply(*collector.collect(document));
        tests::RandomEdits edits(*document, seed);
        std::unique_ptr<ScenePlay> play;
        for (int i = 0; i < 60; ++i) {
            if (random() % 8 == 0) {
                if (play != nullptr)
                    play->end(played.registry);
                play = play != nullptr ? nullptr : std::make_unique<ScenePlay>(played.registry, played.meshes);
            }
            for (std::uint32_t steps = random() % 4; play != nullptr && steps > 0; --steps)
                play->step(played.registry);
            edits.once();
            const std::optional<SceneChange> change = collector.collect(document);
            if (!change)
                continue;
            const auto apply = [&]() -> Status {
                played.apply(*change);
                return {};
            };
            ASSERT_TRUE(play != nullptr ? play->edit(played.registry, played.meshes, change->updates, apply) : apply());
        }
        if (play != nullptr)
            play->end(played.registry);
        simulation::set_movers_to_step(played.registry, 0);
        PlainCopy fresh;
        fresh.apply(ChangeCollector::everything(document));
        simulation::set_movers_to_step(fresh.registry, 0);
        for (const Entity entity : fresh.registry.entities()) {
            ASSERT_TRUE(played.registry.alive(entity));
            const auto *wanted = fresh.registry.try_get<scene::WorldTransform>(entity),
                       *found = played.registry.try_get<scene::WorldTransform>(entity);
            ASSERT_EQ(wanted != nullptr, found != nullptr);
            if (wanted != nullptr) {
                EXPECT_EQ(std::memcmp(&wanted->matrix, &found->matrix, sizeof wanted->matrix), 0)
                    << document->name(entity);
            }
        }
    }
}

} // namespace
} // namespace sunfleck::editor
