// Every counter that is declared: distinct, explained, in --stats, and counting something somewhere.
#include "editor/command_line/common.h"
#include "gi_module/visibility/scene_visibility.h"
#include "tests/support/gpu_world.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

namespace sunfleck::tests {
namespace {

class Counters : public GpuTest {};

// Shares and other pure numbers.
bool is_pure_ratio(const gi::Counter& counter) {
    return counter.name == "pass_fill";
}

TEST_F(Counters, AreNamedOnceAndExplained) {
    std::set<std::string_view> names;
    for (const gi::Counter* counter : gi::all_counters()) {
        EXPECT_TRUE(names.insert(counter->name).second) << counter->name << " is declared twice";
        EXPECT_FALSE(counter->tooltip.empty()) << counter->name;
        EXPECT_FALSE(counter->group.empty()) << counter->name;
        EXPECT_EQ(counter->unit.empty(), is_pure_ratio(*counter)) << counter->name;
    }
    EXPECT_GE(names.size(), 25u);
}

TEST_F(Counters, AreInTheStatistics) {
    command_line::Measurement measurement;
    const nlohmann::ordered_json json = command_line::measurement_json(device(), measurement);
    for (const gi::Counter* counter : gi::all_counters()) {
        const char* part = counter->group == gi::memory_group ? "memory_bytes" : "counters";
        EXPECT_TRUE(json[part].contains(std::string(counter->name))) << counter->name;
    }
}

TEST_F(Counters, ViewsAreNamedOnceAndExplained) {
    std::set<std::string_view> names;
    for (const gi::DebugView* view : gi::debug_views()) {
        EXPECT_TRUE(names.insert(view->name).second) << view->name << " is declared twice";
        EXPECT_FALSE(view->tooltip.empty()) << view->name;
        EXPECT_FALSE(view->legend.empty()) << view->name;
        EXPECT_FALSE(view->group.empty()) << view->name;
    }
}

using Changes = std::vector<std::pair<const char*, const char*>>; // settings by name

struct Course {
    void (*make)(assets::SceneBuilder&);
    Changes changes;
    std::uint32_t width = 64, height = 48;
    Changes halfway{}; // from the third frame on
    std::uint32_t strength_budget = 0xffffffffu;
    float last_indirect_scale = 1.0f; // in the last frame
    std::uint32_t view = shared::view_irradiance;
    std::uint32_t map_budget = 0xffffffffu; // of the host
};

// Small scenes in which, together, each counter has something to count.
const std::vector<Course>& courses() {
    static const std::vector<Course> list = {
        {assets::make_four_pillars, {{"count_passes", "on"}, {"map_budget", "1"}}},
        {assets::make_arena, {{"movers", "prt"}, {"lights", "90"}}},
        {assets::make_arena, {{"splat_lights", "moving"}}},
        {assets::make_arena, {{"gather_lights", "moving"}}},
        {assets::make_near_occluder,
         {{"map_budget", "0"}, {"mover_share", "0.2"}}}, // a knot moves in the light of a spot
        // With other maps, all light is baked again; after a level's first frame, that is work of several.
        {assets::make_two_rooms, {{"lights", "300"}}, 64, 48, {{"shadow_map_resolution", "32"}}},
        {assets::make_cornell, {{"direct", "brute_force"}, {"indirect", "brute_force"}, {"count_clamped", "on"}}},
        {assets::make_ring, {{"specular", "gloss"}}, 64, 48, {}, 0xffffffffu, 1.0f, shared::view_final},
        {assets::make_cornell, {{"baked_samples", "100"}}},
        {assets::make_cornell, {}, 64, 48, {}, 2, 0.5f}, // bounced light is dimmed, two samples a frame
        {assets::make_cornell, {{"repair_contrast", "0"}, {"repair_angle", "0.1"}, {"low_resolution", "4"}}, 640, 480},
        // Fine light maps of many samples, in portions.
        {assets::make_near_occluder,
         {{"lights", "600"}, {"clamp_scale", "8"}, {"patch_levels", "0"}},
         64,
         48,
         {},
         0xffffffffu,
         1.0f,
         shared::view_irradiance,
         1000},
    };
    return list;
}

// The greatest value of each counter over a few frames of motion. Settings of techniques that are not there are passed
// over.
void count(const Course& course, std::map<std::string, double>& greatest) {
    GpuWorld world(course.make, "view");
    gi::Settings settings;
    settings.lights = 60;
    settings.shadow_map_resolution = 64;
    const auto change = [&](const Changes& changes) {
        for (const auto& [name, value] : changes)
            static_cast<void>(settings.set(name, value));
        world.set(settings);
    };
    change(course.changes);
    world.request.width = course.width;
    world.request.strength_budget = course.strength_budget;
    world.request.map_budget = course.map_budget;
    world.request.height = course.height;
    world.request.view = course.view;
    std::set<std::string_view> declared;
    for (const gi::Counter* counter : gi::all_counters())
        declared.insert(counter->name);
    const auto refines = [&] { return world.renderer->lighting().counters()["refined_light_waiting"] > 0.0; };
    for (int frame = 0; frame < 4 || (frame < 16 && refines()); ++frame) {
        world.request.step = std::uint64_t(frame) * 15;
        if (frame == 2 && !course.halfway.empty())
            change(course.halfway);
        world.request.indirect_scale = frame == 3 ? course.last_indirect_scale : 1.0f;
        world.render();
        for (const gi::Report::Value& value : world.renderer->lighting().counters().values()) {
            EXPECT_TRUE(declared.count(value.counter->name)) << value.counter->name << " is reported, not declared";
            double& most = greatest[std::string(value.counter->name)];
            most = std::max(most, value.value);
        }
    }
}

// Counters of what no technique of the list makes use of.
std::set<std::string_view> without_use() {
    const auto any = [](bool gi::TechniqueEntry::*wants) {
        return std::any_of(gi::techniques().begin(), gi::techniques().end(),
                           [&](const gi::TechniqueEntry& technique) { return technique.*wants; });
    };
    std::set<std::string_view> names;
    const auto add = [&](std::span<const gi::Counter> counters) {
        for (const gi::Counter& counter : counters)
            names.insert(counter.name);
    };
    if (!any(&gi::TechniqueEntry::lights_pixels))
        add(gi::LowResolution::counters());
    if (!any(&gi::TechniqueEntry::wants_visibility)) {
        add(gi::SceneVisibility::counters());
        names.insert("shadow_maps_stale"); // no map waits then
    }
    return names;
}

TEST_F(Counters, EachCountsSomethingSomewhere) {
    std::map<std::string, double> greatest;
    const std::set<std::string_view> unused = without_use();
    for (const Course& course : courses())
        count(course, greatest);
    for (const gi::Counter* counter : gi::all_counters())
        EXPECT_TRUE(unused.count(counter->name) || greatest[std::string(counter->name)] > 0.0) << counter->name;
}

// What several techniques count in one frame is counted once for each.
TEST_F(Counters, TwoTechniquesAddUpWhatBothCount) {
    GpuWorld world(assets::make_cornell, "view");
    gi::Settings settings;
    settings.lights = 60;
    settings.shadow_map_resolution = 64;
    const auto batches = [&](std::string_view direct, std::string_view indirect) {
        world.set(settings.with("direct", direct).with("indirect", indirect).with("sampled_light", "all"));
        world.render();
        return world.renderer->lighting().counters()["light_batches"];
    };
    const auto& choices = gi::Settings::find("direct")->choices; // the last one is none
    const std::string_view first = choices.front(), second = choices[choices.size() - 2];
    if (first == second)
        GTEST_SKIP() << "this build has one technique for all light";
    EXPECT_EQ(batches(first, second), batches(first, "none") + batches("none", second));
}

} // namespace
} // namespace sunfleck::tests
