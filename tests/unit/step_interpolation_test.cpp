// What a window draws between two fixed steps: even motion at uneven frames, and nothing of it in the simulation.
#include "assets/test_rooms.h"
#include "engine/simulation/path_movers.h"
#include "engine/simulation/step_interpolation.h"

#include <gtest/gtest.h>

#include <random>

namespace sunfleck::simulation {
namespace {

using scene::WorldTransform;

constexpr float lift_speed = 0.8f; // m/s
constexpr float lift_way = 40.0f;  // m: it does not turn round during a test

// A floor with a lift beside the person that goes up at constant speed, and a lantern before them.
struct Hall {
    Hall() {
        assets::SceneBuilder builder(registry, meshes);
        assets::make_lantern_house(builder);
        lift = registry.create();
        scene::Transform start;
        start.position = vec3(50.0f, 0.0f, 0.0f);
        registry.emplace<scene::Transform>(lift, start);
        scene::Mover mover;
        mover.path = scene::MoverPath::line;
        mover.travel = vec3(0.0f, lift_way, 0.0f);
        mover.easing = scene::MoverEasing::linear;
        mover.period = 4.0f * lift_way / lift_speed;
        registry.emplace<scene::Mover>(lift, mover);
        lamp = registry.create(); // on the lift, so that what hangs on it follows
        registry.emplace<scene::Transform>(lamp, scene::Transform{vec3(0.5f, 1.0f, 0.0f)});
        registry.emplace<scene::Parent>(lamp, scene::Parent{lift});
        scene::update_world_transforms(registry);
        simulation = std::make_unique<Simulation>(registry, meshes);
        drawn.took_step(registry, *simulation);
    }
    void step(const StepInput& input = {}) {
        simulation->step(registry, input);
        drawn.took_step(registry, *simulation);
    }
    // Where it is drawn at that moment.
    mat4 shown(ecs::Entity entity, const DrawnMoment& moment) {
        drawn.apply(registry, *simulation, moment);
        const mat4 matrix = registry.get<WorldTransform>(entity).matrix;
        drawn.undo(registry);
        return matrix;
    }
    ecs::Entity lantern() {
        ecs::Entity found;
        registry.view<scene::Lantern>().each([&](ecs::Entity entity, const scene::Lantern&) { found = entity; });
        return found;
    }

    ecs::Registry registry;
    scene::MeshStore meshes;
    std::unique_ptr<Simulation> simulation;
    StepInterpolation drawn;
    ecs::Entity lift, lamp;
};

// Frame times as they come on a busy machine, s.
std::vector<double> uneven_frames(std::uint32_t seed, double shortest, double longest, std::size_t count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> time(shortest, longest);
    std::vector<double> frames(count);
    for (double& frame : frames)
        frame = time(random);
    return frames;
}

TEST(StepClock, GivesAllOfTheTimeInStepsAndARest) {
    StepClock clock;
    double time = 0.0;
    std::uint64_t steps = 0;
    for (const double frame : uneven_frames(1, 0.0, 0.19, 2000)) {
        time += frame;
        steps += clock.advance(frame);
        ASSERT_GE(clock.fraction(), 0.0f);
        ASSERT_LT(clock.fraction(), 1.0f + 1e-6f);
        // Rounding of 2,000 sums of 200 s in the end.
        ASSERT_NEAR((double(steps) + double(clock.fraction())) * step_seconds, time, 1e-6);
    }
    EXPECT_LE(clock.advance(5.0), std::uint32_t(StepClock::longest / step_seconds) + 1) << "stalls are not made up for";
    clock.reset();
    EXPECT_EQ(clock.fraction(), 0.0f);
}

// The largest relative difference between the lift's way in a frame and its speed times the frame's time.
double worst_frame(const std::vector<double>& frames, bool interpolates) {
    Hall hall;
    StepClock clock;
    for (int i = 0; i < 3; ++i)
        hall.step();
    double worst = 0.0, before = -1.0;
    for (const double frame : frames) {
        for (std::uint32_t due = clock.advance(frame); due > 0; --due)
            hall.step();
        const DrawnMoment moment{interpolates ? clock.fraction() : 1.0f, vec2(0.0f)};
        const double height = double(hall.shown(hall.lamp, moment)[3].y);
        if (before >= 0.0) {
            const double way = double(lift_speed) * frame;
            worst = std::max(worst, std::abs(height - before - way) / way);
        }
        before = height;
    }
    return worst;
}

TEST(StepInterpolation, ALiftMovesAsFarAsAFramesTimeAsks) {
    for (const auto& [shortest, longest] : {std::pair(0.004, 0.016), {0.017, 0.05}, {0.05, 0.15}}) {
        const std::vector<double> frames = uneven_frames(7, shortest, longest, 150);
        EXPECT_LT(worst_frame(frames, true), 0.01) << shortest << " to " << longest; // the bound for players is 0.1
        EXPECT_GT(worst_frame(frames, false), 0.1) << "or this test would show nothing";
    }
}

TEST(StepInterpolation, TheSimulationDoesNotSeeIt) {
    Hall drawn, undrawn;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> share(0.0f, 1.0f);
    for (int i = 0; i < 400; ++i) {
        StepInput input;
        input.forward = std::int32_t(random() % 201) - 100;
        input.turn = std::int32_t(random() % 801) - 400;
        input.buttons = i % 17 == 0 ? random() & all_buttons : 0;
        drawn.step(input);
        undrawn.step(input);
        for (std::uint32_t frames = random() % 3; frames > 0; --frames) {
            drawn.drawn.apply(drawn.registry, *drawn.simulation, {share(random), vec2(share(random))});
            drawn.drawn.undo(drawn.registry);
        }
        ASSERT_EQ(drawn.simulation->world_hash(drawn.registry), undrawn.simulation->world_hash(undrawn.registry)) << i;
    }
    drawn.registry.view<WorldTransform>().each([&](ecs::Entity entity, const WorldTransform& world) {
        EXPECT_EQ(world.matrix, undrawn.registry.get<WorldTransform>(entity).matrix);
    });
}

TEST(StepInterpolation, TheEyeGoesEvenlyAndLooksAtOnce) {
    Hall hall;
    StepInput walks;
    walks.forward = 100;
    for (int i = 0; i < 20; ++i)
        hall.step(walks);
    const vec3 before = hall.simulation->player().eye();
    hall.step(walks);
    const Character& person = hall.simulation->player();
    ASSERT_GT(glm::length(person.eye() - before), 0.0f) << "the person walks";
    const DrawnEye eye = hall.drawn.eye(*hall.simulation, {0.25f, vec2(0.3f, 9.0f)});
    EXPECT_LT(glm::length(eye.position - (before + 0.25f * (person.eye() - before))), 1e-5f);
    EXPECT_FLOAT_EQ(eye.yaw, person.yaw() + 0.3f);
    EXPECT_FLOAT_EQ(eye.pitch, largest_pitch) << "nobody looks over their head backwards";
    EXPECT_EQ(hall.drawn.eye(*hall.simulation, {}).position, person.eye()) << "headless runs draw the step itself";
}

// At rest the picture is the same, bit for bit, whatever the time of the frame.
TEST(StepInterpolation, WhatRestsDoesNotTremble) {
    Hall hall;
    for (int i = 0; i < 200; ++i)
        hall.step();
    const vec3 eye = hall.drawn.eye(*hall.simulation, {0.3f, vec2(0.0f)}).position;
    EXPECT_EQ(eye, hall.drawn.eye(*hall.simulation, {0.77f, vec2(0.0f)}).position);
    EXPECT_EQ(eye, hall.simulation->player().eye());
}

TEST(StepInterpolation, JumpsAreNoMotion) {
    Hall hall;
    for (int i = 0; i < 5; ++i)
        hall.step();
    EXPECT_NE(hall.shown(hall.lift, {0.5f}), hall.shown(hall.lift, {1.0f}));
    // A reset or checkpoint: the person is elsewhere, and the lift, too.
    hall.drawn.forget();
    hall.simulation->place_player(hall.simulation->player().capsule().foot + vec3(0.5f, 0.0f, 0.0f), vec3(0, 0, -1));
    EXPECT_EQ(hall.drawn.eye(*hall.simulation, {0.5f}).position, hall.simulation->player().eye());
    hall.step();
    EXPECT_EQ(hall.drawn.eye(*hall.simulation, {0.5f}).position, hall.simulation->player().eye());
    EXPECT_EQ(hall.shown(hall.lift, {0.5f}), hall.shown(hall.lift, {1.0f}));
    hall.step();
    EXPECT_NE(hall.shown(hall.lift, {0.5f}), hall.shown(hall.lift, {1.0f})) << "and then it goes on";
}

// The lantern in a hand stays where it is in the picture while the view turns between two steps.
TEST(StepInterpolation, WhatIsCarriedFollowsTheView) {
    Hall hall;
    const ecs::Entity lantern = hall.lantern();
    ASSERT_FALSE(lantern.is_null());
    hall.simulation->hand_lantern(hall.registry, lantern);
    for (int i = 0; i < 3; ++i)
        hall.step();
    const auto in_view = [&](const DrawnMoment& moment) {
        const DrawnEye eye = hall.drawn.eye(*hall.simulation, moment);
        const quat turned = glm::angleAxis(eye.yaw, vec3(0.0f, 1.0f, 0.0f));
        return glm::inverse(turned) * (vec3(hall.shown(lantern, moment)[3]) - eye.position);
    };
    const vec3 held = in_view({});
    StepInput turns;
    turns.turn = 900;
    hall.step(turns);
    for (const float look : {-0.4f, 0.0f, 0.2f})
        EXPECT_LT(glm::length(in_view({0.4f, vec2(look, 0.0f)}) - held), 1e-4f) << look;
}

TEST(StepInterpolation, TurnsKeepLengthsAndMirrors) {
    const mat4 size = glm::scale(mat4(1.0f), vec3(2.0f, 0.5f, 3.0f)), mirror = glm::scale(mat4(1.0f), vec3(-1, 1, 1));
    const mat4 turn = glm::rotate(mat4(1.0f), 1.2f, glm::normalize(vec3(1, 2, 3)));
    for (const mat4& shape : {size, size * mirror}) {
        const mat4 half = between(shape, turn * shape, 0.5f);
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(glm::length(vec3(half[i])), glm::length(vec3(shape[i])), 1e-5f);
        EXPECT_EQ(glm::determinant(half) > 0.0f, glm::determinant(shape) > 0.0f);
    }
    const mat4 even = between(size, turn * size, 0.25f);
    const mat4 right = glm::rotate(mat4(1.0f), 0.3f, glm::normalize(vec3(1, 2, 3))) * size;
    for (int i = 0; i < 4; ++i)
        EXPECT_LT(glm::length(even[i] - right[i]), 1e-5f) << i;
}

} // namespace
} // namespace sunfleck::simulation
