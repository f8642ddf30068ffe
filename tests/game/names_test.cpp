// Names that components have of other entities: blanks around them, and names that mean nothing.
#include "assets/test_rooms.h"
#include "engine/core/log.h"
#include "tests/game/small_level.h"

namespace sunfleck::demo {
namespace {

using tests::SmallLevel;

// A door and a gauge that eyes name, and a lamp with a switch.
struct LevelWithNames : SmallLevel {
    LevelWithNames() {
        scene::Mover mover;
        mover.path = scene::MoverPath::line;
        mover.activation = scene::MoverActivation::sensor;
        for (const char* name : {"door", "gauge"})
            registry.emplace<scene::Mover>(box(name, {name[0] == 'd' ? 1.0f : 3.0f, 1.0f, 0.0f}, vec3(0.5f)), mover);
        eye = group("eye", {0.0f, 1.0f, 0.0f});
        registry.emplace<scene::LightSensor>(eye, {});
        builder.point_light("lamp", {0.0f, 2.5f, 0.0f}, vec3(5.0f));
        plate = box("switch", {2.0f, 1.2f, 0.0f}, {0.2f, 0.2f, 0.2f});
    }
    void name(const std::string& opens, const std::string& shows, const std::string& lamps) {
        registry.patch<scene::LightSensor>(eye, [&](scene::LightSensor& sensor) {
            sensor.opens = opens;
            sensor.shows = shows;
        });
        registry.emplace_or_replace<scene::LightSwitch>(plate, {lamps, false});
    }
    std::vector<std::string> warnings() {
        std::vector<std::string> lines;
        const LogSink sink = [&](LogLevel, std::string_view line) { lines.emplace_back(line); };
        const ThreadLogSink scope(sink);
        begin();
        return lines;
    }
    ecs::Entity eye, plate;
};

TEST(GameNames, BlanksAroundNamesDoNotMatter) {
    LevelWithNames level;
    level.name(" door , ", "\tgauge", "lamp ");
    EXPECT_EQ(level.warnings(), std::vector<std::string>());
    EXPECT_EQ(level.registry.get<scene::PointLight>(scene::find_by_name(level.registry, "lamp")).intensity, vec3(0.0f))
        << "the switch, which is off, has found its lamp";
    level.registry.emplace_or_replace<scene::SensorReading>(level.eye, {vec3(9.0f), 9.0f, true});
    level.world->simulation().step(level.registry, {});
    for (const char* name : {"door", "gauge"})
        EXPECT_GT(level.registry.get<scene::MoverState>(scene::find_by_name(level.registry, name)).progress, 0.0f)
            << name;
}

TEST(GameNames, EachThatMeansNothingIsSaidOnce) {
    LevelWithNames level;
    level.name("door, dor, lamp", "gauge, switch", "lamp, lmp, door");
    const std::vector<std::string> expected = {
        "'dor', which 'eye' names (opens), does not exist",
        "'lamp', which 'eye' names (opens), is no mover with the activation 'sensor'",
        "'switch', which 'eye' names (shows), is no mover with the activation 'sensor'",
        "'lmp', which 'switch' names (lamps), does not exist", "'door', which 'switch' names (lamps), is no lamp"};
    EXPECT_EQ(level.warnings(), expected);
}

TEST(GameNames, AllOfTheBuiltInLevelsMeanSomething) {
    for (auto* make : {assets::make_lantern_game, assets::make_lantern_house}) {
        ecs::Registry registry;
        scene::MeshStore meshes;
        assets::SceneBuilder builder(registry, meshes);
        make(builder);
        EXPECT_EQ(scene::wrong_names(registry), std::vector<std::string>());
    }
}

TEST(GameNames, AListFollowsAName) {
    EXPECT_EQ(scene::with_other_name("door, door 2 ,door", "door", "gate"), "gate, door 2 ,gate");
    EXPECT_EQ(scene::with_other_name("", "door", "gate"), "");
    EXPECT_EQ(scene::with_other_name(" ,door,", "door", "g"), " ,g,");
    EXPECT_EQ(scene::with_other_name("a door", "door", "gate"), "a door");
}

// Whatever a name has in it, a list that names it says so again.
TEST(GameNames, AListTakesEveryName) {
    for (const std::string name :
         {"hall, left", "\"", "a \"wide\" door", "\"quoted\"", ",", "  far  ", "\"a, b", "x"}) {
        const std::string list = scene::with_other_name("first,door , last", "door", name);
        EXPECT_EQ(scene::split_names(list), (std::vector<std::string>{"first", name, "last"})) << list;
        EXPECT_EQ(scene::with_other_name(list, name, "door"), "first,door , last");
    }
    const std::vector<std::string> open{"\"never closed", "door"};
    EXPECT_EQ(scene::split_names("\"never closed, door"), open);
}

} // namespace
} // namespace sunfleck::demo
