// A game that is played without pictures.
#pragma once

#include "assets/test_rooms.h"
#include "engine/core/random.h"
#include "engine/ecs/world_copy.h"
#include "game_demo/game/solution.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <map>
#include <string_view>

namespace sunfleck::tests {

inline constexpr std::uint64_t steps_a_minute = 3600;

// Between the two sizes there is a third one, of minutes, for whoever changes the game: ./run test -R game.
inline bool share_size() {
    const char* size = std::getenv("SUNFLECK_TEST_SIZE");
    return size != nullptr && std::string_view(size) == "share";
}
template <typename T>
T by_game_size(T in_short, T in_share, T in_long) {
    return share_size() ? in_share : by_size(in_short, in_long);
}

struct Played {
    explicit Played(const gi::SensorSettings& settings = {}, bool white_panels = false) {
        assets::SceneBuilder builder(registry, meshes);
        assets::make_lantern_game(builder);
        if (white_panels)
            for (const char* name : {"red panel", "green block", "red sheet", "blue sheet"})
                registry.patch<scene::Material>(scene::find_by_name(registry, name),
                                                [](scene::Material& m) { m.base_colour = vec3(0.7f); });
        scene::update_world_transforms(registry);
        ecs::copy_world(registry, start);
        world = demo::GameWorld::create(registry, meshes, nullptr, settings).value();
    }

    void step(const simulation::StepInput& input) {
        ASSERT_TRUE(world->step(input));
        hashes.push_back(world->simulation().world_hash(registry));
        registry.view<scene::LightSensor, scene::SensorReading, scene::Name>().each(
            [&](ecs::Entity, const scene::LightSensor&, const scene::SensorReading& reading, const scene::Name& name) {
                float& best = most[name.name];
                best = std::max(best, reading.share);
            });
        milliseconds = std::max(milliseconds, world->sensors().milliseconds());
        sum_of_milliseconds += world->sensors().milliseconds();
        if (watch)
            watch();
    }

    // The person stands at the entry of the area of this name, with the lantern in hand.
    const scene::GameArea& enter(const std::string& name) {
        const ecs::Entity entity = scene::find_by_name(registry, name);
        const auto& area = registry.get<scene::GameArea>(entity);
        world->simulation().hand_lantern(registry, scene::find_by_name(registry, "lantern"));
        world->simulation().place_player(vec3(scene::world_matrix(registry, entity)[3]) + area.entry,
                                         area.entry_facing);
        step({});
        return area;
    }

    // Plays the solution to its end, or so many steps.
    void solve(std::uint64_t limit = 15 * steps_a_minute) {
        demo::Solution solution(*world);
        while (!solution.ended() && hashes.size() < limit)
            step(solution.next());
        problem = solution.problem();
    }

    ecs::Registry registry, start; // now, and as it was loaded
    scene::MeshStore meshes;
    std::unique_ptr<demo::GameWorld> world;
    std::vector<std::uint64_t> hashes;
    std::map<std::string, float> most; // share that each sensor read at most
    std::string problem;
    double milliseconds = 0.0, sum_of_milliseconds = 0.0;
    std::function<void()> watch; // called after each step
};

// Goes about without aim.
inline simulation::StepInput aimless(std::uint32_t seed, std::uint32_t step) {
    const std::uint32_t stride = hash_combine(seed, step / 40);
    simulation::StepInput input;
    input.forward = to_unit_float(hash_combine(stride, 1)) < 0.8f ? 100 : -60;
    input.right = std::int32_t(to_unit_float(hash_combine(stride, 2)) * 120.0f) - 60;
    input.turn = std::int32_t(to_unit_float(hash_combine(stride, 3)) * 800.0f) - 400;
    input.look_up = std::int32_t(to_unit_float(hash_combine(stride, 4)) * 100.0f) - 50;
    const float act = to_unit_float(hash_combine(seed, 7919u + step));
    if (act < 0.022f)
        input.buttons = act < 0.02f ? simulation::button_use : simulation::button_put_down;
    const float haste = to_unit_float(hash_combine(stride, 5));
    if (haste < 0.3f)
        input.buttons |= haste < 0.15f ? simulation::button_run : simulation::button_crouch;
    return input;
}

} // namespace sunfleck::tests
