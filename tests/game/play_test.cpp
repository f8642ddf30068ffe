// The game: panels without colour, states at random, players without aim.
#include "engine/core/random.h"
#include "gi_module/reference/path_tracer.h"
#include "tests/game/played_game.h"
#include "tests/support/test_size.h"

#include <span>

namespace sunfleck::demo {
namespace {

using tests::Played;
using tests::steps_a_minute;

TEST(Game, WhitePanelsOpenNoColouredDoor) {
    // Each coloured room by itself: with white panels the solution does not get past the first.
    const std::vector<const char*> rooms = {"area red wall", "area blocks", "area colours"};
    for (const char* room : std::span(rooms).first(tests::by_size<std::size_t>(1, rooms.size()))) {
        Played played({}, true);
        const auto& area = played.enter(room);
        Solution solution(*played.world);
        for (std::uint64_t k = 0; k < 3 * steps_a_minute && !solution.ended(); ++k)
            played.step(solution.next());
        EXPECT_NE(solution.problem(), "") << area.title;
        EXPECT_EQ(played.world->sensors_opened(), 0u) << area.title;
    }
}

float number(std::uint32_t state, std::uint32_t dimension) {
    return to_unit_float(hash_combine(state, dimension));
}

// The lantern anywhere in a room, and what is used there anyhow.
void scatter(Played& played, ecs::Entity area, std::uint32_t state) {
    const vec3 centre(scene::world_matrix(played.registry, area)[3]);
    const vec3 half = played.registry.get<scene::GameArea>(area).half_size - vec3(0.5f, 0.0f, 0.5f);
    scene::Transform place;
    place.position = centre + half * (2.0f * vec3(number(state, 0), 0.0f, number(state, 1)) - 1.0f);
    place.position.y = centre.y - half.y + 1.3f * number(state, 2);
    played.world->simulation().put_lantern(played.registry, scene::find_by_name(played.registry, "lantern"), place);
    std::vector<ecs::Entity> used;
    played.registry.view<scene::Mover, scene::MoverState>().each(
        [&](ecs::Entity entity, const scene::Mover& mover, const scene::MoverState&) {
            if (mover.activation == scene::MoverActivation::use)
                used.push_back(entity);
        });
    for (const ecs::Entity entity : used)
        played.registry.update<scene::MoverState>(entity, {0.0f, number(state, 10 + entity.index) < 0.5f});
}

vec3 truth(Played& played, ecs::Entity sensor, std::uint32_t samples) {
    const auto rays = raytrace::RayScene::create().value();
    EXPECT_TRUE(rays->update(played.registry, played.meshes));
    const gi::reference::PathTracer tracer(
        *rays,
        gi::collect_emitters(played.registry, played.meshes, {vec3(-4.0f, 0.0f, -13.0f), vec3(16.0f, 7.0f, 11.0f)}));
    const mat4& place = played.registry.get<scene::WorldTransform>(sensor).matrix;
    vec3 sum(0.0f);
    for (const vec3 part :
         tracer.irradiance_by_bounce(vec3(place[3]), glm::normalize(vec3(place[2])), gi::sensor_bounces, samples, 11))
        sum += part;
    return sum;
}

// Beyond twice the threshold nothing depends on the share.
float judged(float share) {
    return std::min(share, 2.0f);
}

TEST(Game, SensorsAgreeWithThePathTracer) {
    const std::uint32_t states = tests::by_size(4u, 200u), samples = tests::by_size(16384u, 65536u);
    Played played;
    std::vector<ecs::Entity> areas, sensors;
    played.registry.view<scene::GameArea>().each([&](ecs::Entity entity, const scene::GameArea& area) {
        if (!area.goal)
            areas.push_back(entity);
    });
    played.registry.view<scene::LightSensor>().each(
        [&](ecs::Entity entity, const scene::LightSensor&) { sensors.push_back(entity); });
    float worst = 0.0f;
    for (std::uint32_t state = 1; state <= states; ++state) {
        if (!tests::in_part(state))
            continue;
        scatter(played, areas[state % areas.size()], state);
        for (int k = 0; k < 5 * 60; ++k)
            played.step({});
        for (const ecs::Entity sensor : sensors) {
            const auto& described = played.registry.get<scene::LightSensor>(sensor);
            const float expected = judged(scene::sensor_share(described, truth(played, sensor, samples)));
            const float got = judged(played.registry.get<scene::SensorReading>(sensor).share);
            worst = std::max(worst, std::abs(got - expected));
            EXPECT_NEAR(got, expected, 0.1f) << played.registry.get<scene::Name>(sensor).name << " in state " << state;
        }
    }
    std::printf("worst error %.3f of the threshold\n", double(worst));
}

TEST(Game, AimlessPlayersCannotBreakIt) {
    const std::uint32_t players = tests::by_size(1u, 50u), steps = tests::by_size(1800u, 36000u);
    for (std::uint32_t player = 1; player <= players; ++player) {
        if (!tests::in_part(player))
            continue;
        Played played;
        for (std::uint32_t k = 0; k < steps; ++k)
            played.step(tests::aimless(player, k));
        EXPECT_LE(played.world->sensors_opened(), 2u) << "player " << player;
        EXPECT_EQ(played.world->simulation().player().rescued(), 0u) << "player " << player;
        if (played.world->finished())
            continue;
        simulation::StepInput reset;
        reset.buttons = simulation::button_reset;
        played.step({});
        played.step(reset);
        played.hashes.clear();
        // In the short size, half a minute of what is left to do.
        played.solve(tests::by_size<std::uint64_t>(steps_a_minute / 2, 15 * steps_a_minute));
        EXPECT_EQ(played.problem, "") << "player " << player;
        EXPECT_TRUE(played.world->finished() || !tests::long_size()) << "player " << player;
    }
}

} // namespace
} // namespace sunfleck::demo
