// A level of the game that is made in the editor, by what its menus and fields do, and then played by the demo.
#include "editor/document/edits.h"
#include "engine/core/file.h"
#include "engine/scene/simulation_components.h"
#include "engine/simulation/input_recording.h"
#include "game_demo/game/game_world.h"
#include "game_demo/game/turning.h"
#include "test_places.h"
#include "tests/support/folder.h"
#include "tests/support/run_tool.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

constexpr float quarter_turn = 0.5f * pi;

class EditorLevel : public testing::Test {
protected:
    Entity add(std::string_view source_name, const std::string& name, vec3 position, vec3 scale = vec3(1.0f),
               quat rotation = quat(1, 0, 0, 0)) {
        for (const scene::EntityTemplate& source : scene::entity_templates()) {
            if (source.name != source_name)
                continue;
            const Entity entity = add_from(document_, source, position, 1.0f);
            EXPECT_TRUE(rename(document_, entity, name));
            scene::Transform transform;
            transform.position = position;
            transform.rotation = rotation;
            transform.scale = scale;
            document_.begin("Place");
            document_.set(entity, pool_of<scene::Transform>(document_), std::make_shared<scene::Transform>(transform));
            document_.commit();
            return entity;
        }
        ADD_FAILURE() << "no template " << source_name;
        return {};
    }
    template <typename T>
    void edit(Entity entity, std::string_view field, std::string_view text) {
        const TypeDescription& type = T::description();
        for (const Field& one : type.fields)
            if (one.name == field) {
                const Status status = edit_field(document_, {entity}, pool_of<T>(document_), one, text);
                EXPECT_TRUE(status) << status.error().message;
                return;
            }
        ADD_FAILURE() << type.name << " has no field " << field;
    }

    void build_room() {
        add("Box", "floor", {0, -0.1f, -2}, {6.4f, 0.2f, 12.4f});
        add("Box", "ceiling", {0, 3.1f, -2}, {6.4f, 0.2f, 12.4f});
        add("Box", "west wall", {-3.1f, 1.5f, -2}, {0.2f, 3.0f, 12.4f});
        add("Box", "east wall", {3.1f, 1.5f, -2}, {0.2f, 3.0f, 12.4f});
        add("Box", "south wall", {0, 1.5f, 4.1f}, {6.4f, 3.0f, 0.2f});
        add("Box", "north wall", {0, 1.5f, -8.1f}, {6.4f, 3.0f, 0.2f});
        add("Box", "left of the door", {-1.75f, 1.5f, -2}, {2.5f, 3.0f, 0.2f});
        add("Box", "right of the door", {1.75f, 1.5f, -2}, {2.5f, 3.0f, 0.2f});
        add("Box", "above the door", {0, 2.575f, -2}, {1.0f, 0.85f, 0.2f});
    }
    // A lamp in a pit shines at the ceiling once the lid is slid aside. The eye looks up, out of the lamp's sight.
    void build_puzzle() {
        const quat up = glm::angleAxis(-quarter_turn, vec3(1, 0, 0)); // maps +Z to +Y
        const Entity lamp = add("Rectangle light", "lamp", {1.8f, 0.3f, 1.5f}, vec3(0.3f), up);
        edit<scene::AreaLight>(lamp, "radiance", "400,400,400");
        for (const float side : {-1.0f, 1.0f}) {
            add("Box", "pit", {1.8f + 0.35f * side, 0.4f, 1.5f}, {0.1f, 0.8f, 0.8f});
            add("Box", "pit", {1.8f, 0.4f, 1.5f + 0.35f * side}, {0.6f, 0.8f, 0.1f});
        }
        const Entity lid = add("Sliding panel", "lid", {1.8f, 0.86f, 1.5f}, vec3(1.0f), up);
        edit<scene::Mover>(lid, "travel", "0,0,-1.9");
        add("Sliding door", "exit", {0, 1.075f, -2});
        const Entity eye = add("Light sensor", "eye", {-0.2f, 0.5f, 3.2f}, vec3(1.0f), up);
        edit<scene::LightSensor>(eye, "threshold", "0.2,0.2,0.2");
        edit<scene::LightSensor>(eye, "opens", "exit");
    }
    void build_game() {
        add("Player start", "start", {0, 0, 1.5f}, vec3(1.0f), glm::angleAxis(-quarter_turn, vec3(0, 1, 0)));
        const Entity room = add("Game area", "area", {0, 1.5f, 1});
        edit<scene::GameArea>(room, "title", "The lid");
        add("Goal", "goal", {0, 1.5f, -5}, vec3(1.0f));
    }

    // Slides the lid aside, waits, and walks through the door.
    static std::vector<simulation::StepInput> solution() {
        std::vector<simulation::StepInput> steps(30);
        const auto take = [&](std::size_t count, const simulation::StepInput& step) {
            steps.insert(steps.end(), count, step);
        };
        take(10, {0, 0, 0, -390, 0}); // looks down at the lid
        take(1, {0, 0, 0, 0, simulation::button_use});
        take(240, {});
        take(20, {0, 0, 785, 195, 0}); // turns left, to the door
        take(240, {100, 0, 0, 0, 0});
        return steps;
    }
    // What the demo says of a level that is played so.
    nlohmann::json played(const fs::path& level, const std::string& sensors) {
        const fs::path input = folder_ / "input.txt", output = folder_ / sensors;
        EXPECT_TRUE(simulation::write_recording(input, solution()));
        const tests::Outcome run =
            tests::shell(std::string(SUNFLECK_DEMO) + " --headless --simulate --scene " + level.string() + " --input " +
                         input.string() + " --sensors " + sensors + " -o " + output.string());
        EXPECT_EQ(run.status, 0) << run.output;
        const auto text = read_file(output / "stats.json");
        return text ? nlohmann::json::parse(*text) : nlohmann::json();
    }

    // A saved level, played here.
    struct Game {
        explicit Game(const fs::path& level) {
            scene::register_components(registry);
            EXPECT_TRUE(io::load_scene(level, registry, meshes, textures, {}));
            world = demo::GameWorld::create(registry, meshes, &textures).value();
        }
        void run(std::uint32_t steps, const simulation::StepInput& input = {}) {
            for (std::uint32_t i = 0; i < steps; ++i)
                EXPECT_TRUE(world->step(input));
        }
        void look_at(vec3 target) {
            float off = 1.0f;
            for (int i = 0; i < 300 && off > 0.01f; ++i)
                run(1, demo::turn_to(person(), target, off));
        }
        const simulation::Character& person() const { return world->simulation().player(); }
        vec3 at(const char* name) {
            return vec3(scene::world_matrix(registry, scene::find_by_name(registry, name))[3]);
        }
        const scene::SensorReading& reading(const char* sensor) {
            return registry.get<scene::SensorReading>(scene::find_by_name(registry, sensor));
        }

        ecs::Registry registry;
        scene::MeshStore meshes;
        scene::TextureStore textures;
        std::unique_ptr<demo::GameWorld> world;
    };

    const tests::Folder folder_{"editor_level"};
    Document document_;
};

TEST_F(EditorLevel, OfSensorsDoorsPanelsAndAnEndIsPlayed) {
    build_room();
    build_puzzle();
    build_game();
    const fs::path level = folder_ / "level.scene.json";
    ASSERT_TRUE(document_.save(level));
    const nlohmann::json all = played(level, "all");
    EXPECT_EQ(all.value("finished", false), true) << all.dump(2);
    // Reflected light is what opens the door.
    EXPECT_EQ(played(level, "direct").value("finished", true), false);
}

// What Add has beside doors and panels does what its name says.
TEST_F(EditorLevel, ALiftABlockAShutterAndAGaugeWork) {
    build_room();
    add("Player start", "start", {-1.5f, 0, 2});
    add("Lift", "lift", {2, 1.6f, 2});
    add("Block", "block", {-1.5f, 0.4f, 0.5f});
    add("Shutter", "shutter", {0.2f, 1.2f, 3.0f});
    add("Gauge", "gauge", {-3, 0.5f, 3}, vec3(1.0f), glm::angleAxis(quarter_turn, vec3(0, 1, 0)));
    add("Point light", "lamp", {0, 2.5f, 1});
    const Entity eye =
        add("Light sensor", "eye", {2.9f, 1.2f, 0}, vec3(1.0f), glm::angleAxis(-quarter_turn, vec3(0, 1, 0)));
    edit<scene::LightSensor>(eye, "shows", "gauge marker");
    const fs::path level = folder_ / "level.scene.json";
    ASSERT_TRUE(document_.save(level));
    Game game(level);
    EXPECT_NEAR(game.at("lift").y, 0.1f, 0.01f) << "it begins at the bottom";
    const vec3 block = game.at("block"), marker = game.at("gauge marker"), panel = game.at("shutter panel");
    EXPECT_NEAR(panel.x, 0.7f, 0.01f);
    game.run(90, {100, 0, 0, 0, 0});
    EXPECT_LT(game.at("block").z, block.z - 0.3f) << "pushed";
    EXPECT_GT(game.at("gauge marker").y, marker.y + 0.1f) << "the eye gets light";
    game.run(330);
    EXPECT_NEAR(game.at("lift").y, 3.1f, 0.01f) << "after half its period";
    game.world->simulation().place_player({0.7f, 0.0f, 1.8f}, {0, 0, 1});
    game.run(5);
    game.look_at(panel);
    game.run(1, {0, 0, 0, 0, simulation::button_use});
    game.run(360);
    EXPECT_NEAR(glm::length(game.at("shutter panel") - vec3(0.2f, 1.2f, 3.0f)), 0.5f, 0.01f) << "about its hinge";
    EXPECT_GT(glm::length(game.at("shutter panel") - panel), 0.7f) << "it stands open";
}

// Its own parts cast no shadow: the eye reads more, the nearer the lantern comes.
TEST_F(EditorLevel, ALanternIsTakenCarriedAndLightsAnEye) {
    build_room();
    add("Player start", "start", {0, 0, 2.5f});
    add("Lantern", "lantern", {0, 0, 1.2f});
    const quat east = glm::angleAxis(quarter_turn, vec3(0, 1, 0)); // maps +Z to +X
    const Entity eye = add("Light sensor", "eye", {-2.9f, 1.2f, -0.5f}, vec3(1.0f), east);
    edit<scene::LightSensor>(eye, "threshold", "9,9,9");
    const fs::path level = folder_ / "level.scene.json";
    ASSERT_TRUE(document_.save(level));
    Game game(level);
    game.run(30);
    const float before = game.reading("eye").irradiance.x;
    EXPECT_GT(before, 0.0f);
    game.look_at({0, 0.15f, 1.2f});
    game.run(1, {0, 0, 0, 0, simulation::button_use});
    ASSERT_TRUE(game.world->simulation().carries_lantern());
    game.look_at({-2.0f, 1.4f, -0.5f});
    const vec3 start = game.person().capsule().foot;
    game.run(60, {100, 0, 0, 0, 0});
    EXPECT_NEAR(glm::length(game.person().capsule().foot - start), 2.2f, 0.3f) << "a second at 2.4 m/s";
    EXPECT_NEAR(game.person().capsule().foot.y, 0.0f, 0.03f);
    game.run(60);
    EXPECT_GT(game.reading("eye").irradiance.x, 2.0f * before);
}

} // namespace
} // namespace sunfleck::editor
