// The simulation of the demo's level: determinism, a person who cannot leave, doors, lift, balls, lamps and lantern.
#include "assets/test_rooms.h"
#include "engine/simulation/path_movers.h"
#include "engine/simulation/simulation.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

namespace sunfleck::simulation {
namespace {

struct House {
    explicit House(void (*make)(assets::SceneBuilder&) = assets::make_lantern_house) {
        assets::SceneBuilder builder(registry, meshes);
        make(builder);
        scene::update_world_transforms(registry);
        simulation = std::make_unique<Simulation>(registry, meshes);
    }
    void run(std::uint32_t steps, const StepInput& input = {}) {
        for (std::uint32_t i = 0; i < steps; ++i)
            simulation->step(registry, input);
    }
    // Turns to the place and walks until it is near, at most so many steps.
    void walk_to(float x, float z, std::uint32_t most = 600) {
        for (std::uint32_t i = 0; i < most; ++i) {
            const Character& person = simulation->player();
            const vec3 way = vec3(x, 0.0f, z) - vec3(person.capsule().foot.x, 0.0f, person.capsule().foot.z);
            if (glm::length(way) < 0.15f)
                return;
            simulation->step(registry, face(std::atan2(-way.x, -way.z), 0.0f, 100));
        }
    }
    void look_at(vec3 target) {
        for (int i = 0; i < 60; ++i) {
            const vec3 way = target - simulation->player().eye();
            simulation->step(registry, face(std::atan2(-way.x, -way.z),
                                            std::atan2(way.y, std::sqrt(way.x * way.x + way.z * way.z)), 0));
        }
    }
    StepInput face(float yaw, float pitch, std::int32_t forward) const {
        const Character& person = simulation->player();
        const float turn = std::remainder(yaw - person.yaw(), 2.0f * pi);
        StepInput input;
        input.turn = std::clamp(std::int32_t(turn / look_unit), -2000, 2000);
        input.look_up = std::clamp(std::int32_t((pitch - person.pitch()) / look_unit), -2000, 2000);
        input.forward = std::abs(turn) < 0.3f ? forward : 0;
        return input;
    }
    void open_swinging_door() {
        walk_to(0.0f, 4.4f);
        walk_to(0.0f, 1.8f);
        walk_to(2.2f, 0.0f);
        look_at(vec3(3.12f, 1.1f, 0.2f));
        press(button_use);
        run(120);
    }
    void press(std::uint32_t button) {
        StepInput input;
        input.buttons = button;
        simulation->step(registry, input);
        simulation->step(registry, {});
    }
    ecs::Entity entity(const char* name) { return scene::find_by_name(registry, name); }
    vec3 position(const char* name) { return registry.get<scene::Transform>(entity(name)).position; }
    vec3 foot() const { return simulation->player().capsule().foot; }

    ecs::Registry registry;
    scene::MeshStore meshes;
    std::unique_ptr<Simulation> simulation;
};

// Wild input: runs, turns, presses everything, for seconds at a time.
std::vector<StepInput> random_input(std::uint32_t seed, std::size_t steps) {
    std::mt19937 random(seed);
    std::vector<StepInput> result;
    while (result.size() < steps) {
        StepInput input;
        input.forward = std::int32_t(random() % 3) * 100 - 70;
        input.forward = std::clamp(input.forward, -100, 100);
        input.right = std::int32_t(random() % 201) - 100;
        input.turn = std::int32_t(random() % 801) - 400;
        input.look_up = std::int32_t(random() % 101) - 50;
        input.buttons = random() & all_buttons;
        const std::size_t count = 5 + random() % 90;
        for (std::size_t i = 0; i < count && result.size() < steps; ++i)
            result.push_back(input);
    }
    return result;
}

// Steps of a game; memory errors show in the first of them, which take long under a sanitizer.
std::size_t game_steps(std::size_t steps) {
    return sunfleck::tests::sanitized() && !sunfleck::tests::long_size() ? steps * 2 / 5 : steps;
}

TEST(Simulation, TheSameInputGivesTheSameWorldAtEveryStep) {
    const std::vector<StepInput> input = random_input(3, game_steps(2500));
    House first, second;
    for (std::size_t i = 0; i < input.size(); ++i) {
        first.simulation->step(first.registry, input[i]);
        second.simulation->step(second.registry, input[i]);
        ASSERT_EQ(first.simulation->world_hash(first.registry), second.simulation->world_hash(second.registry)) << i;
    }
    House other;
    for (std::size_t i = 0; i < input.size(); ++i)
        other.simulation->step(other.registry, i == 100 ? StepInput{} : input[i]);
    EXPECT_NE(other.simulation->world_hash(other.registry), first.simulation->world_hash(first.registry));
}

// Nobody leaves the house, through walls, floors, windows or between the doors, whatever they do. The short size plays
// one game of four.
TEST(Simulation, NobodyLeavesTheHouse) {
    for (std::uint32_t seed = 1; seed <= sunfleck::tests::by_size(1u, 4u); ++seed) {
        House house;
        const Bounds walls = house.simulation->physics().bounds();
        Bounds visited;
        for (const StepInput& input : random_input(seed, game_steps(10000))) {
            house.simulation->step(house.registry, input);
            const vec3 foot = house.foot();
            ASSERT_TRUE(is_finite(foot)) << "seed " << seed << " step " << house.simulation->steps();
            ASSERT_GT(foot.y, -0.05f) << "seed " << seed << " step " << house.simulation->steps();
            ASSERT_TRUE(foot.x > walls.minimum.x && foot.x < walls.maximum.x && foot.z > walls.minimum.z &&
                        foot.z < walls.maximum.z)
                << "seed " << seed << " step " << house.simulation->steps() << ": " << foot.x << " " << foot.y << " "
                << foot.z;
            visited.add(foot);
        }
        EXPECT_EQ(house.simulation->player().rescued(), 0u) << seed;
        EXPECT_EQ(house.simulation->physics().rescued(), 0u) << seed;
        EXPECT_GT(glm::length(visited.extent()), 5.0f) << "the test must go somewhere";
        house.registry.view<scene::Mover, scene::Transform>().each(
            [&](ecs::Entity, const scene::Mover&, const scene::Transform& transform) {
                EXPECT_TRUE(is_finite(transform.position));
            });
    }
}

TEST(Simulation, WalksStopsAtWallsAndCrouches) {
    House house;
    house.run(30);
    EXPECT_TRUE(house.simulation->player().grounded());
    EXPECT_NEAR(house.foot().y, 0.0f, 0.03f);
    const vec3 start = house.foot();
    StepInput ahead = house.face(0.0f, 0.0f, 100);
    house.walk_to(start.x, 5.0f);
    EXPECT_NEAR(house.foot().z, 5.0f, 0.2f);
    // 2.4 m/s over a second, within what the start takes.
    const vec3 before = house.foot();
    house.look_at(house.foot() + vec3(0.0f, 1.6f, 5.0f));
    house.run(60, house.face(pi, 0.0f, 100));
    EXPECT_NEAR(house.foot().z - before.z, 2.4f, 0.35f);
    house.run(200, house.face(pi, 0.0f, 100)); // into the south wall
    EXPECT_NEAR(house.foot().z, 8.24f - 0.3f, 0.06f);
    ahead = {};
    ahead.buttons = button_crouch;
    house.run(60, ahead);
    EXPECT_TRUE(house.simulation->player().crouching());
    EXPECT_LT(house.simulation->player().eye().y, 1.1f);
    house.run(60);
    EXPECT_FALSE(house.simulation->player().crouching());
    EXPECT_NEAR(house.simulation->player().eye().y, 1.6f, 0.05f);
}

TEST(Simulation, DoorsOpen) {
    House house;
    const float shut = house.position("sliding door").x;
    house.run(60);
    EXPECT_EQ(house.position("sliding door").x, shut) << "nobody is near";
    house.walk_to(0.0f, 4.4f);
    house.run(90);
    EXPECT_GT(house.position("sliding door").x, shut + 1.0f);
    house.walk_to(0.0f, 1.8f);
    house.walk_to(2.2f, 0.0f);
    house.look_at(vec3(3.12f, 1.1f, 0.2f));
    EXPECT_EQ(house.simulation->possible_interaction(house.registry), Interaction::open);
    const vec3 before = house.position("swinging door");
    house.press(button_use);
    house.run(120);
    EXPECT_GT(glm::length(house.position("swinging door") - before), 0.5f);
    EXPECT_NEAR(house.position("sliding door").x, shut, 1e-4f) << "it closes behind people";
    house.walk_to(4.5f, -0.6f);
    EXPECT_GT(house.foot().x, 4.0f) << "the way is open";
}

TEST(Simulation, BallsAndCratesArePushed) {
    House house;
    house.walk_to(0.0f, 4.4f);
    house.walk_to(0.0f, 1.4f);
    house.walk_to(-1.9f, 0.2f);
    const vec3 before = house.position("blue ball");
    house.walk_to(-1.9f, -2.4f);
    EXPECT_GT(glm::length(house.position("blue ball") - before), 0.3f);
    EXPECT_GT(house.position("blue ball").y, 0.1f);
    EXPECT_LT(house.position("blue ball").y, 0.3f) << "it rolls on the floor";
    // Stacked crates stay where they are when nobody touches them.
    const float top = house.position("crate 2").y;
    house.run(300);
    EXPECT_NEAR(house.position("crate 2").y, top, 0.03f);
}

TEST(Simulation, TheLiftCarriesToTheAttic) {
    House house;
    house.walk_to(0.0f, 4.4f);
    house.walk_to(0.0f, 1.6f);
    house.walk_to(-1.2f, 0.0f);
    house.walk_to(0.0f, -2.4f);
    house.walk_to(0.0f, -5.0f);
    house.walk_to(0.6f, -8.3f);
    while (house.simulation->steps() % 840 != 760) // its stay at the bottom begins
        house.run(1);
    house.walk_to(2.1f, -8.3f, 120);
    float highest = 0.0f;
    for (int i = 0; i < 700; ++i) {
        house.run(1);
        highest = std::max(highest, house.foot().y);
    }
    EXPECT_NEAR(highest, 3.44f, 0.05f);
}

TEST(Simulation, StepsAreClimbedAndWallsAreNot) {
    House house;
    house.open_swinging_door();
    house.walk_to(4.5f, -0.6f);
    house.walk_to(7.3f, 0.9f); // three steps of 18 cm
    EXPECT_NEAR(house.foot().y, 0.54f, 0.03f);
    house.walk_to(4.4f, 0.9f); // and down again
    EXPECT_NEAR(house.foot().y, 0.0f, 0.03f);
    house.walk_to(4.1f, -2.75f, 300); // a wall of 90 cm
    EXPECT_NEAR(house.foot().y, 0.0f, 0.03f);
    EXPECT_GT(house.foot().z, -2.6f);
}

TEST(Simulation, LampsAreSwitchedAndTheLanternIsCarried) {
    House house;
    house.walk_to(0.0f, 4.4f);
    house.walk_to(0.0f, 1.1f);
    house.look_at(vec3(0.0f, 1.02f, 0.0f));
    ASSERT_EQ(house.simulation->possible_interaction(house.registry), Interaction::take);
    house.press(button_use);
    EXPECT_TRUE(house.simulation->carries_lantern());
    house.walk_to(-0.95f, 2.0f);
    EXPECT_LT(glm::length(house.position("lantern") - house.simulation->player().eye()), 1.2f);
    house.look_at(vec3(-0.95f, 1.25f, 2.99f));
    ASSERT_EQ(house.simulation->possible_interaction(house.registry), Interaction::switch_lamps);
    const vec3 on = house.registry.get<scene::AreaLight>(house.entity("hall lamp")).radiance;
    house.press(button_use);
    EXPECT_EQ(house.registry.get<scene::AreaLight>(house.entity("hall lamp")).radiance, vec3(0.0f));
    EXPECT_EQ(house.registry.get<scene::Material>(house.entity("hall lamp")).emission, vec3(0.0f));
    house.press(button_use);
    EXPECT_EQ(house.registry.get<scene::AreaLight>(house.entity("hall lamp")).radiance, on);
    house.walk_to(-0.5f, 1.0f);
    house.press(button_put_down);
    EXPECT_FALSE(house.simulation->carries_lantern());
    EXPECT_NEAR(house.position("lantern").y, 0.0f, 0.05f);
}

// A person in a closing door is not squeezed through the floor or the frame.
TEST(Simulation, DoorsDoNotCrushPeople) {
    House house;
    house.open_swinging_door();
    house.walk_to(3.45f, 0.05f); // in the door's way
    house.look_at(house.position("swinging door"));
    house.press(button_use);
    for (int i = 0; i < 600; ++i) {
        house.run(1);
        ASSERT_GT(house.foot().y, -0.03f);
        ASSERT_LT(house.foot().y, 0.6f);
    }
    EXPECT_EQ(house.simulation->player().rescued(), 0u);
}

// Pressed into a corner by the edge of something that moves, a person overlaps it, and neither wall nor floor.
TEST(Simulation, NobodyIsPressedThroughWallsAndFloors) {
    ecs::Registry registry;
    scene::register_components(registry);
    scene::MeshStore meshes;
    assets::SceneBuilder builder(registry, meshes);
    const scene::Material grey = assets::diffuse(vec3(0.5f));
    builder.box("floor", vec3(-3.0f, -0.5f, -3.0f), vec3(3.0f, 0.0f, 3.0f), grey);
    builder.box("wall", vec3(-1.0f, 0.0f, -3.0f), vec3(0.0f, 3.0f, 3.0f), grey);
    const ecs::Entity slanted = builder.box("slanted", vec3(-0.5f), vec3(0.5f), grey);
    builder.mover(slanted, {});
    registry.patch<scene::Transform>(slanted, [](scene::Transform& transform) {
        transform.rotation = glm::angleAxis(glm::radians(30.0f), vec3(0.0f, 0.0f, 1.0f));
        transform.position = vec3(0.9f, 2.6f, 0.0f);
    });
    scene::update_world_transforms(registry);
    PhysicsWorld world(registry, meshes);
    Character person(vec3(0.32f, 0.0f, 0.0f), 0.0f, 1.7f);
    for (int step = 0; step < 60; ++step) { // down and towards the wall
        registry.patch<scene::Transform>(
            slanted, [](scene::Transform& transform) { transform.position += vec3(-0.008f, -0.012f, 0.0f); });
        scene::update_world_transforms(registry);
        world.step(registry);
        person.step(world, {});
        EXPECT_LE(glm::length(world.depenetration(person.capsule(), PhysicsWorld::Obstacles::fixed)), 0.005f)
            << "in step " << step;
    }
    EXPECT_TRUE(world.overlaps(person.capsule())) << "it presses";
}

// A registry whose movers show any moment.
struct MovedScene {
    MovedScene() { scene::register_components(registry); }
    ecs::Entity make(const scene::Mover& mover, vec3 position) {
        const ecs::Entity entity = registry.create();
        scene::Transform transform;
        transform.position = position;
        registry.emplace<scene::Transform>(entity, transform);
        registry.emplace<scene::Mover>(entity, mover);
        return entity;
    }
    vec3 at(ecs::Entity entity, double seconds) {
        set_movers_to_step(registry, std::uint64_t(std::lround(seconds / step_seconds)));
        return registry.get<scene::Transform>(entity).position;
    }
    ecs::Registry registry;
};

TEST(PathMovers, HingesAndLinesFollowTheirPaths) {
    MovedScene moved;
    scene::Mover mover;
    mover.path = scene::MoverPath::hinge;
    mover.centre = vec3(1.0f, 0.0f, 0.0f);
    mover.angle = 1.0f;
    mover.period = 4.0f;
    const ecs::Entity hinge = moved.make(mover, vec3(3.0f, 0.0f, 0.0f));
    mover = {};
    mover.path = scene::MoverPath::line;
    mover.travel = vec3(0.0f, 2.0f, 0.0f);
    mover.period = 8.0f;
    mover.easing = scene::MoverEasing::dwell;
    const ecs::Entity lift = moved.make(mover, vec3(0.0f));
    mover.easing = scene::MoverEasing::linear;
    const ecs::Entity even = moved.make(mover, vec3(0.0f));
    moved.at(hinge, 0.0);
    // A quarter of the pendulum's period: one radian about the hinge, two metres away from it.
    const vec3 swung(1.0f + 2.0f * std::cos(1.0f), 0.0f, -2.0f * std::sin(1.0f));
    EXPECT_NEAR(glm::length(moved.at(hinge, 1.0) - swung), 0.0f, 1e-4f);
    EXPECT_NEAR(moved.at(even, 1.0).y, 1.0f, 1e-4f);
    EXPECT_NEAR(moved.at(even, 2.0).y, 2.0f, 1e-4f);
    EXPECT_NEAR(moved.at(even, 3.0).y, 1.0f, 1e-4f);
    EXPECT_NEAR(moved.at(even, 6.0).y, -2.0f, 1e-4f);
    EXPECT_NEAR(moved.at(lift, 1.5).y, 2.0f, 1e-4f); // waits from 1 s to 3 s
    EXPECT_NEAR(moved.at(lift, 2.9).y, 2.0f, 1e-4f);
    EXPECT_NEAR(moved.at(lift, 6.0).y, -2.0f, 1e-4f);
}

TEST(PathMovers, SplinesPassTheirPoints) {
    MovedScene moved;
    scene::Mover mover;
    mover.path = scene::MoverPath::spline;
    mover.period = 6.0f;
    const ecs::Entity curve = moved.make(mover, vec3(0.0f));
    scene::SplinePath path;
    path.point_1 = vec3(0.0f);
    path.point_2 = vec3(3.0f, 0.0f, 0.0f);
    path.point_3 = vec3(0.0f, 0.0f, 3.0f);
    moved.registry.emplace<scene::SplinePath>(curve, path);
    moved.at(curve, 0.0);
    EXPECT_NEAR(glm::length(moved.at(curve, 2.0) - path.point_2), 0.0f, 1e-4f);
    EXPECT_NEAR(glm::length(moved.at(curve, 4.0) - path.point_3), 0.0f, 1e-4f);
    EXPECT_NEAR(glm::length(moved.at(curve, 6.0) - path.point_1), 0.0f, 1e-4f);
}

TEST(InputRecording, SurvivesTheRoundTripAndRejectsNonsense) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() / "sunfleck_recording_test.txt";
    const std::vector<StepInput> input = random_input(9, 3000);
    ASSERT_TRUE(write_recording(path, input));
    const auto read = read_recording(path);
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, input);
    for (const char* text : {"", "sunfleck_input 2\n", "sunfleck_input 1\n1 2 3\n", "sunfleck_input 1\n0 0 0 0 0 0\n",
                             "sunfleck_input 1\n1 101 0 0 0 0\n", "sunfleck_input 1\n1 0 0 0 0 32\n",
                             "sunfleck_input 1\n99999999999 0 0 0 0 0\n", "sunfleck_input 1\n1 0 0 0 0 0 junk\n",
                             "sunfleck_input 1\n1 nan 0 0 0 0\n"}) {
        std::ofstream(path) << text;
        const auto result = read_recording(path);
        EXPECT_FALSE(result) << text;
        if (!result) {
            EXPECT_NE(result.error().message.find("sunfleck_recording_test.txt"), std::string::npos);
        }
    }
    std::filesystem::remove(path);
    EXPECT_FALSE(read_recording(path));
}

} // namespace
} // namespace sunfleck::simulation
