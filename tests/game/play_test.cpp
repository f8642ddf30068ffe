// The game: panels without colour, states at random, players without aim.
#include "engine/core/random.h"
#include "gi_module/reference/path_tracer.h"
#include "tests/game/played_game.h"
#include "tests/support/test_size.h"

#include <span>
#include <utility>

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

// The lantern anywhere in a room, what is used there anyhow, and the block anywhere along its rails.
void scatter(Played& played, ecs::Entity area, std::uint32_t state) {
    const vec3 centre(scene::world_matrix(played.registry, area)[3]);
    const vec3 half = played.registry.get<scene::GameArea>(area).half_size - vec3(0.5f, 0.0f, 0.5f);
    scene::Transform place;
    place.position = centre + half * (2.0f * vec3(number(state, 0), 0.0f, number(state, 1)) - 1.0f);
    place.position.y = centre.y - half.y + 1.3f * number(state, 2);
    simulation::Simulation& simulation = played.world->simulation();
    simulation.put_lantern(played.registry, scene::find_by_name(played.registry, "lantern"), place);
    place.position = vec3(6.3f, 0.4f, glm::mix(1.9f, 4.6f, number(state, 3)));
    simulation.physics().place(played.registry, scene::find_by_name(played.registry, "green block"), place);
    std::vector<ecs::Entity> used;
    played.registry.view<scene::Mover, scene::MoverState>().each(
        [&](ecs::Entity entity, const scene::Mover& mover, const scene::MoverState&) {
            if (mover.activation == scene::MoverActivation::use)
                used.push_back(entity);
        });
    for (const ecs::Entity entity : used)
        played.registry.update<scene::MoverState>(entity, {0.0f, number(state, 10 + entity.index) < 0.5f});
}

// Waits until light has changed for the last time, but for what goes by the clock and never rests.
class Rest {
public:
    explicit Rest(Played& played) : played_(played) {}

    // Steps until nothing has moved for a second; false: something still moves after half a minute. `check` is called
    // at each step from half a second after the last movement on.
    bool wait(const std::function<void()>& check) {
        constexpr std::uint32_t second = 60, longest = 30 * second;
        std::uint32_t still = 0;
        for (std::uint32_t k = 0; k < longest && still < second; ++k) {
            played_.step({});
            still = moved() ? 0 : still + 1;
            if (still >= second / 2)
                check();
        }
        return still >= second;
    }

private:
    bool moved() {
        bool any = false;
        played_.registry.view<scene::Mover, scene::WorldTransform>().each(
            [&](ecs::Entity entity, const scene::Mover& mover, const scene::WorldTransform& world) {
                const bool by_the_clock =
                    mover.path != scene::MoverPath::none && mover.activation == scene::MoverActivation::clock;
                const auto* casting = played_.registry.try_get<scene::ShadowCasting>(entity); // gauges do not
                if (!by_the_clock && (casting == nullptr || casting->casts))
                    any |= std::exchange(places_[entity], world.matrix) != world.matrix;
            });
        return any;
    }

    Played& played_;
    std::map<ecs::Entity, mat4> places_;
};

// How far a share may be off: a tenth of the threshold, and where far more than enough arrives, a twentieth of that.
float allowed(float share) {
    return 0.1f * std::max(1.0f, 0.5f * share);
}

// The share by the path tracer: 65,536 samples, and more, independent ones, until its own error (of the mean, by the
// spread of the rounds) is a fifth of what is allowed: beside the beam's lamp, few of its paths carry much.
float true_share(Played& played, ecs::Entity sensor) {
    constexpr std::uint32_t samples = 16384, least = 4, most = 64; // rounds
    const auto rays = raytrace::RayScene::create().value();
    EXPECT_TRUE(rays->update(played.registry, played.meshes));
    const gi::reference::PathTracer tracer(
        *rays,
        gi::collect_emitters(played.registry, played.meshes, {vec3(-4.0f, 0.0f, -13.0f), vec3(16.0f, 7.0f, 11.0f)}));
    const auto& described = played.registry.get<scene::LightSensor>(sensor);
    const mat4& place = played.registry.get<scene::WorldTransform>(sensor).matrix;
    glm::dvec3 sum(0.0);
    double shares = 0.0, squares = 0.0;
    for (std::uint32_t round = 1;; ++round) {
        vec3 irradiance(0.0f);
        for (const vec3 part : tracer.irradiance_by_bounce(vec3(place[3]), glm::normalize(vec3(place[2])),
                                                           gi::sensor_bounces, samples, 11 + round))
            irradiance += part;
        sum += glm::dvec3(irradiance);
        const double share = double(scene::sensor_share(described, irradiance));
        shares += share;
        squares += share * share;
        const double n = round, variance = std::max(squares - shares * shares / n, 0.0) / std::max(n - 1.0, 1.0);
        const float mean = scene::sensor_share(described, vec3(sum / n));
        if (round >= most || (round >= least && std::sqrt(variance / n) < 0.2 * double(allowed(mean))))
            return mean;
    }
}

struct Watched {
    ecs::Entity entity;
    std::string name;
    float share = 0.0f; // half a second after the last movement
    bool open = false;
};

// No door stays open for what there was before.
std::vector<Watched> sensors_that_close_again(Played& played) {
    std::vector<Watched> sensors;
    played.registry.view<scene::LightSensor, scene::Name>().each(
        [&](ecs::Entity entity, const scene::LightSensor&, const scene::Name& name) {
            sensors.push_back({entity, name.name});
        });
    for (const Watched& sensor : sensors)
        played.registry.patch<scene::LightSensor>(sensor.entity, [](scene::LightSensor& s) { s.keeps_open = false; });
    return sensors;
}

TEST(Game, SensorsAgreeWithThePathTracer) {
    const std::uint32_t states = tests::by_game_size(4u, 20u, 200u);
    Played played;
    std::vector<ecs::Entity> areas;
    played.registry.view<scene::GameArea>().each([&](ecs::Entity entity, const scene::GameArea& area) {
        if (!area.goal)
            areas.push_back(entity);
    });
    std::vector<Watched> sensors = sensors_that_close_again(played);
    Rest rest(played);
    float worst = 0.0f, farthest = 0.0f, slowest = 0.0f;
    for (std::uint32_t state = 1; state <= states; ++state) {
        if (!tests::in_part(state))
            continue;
        scatter(played, areas[state % areas.size()], state);
        bool first = true;
        EXPECT_TRUE(rest.wait([&] {
            for (Watched& sensor : sensors) {
                const auto& reading = played.registry.get<scene::SensorReading>(sensor.entity);
                if (first)
                    sensor.share = reading.share;
                EXPECT_TRUE(first || reading.open == sensor.open)
                    << sensor.name << " toggles at rest, in state " << state;
                sensor.open = reading.open;
            }
            first = false;
        })) << "something moves on in state "
            << state;
        for (const Watched& sensor : sensors) {
            const float expected = true_share(played, sensor.entity);
            const float got = played.registry.get<scene::SensorReading>(sensor.entity).share;
            (expected > 2.0f ? farthest : worst) =
                std::max(expected > 2.0f ? farthest : worst, std::abs(got - expected));
            slowest = std::max(slowest, std::abs(got - sensor.share) / allowed(expected));
            EXPECT_NEAR(got, expected, allowed(expected)) << sensor.name << " in state " << state;
            EXPECT_NEAR(got, sensor.share, 0.5f * allowed(expected))
                << sensor.name << " in state " << state << " follows more than half a second later";
        }
    }
    std::printf("worst error %.3f of the threshold, where it gets more than twice of it %.3f\n", double(worst),
                double(farthest));
    std::printf("worst change between half a second and a second at rest: %.3f of what is allowed\n", double(slowest));
}

// Within the walls, and on the floor.
void walk_without_aim(Played& played, std::uint32_t player, std::uint32_t steps) {
    const Bounds walls = played.world->simulation().physics().bounds();
    for (std::uint32_t k = 0; k < steps; ++k) {
        played.step(tests::aimless(player, k));
        const vec3 foot = played.world->simulation().player().capsule().foot;
        ASSERT_TRUE(foot.x > walls.minimum.x && foot.x < walls.maximum.x && foot.z > walls.minimum.z &&
                    foot.z < walls.maximum.z && foot.y > -0.05f && foot.y < walls.maximum.y)
            << "player " << player << " in step " << k << ": " << foot.x << " " << foot.y << " " << foot.z;
    }
}

// Where players begin: those who begin at the beginning do not get far.
constexpr const char* begins[] = {nullptr,         "area corner",   "area tower",   "area blocks",
                                  "area shutters", "area red wall", "area colours", "area lamp room"};

TEST(Game, AimlessPlayersCannotBreakIt) {
    const std::uint32_t players = tests::by_game_size(1u, 3u, 50u);
    const std::uint32_t steps = tests::by_game_size(1800u, 36000u, 36000u);
    for (std::uint32_t player = 1; player <= players; ++player) {
        if (!tests::in_part(player))
            continue;
        Played played;
        if (const char* area = begins[player % std::size(begins)]; area != nullptr)
            played.enter(area);
        walk_without_aim(played, player, steps);
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
        const std::uint64_t rest = 15 * steps_a_minute;
        played.solve(tests::by_game_size(steps_a_minute / 2, rest, rest));
        EXPECT_EQ(played.problem, "") << "player " << player;
        EXPECT_TRUE(played.world->finished() || tests::by_game_size(true, false, false)) << "player " << player;
    }
}

} // namespace
} // namespace sunfleck::demo
