// A level of the game that is made in the editor, by what its menus and fields do, and then played by the demo.
#include "editor/document/edits.h"
#include "engine/core/file.h"
#include "engine/scene/simulation_components.h"
#include "engine/simulation/input_recording.h"
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

} // namespace
} // namespace sunfleck::editor
