// An artist's first ten minutes, by X events alone: a dropped file is lit, measured, compared, saved, and all is back
// in the next run.
#include "tests/editor/window_fixture.h"

#include <cmath>
#include <regex>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::DrivenEditor;

class EditorWindowFirst : public tests::EditorWindowTest {
protected:
    EditorWindowFirst() : EditorWindowTest("1440x900") {}
    void fly_and_place_a_lamp();
    void make_a_group();
    void measure_and_compare();
    void undo_redo_and_save();
    void open_again();
};

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
    ASSERT_TRUE(editor->click("inspector/name"));
    editor->key("ctrl+a");
    editor->type("ceiling lights");
    editor->key("Return");
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
    ASSERT_TRUE(editor->click("compare/preset"));
    editor->type("many");
    ASSERT_TRUE(editor->click("compare/Save"));
    ASSERT_TRUE(editor->appears("compare/many/Keep"));
    ASSERT_TRUE(editor->click("compare/many/Keep"));
    ASSERT_TRUE(editor->enter("lighting/lights/value", "400"));
    EXPECT_TRUE(editor->appears("compare/difference lights"));
}

void EditorWindowFirst::undo_redo_and_save() {
    // All undone, all done again, saved.
    const std::string all = " ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z ctrl+z";
    editor->run("xdotool key --delay 40" + all);
    EXPECT_TRUE(editor->wait_for("menu/title", "room.glb")) << "nothing is unsaved";
    EXPECT_FALSE(editor->find("hierarchy/ceiling lights").has_value());
    editor->run("xdotool key --delay 40" + std::regex_replace(all, std::regex("ctrl.z"), "ctrl+shift+z"));
    EXPECT_TRUE(editor->appears("hierarchy/ceiling lights"));
    editor->key("ctrl+shift+s");
    ASSERT_NO_FATAL_FAILURE(name_file(editor->file("mine.scene.json")));
    ASSERT_TRUE(editor->wait_for("menu/title", "mine.scene.json")) << editor->value("status/message");
    editor->key("ctrl+q");
    EXPECT_EQ(editor->wait_for_end(), 0);
}

// The tab in front, recent files, the scene.
void EditorWindowFirst::open_again() {
    editor->start({editor->file("mine.scene.json")});
    EXPECT_TRUE(editor->appears("hierarchy/ceiling lights"));
    EXPECT_TRUE(editor->wait_for("tab Compare", "open"));
    EXPECT_TRUE(editor->wait_for("tab Lighting", "open"));
    EXPECT_TRUE(editor->settles());
    const auto settings = nlohmann::json::parse(read_file(folder / "settings.json").value());
    EXPECT_NE(settings.dump().find("mine.scene.json"), std::string::npos);
    const auto report = editor->end();
    EXPECT_EQ(report["validation_messages"], 0);
}

TEST_F(EditorWindowFirst, TenMinutes) {
    if (!fs::exists(SUNFLECK_DROP_FILES))
        GTEST_SKIP() << "Xlib is not installed";
    editor->start({});
    fs::copy_file(fs::path(SUNFLECK_TOOL).parent_path() / "../scenes/cornell.glb", folder / "room.glb");
    ASSERT_EQ(editor->run(SUNFLECK_DROP_FILES " " + editor->window() + " " + editor->file("room.glb")).status, 0);
    ASSERT_TRUE(editor->wait_for("menu/title", "room.glb")) << editor->log();
    ASSERT_TRUE(editor->settles());
    ASSERT_NO_FATAL_FAILURE(fly_and_place_a_lamp());
    ASSERT_NO_FATAL_FAILURE(make_a_group());
    ASSERT_NO_FATAL_FAILURE(measure_and_compare());
    ASSERT_NO_FATAL_FAILURE(undo_redo_and_save());
    ASSERT_NO_FATAL_FAILURE(open_again());
}

} // namespace
} // namespace sunfleck
