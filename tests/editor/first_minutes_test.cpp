// An artist's first ten minutes, by X events alone: a dropped file is lit, measured, compared, saved, and all is back
// in the next run.
#include "tests/editor/size_scene.h"
#include "tests/editor/window_fixture.h"

#include <cmath>
#include <cstring>
#include <regex>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::DrivenEditor;

class EditorWindowFirst : public tests::EditorWindowTest {
protected:
    EditorWindowFirst() : EditorWindowTest("1440x900") {}
    void drop(const std::string& file) const {
        ASSERT_EQ(editor->run(SUNFLECK_DROP_FILES " " + editor->window() + " " + file).status, 0);
    }
    void open_by_drop();
    void fly_and_place_a_lamp();
    void make_a_group();
    void measure_and_compare();
    void undo_redo_and_save();
    void open_again();
    std::optional<tests::Widget> icon_; // of the lamp, before the end of the first run
};

// The same glTF file, which uses an extension that nothing here knows.
std::string with_unknown_extension(const std::string& glb) {
    constexpr std::size_t header = 12, chunk = 8; // bytes
    std::uint32_t length = 0;
    std::memcpy(&length, glb.data() + header, 4);
    auto json = nlohmann::ordered_json::parse(glb.substr(header + chunk, length));
    json["extensionsUsed"].push_back("EXT_of_a_test");
    std::string text = json.dump(), result = glb.substr(0, header + chunk);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    result += text + glb.substr(header + chunk + length);
    const auto whole = std::uint32_t(result.size()), now = std::uint32_t(text.size());
    std::memcpy(result.data() + 8, &whole, 4);
    std::memcpy(result.data() + header, &now, 4);
    return result;
}

// A large file behind a bar; then the room, and what was left out of it.
void EditorWindowFirst::open_by_drop() {
    const fs::path scenes = fs::path(SUNFLECK_TOOL).parent_path() / "../scenes";
    ASSERT_TRUE(tests::make_scene(tests::Shape::flat, 100000)->save(folder / "large.scene.json"));
    ASSERT_NO_FATAL_FAILURE(drop(editor->file("large.scene.json")));
    EXPECT_TRUE(editor->appears("status/loading"));
    ASSERT_TRUE(editor->wait_for("menu/title", "large.scene.json")) << editor->log();
    EXPECT_FALSE(editor->find("status/loading").has_value());
    const auto room = read_file(scenes / "cornell.glb");
    ASSERT_TRUE(room && write_file(folder / "room.glb", with_unknown_extension(*room)));
    ASSERT_NO_FATAL_FAILURE(drop(editor->file("room.glb")));
    ASSERT_TRUE(editor->wait_for("menu/title", "room.glb")) << editor->log();
    EXPECT_TRUE(editor->wait_until([&] { return message().find("what was left out: Messages") != std::string::npos; }))
        << message();
    ASSERT_TRUE(editor->click("tab Messages"));
    const std::regex number("messages/message [0-9]+");
    EXPECT_TRUE(editor->wait_until([&] {
        for (const tests::Widget& widget : editor->widgets())
            if (std::regex_match(widget.name, number) && widget.value.find("EXT_of_a_test") != std::string::npos)
                return true;
        return false;
    })) << "the report names what was left out";
    ASSERT_TRUE(editor->settles());
}

void EditorWindowFirst::fly_and_place_a_lamp() {
    // Fly.
    const std::string before = editor->value("viewport/picture");
    editor->point_at(*editor->find("viewport/picture"));
    editor->run("xdotool mousedown 3 keydown d sleep 0.2 keyup d mouseup 3");
    EXPECT_TRUE(editor->wait_until([&] { return editor->value("viewport/picture") != before; }));
    ASSERT_TRUE(editor->settles());

    // A lamp: drag it in steps, type how strong it is; the light follows.
    ASSERT_NO_FATAL_FAILURE(menu("Add", "Point light"));
    ASSERT_TRUE(editor->wait_for("inspector/name", "point light"));
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->wait_for("inspector/name", "tall block"));
    ASSERT_TRUE(editor->click("viewport/icon point light"));
    ASSERT_TRUE(editor->wait_for("inspector/name", "point light"));
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->reach("viewport/gizmo y"));
    const double height = std::stod(editor->value("inspector/Transform/position/y"));
    editor->run("xdotool keydown ctrl mousedown 1 mousemove_relative -- 0 -30 sleep 0.1 mousemove_relative -- 0 -30 "
                "sleep 0.1 mouseup 1 keyup ctrl");
    EXPECT_TRUE(editor->wait_until(
        [&] { return std::abs(std::stod(editor->value("inspector/Transform/position/y")) - height) > 0.05; }));
    const double moved = std::stod(editor->value("inspector/Transform/position/y"));
    const double steps = (moved - height) / 0.1;
    EXPECT_NEAR(steps, std::round(steps), 0.05) << "in steps of 10 cm: " << height << " to " << moved;
    ASSERT_TRUE(editor->settles());
    const std::string dim = editor->value("viewport/picture");
    ASSERT_TRUE(editor->enter("inspector/PointLight/intensity/x", "30"));
    EXPECT_TRUE(editor->wait_for("inspector/PointLight/intensity/x", "30"));
    EXPECT_TRUE(editor->wait_until([&] { return editor->value("viewport/picture") != dim; }));
}

// Another one, duplicated, grouped and renamed.
void EditorWindowFirst::make_a_group() {
    ASSERT_NO_FATAL_FAILURE(menu("Add", "Rectangle light"));
    ASSERT_TRUE(editor->wait_for("inspector/name", "rectangle light"));
    editor->key("ctrl+d");
    ASSERT_TRUE(editor->wait_for("inspector/name", "rectangle light 2"));
    editor->key("ctrl+g");
    ASSERT_TRUE(editor->appears("inspector/name"));
    ASSERT_TRUE(editor->enter("inspector/name", "ceiling lights"));
    EXPECT_TRUE(editor->appears("hierarchy/ceiling lights"));
}

void EditorWindowFirst::measure_and_compare() {
    // More light samples, and what they cost.
    ASSERT_TRUE(editor->click("tab Lighting"));
    ASSERT_NO_FATAL_FAILURE(search("lighting/search", "lights"));
    const std::string before = editor->value("lighting/lights/value");
    ASSERT_TRUE(editor->enter("lighting/lights/value", "600"));
    ASSERT_TRUE(editor->wait_for("lighting/lights/value", "600"));
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("lighting/lights/Measure"));
    EXPECT_TRUE(editor->wait_until(
        [&] { return editor->value("lighting/lights/cost").find(" ms") != std::string::npos; }, 120.0))
        << editor->value("lighting/lights/cost");
    EXPECT_NE(editor->value("lighting/lights/cost").find("over " + before), std::string::npos)
        << editor->value("lighting/lights/cost");

    // Held against the path tracer, as a split and as an error map.
    ASSERT_TRUE(editor->click("tab Compare"));
    ASSERT_TRUE(editor->click("compare/Reference"));
    ASSERT_TRUE(editor->click("compare/Split"));
    EXPECT_TRUE(editor->appears("viewport/split"));
    ASSERT_TRUE(editor->click("compare/Error"));
    EXPECT_TRUE(DrivenEditor::wait_until([&] { return editor->find("compare/relative MSE").has_value(); }, 60.0));
    ASSERT_TRUE(editor->click("compare/Nothing"));

    // Two presets and what differs.
    ASSERT_TRUE(editor->write("compare/preset", "many"));
    ASSERT_TRUE(editor->click("compare/Save"));
    ASSERT_TRUE(editor->appears("compare/many/Keep"));
    ASSERT_TRUE(editor->click("compare/many/Keep"));
    ASSERT_TRUE(editor->enter("lighting/lights/value", "400"));
    EXPECT_TRUE(editor->wait_for("compare/difference lights", "Lights: 400 here, 600 kept"));
    ASSERT_TRUE(editor->write("compare/preset", "fewer"));
    ASSERT_TRUE(editor->click("compare/Save"));
    ASSERT_TRUE(editor->appears("compare/fewer/Keep"));
    ASSERT_TRUE(editor->click("compare/fewer/Keep"));
    EXPECT_TRUE(editor->wait_until([&] { return !editor->find("compare/difference lights").has_value(); }));
    ASSERT_TRUE(editor->click("compare/many/Apply"));
    EXPECT_TRUE(editor->wait_for("compare/difference lights", "Lights: 600 here, 400 kept"));
    EXPECT_TRUE(editor->wait_for("lighting/lights/value", "600"));
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("compare/Kept settings"));
    EXPECT_TRUE(DrivenEditor::wait_until([&] { return editor->find("compare/relative MSE").has_value(); }, 60.0));
    ASSERT_TRUE(editor->click("compare/Nothing"));
}

void EditorWindowFirst::undo_redo_and_save() {
    // All undone, all done again, saved.
    const std::string all =
        " ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z";
    editor->run("xdotool key --delay 40" + all);
    ASSERT_TRUE(editor->catch_up());
    EXPECT_TRUE(editor->wait_for("menu/title", "room.glb")) << "nothing is unsaved";
    EXPECT_FALSE(editor->find("hierarchy/ceiling lights").has_value());
    editor->run("xdotool key --delay 40" + std::regex_replace(all, std::regex("ctrl.z"), "ctrl+shift+z"));
    ASSERT_TRUE(editor->catch_up());
    EXPECT_TRUE(editor->appears("hierarchy/ceiling lights"));
    editor->key("ctrl+s");
    ASSERT_TRUE(editor->wait_for("dialog/name", "room 2.scene.json"));
    editor->key("Return"); // what is proposed
    ASSERT_TRUE(editor->wait_for("menu/title", "room 2.scene.json")) << editor->value("status/message");
    ASSERT_TRUE(editor->settles());
    icon_ = editor->find("viewport/icon point light");
    ASSERT_TRUE(icon_.has_value());
    editor->key("ctrl+q");
    EXPECT_EQ(editor->wait_for_end(), 0);
}

// The tab in front, recent files, the scene, and the camera: the lamp is seen where it was.
void EditorWindowFirst::open_again() {
    editor->start({editor->file("room 2.scene.json")});
    EXPECT_TRUE(editor->appears("hierarchy/ceiling lights"));
    EXPECT_TRUE(editor->wait_for("tab Compare", "open"));
    EXPECT_TRUE(editor->wait_for("tab Lighting", "open"));
    EXPECT_TRUE(editor->settles());
    const std::optional<tests::Widget> icon = editor->find("viewport/icon point light");
    ASSERT_TRUE(icon && icon_);
    EXPECT_NEAR(icon->x, icon_->x, 1.0);
    EXPECT_NEAR(icon->y, icon_->y, 1.0);
    const auto settings = nlohmann::json::parse(read_file(folder / "settings.json").value());
    EXPECT_NE(settings.dump().find("room 2.scene.json"), std::string::npos);
    const auto report = editor->end();
    EXPECT_EQ(report["validation_messages"], 0);
}

TEST_F(EditorWindowFirst, TenMinutes) {
    if (!fs::exists(SUNFLECK_DROP_FILES))
        GTEST_SKIP() << "Xlib is not installed";
    editor->start({});
    ASSERT_NO_FATAL_FAILURE(open_by_drop());
    ASSERT_NO_FATAL_FAILURE(fly_and_place_a_lamp());
    ASSERT_NO_FATAL_FAILURE(make_a_group());
    ASSERT_NO_FATAL_FAILURE(measure_and_compare());
    ASSERT_NO_FATAL_FAILURE(undo_redo_and_save());
    ASSERT_NO_FATAL_FAILURE(open_again());
}

} // namespace
} // namespace sunfleck
