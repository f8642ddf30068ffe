// The editor's window, driven by X events.
#include "tests/editor/window_fixture.h"

#include "engine/scene/components.h"
#include "gi_module/technique.h"
#include "tests/support/test_size.h"

#include <cmath>
#include <fstream>
#include <regex>
#include <set>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

using EditorWindow = tests::EditorWindowTest;

// Small and quick: a room of some boxes, with few samples and small maps.
constexpr const char* small_scene = "cornell";

TEST_F(EditorWindow, EditsUndoesSavesAndOpensAgain) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles()) << editor->log();
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->appears("inspector/Material/roughness/value"));
    const std::string before = editor->value("inspector/Material/roughness/value");
    ASSERT_TRUE(editor->enter("inspector/Material/roughness/value", "0.25"));
    EXPECT_TRUE(editor->wait_for("inspector/Material/roughness/value", "0.25"));
    EXPECT_EQ(editor->value("menu/title"), "cornell.scene.json *");
    editor->key("ctrl+z");
    EXPECT_TRUE(editor->wait_for("inspector/Material/roughness/value", before));
    EXPECT_TRUE(editor->wait_for("menu/title", "cornell.scene.json"));
    editor->key("ctrl+shift+z");
    EXPECT_TRUE(editor->wait_for("inspector/Material/roughness/value", "0.25"));

    // What is out of range or no number is said, and changes nothing.
    for (const char* bad : {"7", "nan", "abc"}) {
        ASSERT_TRUE(editor->enter("inspector/Material/roughness/value", bad));
        EXPECT_TRUE(editor->wait_until([&] {
            return editor->value("status/message").find("'" + std::string(bad) + "'") != std::string::npos;
        })) << editor->value("status/message");
        EXPECT_EQ(editor->value("inspector/Material/roughness/value"), "0.25");
    }

    const std::string place = editor->value("inspector/Transform/position/x");
    ASSERT_TRUE(editor->enter("inspector/Transform/position/x", "none"));
    EXPECT_TRUE(editor->wait_until([&] {
        return editor->value("status/message").find("'none' is not a value of 'position'") != std::string::npos;
    })) << editor->value("status/message");
    ASSERT_TRUE(editor->enter("inspector/Transform/rotation/y", "none"));
    EXPECT_TRUE(editor->wait_until([&] {
        return editor->value("status/message").find("'none' is not an angle") != std::string::npos;
    })) << editor->value("status/message");
    EXPECT_EQ(editor->value("inspector/Transform/position/x"), place);

    menu("File", "Save as...");
    ASSERT_NO_FATAL_FAILURE(name_file(editor->file("mine.scene.json")));
    ASSERT_TRUE(editor->wait_for("menu/title", "mine.scene.json")) << editor->value("status/message");
    EXPECT_TRUE(fs::exists(folder / "mine.scene.json"));

    // Closing with edits asks first.
    ASSERT_TRUE(editor->enter("inspector/Material/roughness/value", "0.5"));
    ASSERT_TRUE(editor->wait_for("menu/title", "mine.scene.json *"));
    editor->key("ctrl+q");
    ASSERT_TRUE(editor->click("dialog/Save"));
    EXPECT_EQ(editor->wait_for_end(), 0);
    EXPECT_TRUE(fs::exists(folder / "mine.scene.json"));

    editor->start({editor->file("mine.scene.json")});
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    EXPECT_TRUE(editor->wait_for("inspector/Material/roughness/value", "0.5"));
    EXPECT_FALSE(editor->end().is_null());
}

TEST_F(EditorWindow, AClickInThePictureSelectsAndAHandleMoves) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("viewport/picture"));
    ASSERT_TRUE(editor->wait_until([&] { return editor->find("inspector/name").has_value(); }));
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->wait_for("inspector/name", "tall block"));
    for (const char* tool : {"viewport/Rotate", "viewport/Move"}) { // and not what is behind the button
        ASSERT_TRUE(editor->click(tool));
        ASSERT_TRUE(editor->catch_up());
        EXPECT_EQ(editor->value("inspector/name"), "tall block");
    }
    ASSERT_TRUE(editor->appears("viewport/gizmo y"));
    const double height = std::stod(editor->value("inspector/Transform/position/y"));
    ASSERT_TRUE(editor->drag("viewport/gizmo y", 0, -60));
    EXPECT_TRUE(
        editor->wait_until([&] { return std::stod(editor->value("inspector/Transform/position/y")) > height + 0.05; }));
    // Events come in order: what can be undone has ended.
    editor->key("ctrl+z");
    EXPECT_TRUE(editor->wait_until(
        [&] { return std::abs(std::stod(editor->value("inspector/Transform/position/y")) - height) < 1e-3; }));
    editor->key("ctrl+shift+z");
    EXPECT_TRUE(
        editor->wait_until([&] { return std::stod(editor->value("inspector/Transform/position/y")) > height + 0.05; }));
    const auto report = editor->end();
    EXPECT_EQ(report["edits"], 1) << "a drag is one entry of the history";
    EXPECT_EQ(report["validation_messages"], 0);
}

// Unsaved edits survive a crash: the next run offers them, and touches no file.
TEST_F(EditorWindow, ACrashLosesNoEdit) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->enter("inspector/Material/roughness/value", "0.25"));
    ASSERT_TRUE(editor->wait_for("inspector/Material/roughness/value", "0.25"));
    const auto kept = [&] {
        for (const auto& entry : fs::recursive_directory_iterator(folder / "recovery"))
            if (entry.path().filename() == "about.json")
                return true;
        return false;
    };
    ASSERT_TRUE(editor->wait_until(kept));
    editor->crash();
    editor->start({});
    ASSERT_TRUE(editor->click("dialog/Recover"));
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    EXPECT_TRUE(editor->wait_for("inspector/Material/roughness/value", "0.25"));
    EXPECT_EQ(editor->value("menu/title"), "untitled *");
    editor->key("ctrl+q");
    ASSERT_TRUE(editor->click("dialog/Discard"));
    EXPECT_EQ(editor->wait_for_end(), 0);
    EXPECT_TRUE(fs::is_empty(folder / "recovery")) << "a run that ends as it should leaves nothing";
}

// A click with the tool, and one with Alt: what is there, and lights whose shares make up the picture's light.
TEST_F(EditorWindow, APixelSaysWhatLightsIt) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("viewport/Inspect"));
    ASSERT_TRUE(editor->click("viewport/picture"));
    ASSERT_TRUE(editor->appears("pixel/light 1"));
    const double shown = std::stod(editor->value("pixel/in the picture"));
    const double sum = std::stod(editor->value("pixel/sum of shares"));
    EXPECT_GT(shown, 0.0);
    EXPECT_NEAR(sum, shown, 0.1 * shown) << "of one pixel; EditorInspection measures many";
    EXPECT_TRUE(editor->find("hierarchy/" + editor->value("pixel/surface")).has_value());
    EXPECT_TRUE(editor->find("inspector/name") == std::nullopt) << "the tool selects nothing";

    // Without its lamp the place is dark, which the panel follows by itself.
    const std::string before = editor->value("pixel/sum of shares");
    ASSERT_TRUE(editor->click("hierarchy/lamp"));
    editor->key("Delete");
    EXPECT_TRUE(editor->wait_until([&] { return editor->value("pixel/sum of shares") != before; }));
    const auto report = editor->end();
    EXPECT_EQ(report["validation_messages"], 0);
}

// Nothing is drawn while nothing happens, and pointers over panels draw no scene.
TEST_F(EditorWindow, RestsWhileNothingHappens) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles());
    editor->point_at(30, 300);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const auto processor = [&] { return editor->processor_seconds(); };
    const auto now = [] {
        return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    };
    const std::string picture = editor->value("viewport/picture");
    const double began = processor(), rest = now();
    const int seconds = tests::by_size(5, 60);
    std::this_thread::sleep_for(std::chrono::seconds(seconds));
    const double pointing = now();
    EXPECT_LE(processor() - began, 0.005 * seconds + 0.011)
        << "one tick of the clock more than half a percent of a core";
    for (int x = 20; x < 200; x += 5)
        editor->point_at(x, 200 + x);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const double end = now();
    EXPECT_EQ(editor->value("viewport/picture"), picture) << "the pointer over panels draws no scene";
    const auto report = editor->end();
    ASSERT_TRUE(report.is_object());
    const auto frames = [&](const char* kind, double from, double until) {
        return std::count_if(report[kind].begin(), report[kind].end(),
                             [&](double at) { return at >= from && at <= until; });
    };
    EXPECT_LE(frames("gui_frames_at", rest, pointing), 2);
    EXPECT_GT(frames("gui_frames_at", pointing, end), 5) << "they are counted";
    EXPECT_EQ(frames("scene_frames_at", rest, end), 0);
    EXPECT_GT(frames("scene_frames_at", 0.0, rest), 0);
}

// `<` and `>` go through all frames that are kept, which the table tells; at both ends there is no further.
TEST_F(EditorWindow, TheProfileStepsThroughFrames) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("tab Profile"));
    ASSERT_TRUE(editor->reach("viewport/picture"));
    const std::size_t least = tests::by_size(12u, 300u);
    std::vector<std::string> kept;
    for (int tries = 0; tries < 30 && kept.size() < least; ++tries) {
        ASSERT_TRUE(editor->reach("viewport/picture"));
        editor->run("xdotool mousedown 3"); // the camera turns
        for (int step = 0; step < 20; ++step)
            editor->run("xdotool mousemove_relative -- " + std::string(step % 2 == 0 ? "3" : "-3") + " 0 sleep 0.05");
        editor->run("xdotool mouseup 3");
        ASSERT_TRUE(editor->settles());
        fs::remove(folder / "sunfleck_frames.csv");
        ASSERT_TRUE(editor->click("profile/Save CSV"));
        ASSERT_TRUE(editor->wait_until([&] { return fs::exists(folder / "sunfleck_frames.csv"); }));
        kept.clear();
        std::istringstream table(read_file(folder / "sunfleck_frames.csv").value());
        std::string line;
        std::getline(table, line); // the columns' names
        while (std::getline(table, line))
            if (const std::string frame = line.substr(0, line.find(',')); kept.empty() || kept.back() != frame)
                kept.push_back(frame);
    }
    ASSERT_GE(kept.size(), least);
    EXPECT_LE(kept.size(), 300u);
    EXPECT_TRUE(editor->wait_for("profile/frame", kept.back()));
    EXPECT_EQ(editor->value("profile/>"), "disabled") << "the newest is shown";
    ASSERT_TRUE(editor->click("profile/<"));
    EXPECT_TRUE(editor->wait_for("profile/frame", kept[kept.size() - 2]));
    ASSERT_TRUE(editor->click("profile/<", "1", int(kept.size()) - 3));
    EXPECT_TRUE(editor->wait_for("profile/frame", kept[1]));
    EXPECT_EQ(editor->value("profile/<"), "");
    ASSERT_TRUE(editor->click("profile/<"));
    EXPECT_TRUE(editor->wait_for("profile/frame", kept[0]));
    EXPECT_EQ(editor->value("profile/<"), "disabled");
    ASSERT_TRUE(editor->click("profile/>", "1", 2));
    EXPECT_TRUE(editor->wait_for("profile/frame", kept[2]));
    ASSERT_TRUE(editor->click("profile/Newest"));
    EXPECT_TRUE(editor->wait_for("profile/frame", kept.back()));
    editor->end();
}

// While the GUI rests, time passes all the same: two clicks with a pause between them are no double click, and a key
// that is held repeats.
TEST_F(EditorWindow, TimePassesWhileItRests) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->wait_for("inspector/name", "tall block"));
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    editor->run("xdotool click 1");
    ASSERT_TRUE(editor->catch_up());
    EXPECT_FALSE(editor->find("hierarchy/rename").has_value());
    editor->run("xdotool click --repeat 2 --delay 60 1");
    EXPECT_TRUE(editor->appears("hierarchy/rename")) << "and this is one";
    editor->key("End");
    editor->run("xdotool keydown BackSpace sleep 1.5 keyup BackSpace");
    EXPECT_TRUE(editor->wait_for("hierarchy/rename", ""));
    editor->key("Escape");
    editor->end();
}

// What a program types, or a reader of bar codes, comes faster than frames are drawn.
TEST_F(EditorWindow, ManyLettersAreTakenInAFrame) {
    constexpr int letters = 2000;
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles());
    const std::string text = "A" + std::string(letters - 2, 'x');
    ASSERT_TRUE(editor->write("hierarchy/search", text + "Z"));
    editor->key("BackSpace");
    EXPECT_TRUE(editor->wait_for("hierarchy/search", text)) << "in the order in which they came";
    EXPECT_LT(editor->end()["gui_frames"], letters);
}

// Which tab is in front, and where the camera stands: a run that is killed has kept them, too.
TEST_F(EditorWindow, WhatIsKeptNeedsNoRegularEnd) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("tab Compare"));
    const auto kept = [&] {
        const auto text = read_file(folder / "settings.json");
        return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    };
    EXPECT_TRUE(editor->wait_until([&] {
        const nlohmann::json now = kept();
        return now.is_object() && now["layout"].dump().find("\"Compare\"") != std::string::npos;
    }));
    const std::string before = kept()["cameras"].dump();
    ASSERT_TRUE(editor->reach("viewport/picture"));
    editor->run("xdotool click 4 click 4");
    EXPECT_TRUE(editor->wait_until([&] { return kept()["cameras"].dump() != before; }));
    editor->crash();
    editor->start({small_scene});
    EXPECT_TRUE(editor->wait_for("tab Compare", "open"));
    editor->end();
}

// Of all that techniques register, and of all components.
std::set<std::string> registered_names() {
    std::set<std::string> names;
    ecs::Registry registry;
    scene::register_components(registry);
    for (const ecs::PoolBase* pool : registry.described_pools())
        names.insert("scene::" + std::string(pool->description()->name));
    const auto quoted = [&](std::string_view name) { names.insert("\"" + std::string(name) + "\""); };
    for (const gi::TechniqueEntry& technique : gi::techniques())
        quoted(technique.name);
    for (const std::string_view name : gi::Settings::names())
        quoted(name);
    for (const gi::DebugView* view : gi::debug_views())
        quoted(view->name);
    for (const gi::Counter* counter : gi::all_counters())
        quoted(counter->name);
    for (const gi::Overlay* overlay : gi::all_overlays())
        quoted(overlay->name);
    for (const gi::Listing* listing : gi::all_listings())
        quoted(listing->name);
    return names;
}

// Somewhere in the text, and not as the beginning of a longer name.
bool names_whole(const std::string& text, const std::string& name) {
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
        const std::size_t end = at + name.size();
        if (end == text.size() || (std::isalnum(static_cast<unsigned char>(text[end])) == 0 && text[end] != '_'))
            return true;
    }
    return false;
}

// Panels know none of them, and nothing else of the editor knows what a technique registers: what they show comes from
// descriptions and registries. Components that make scenes what they are (names, places, geometry, what moves) are
// known to the document and to the copy that is drawn.
TEST(EditorSources, PanelsNameNoComponentTechniqueOrSetting) {
    const std::set<std::string> names = registered_names();
    int files = 0;
    for (const char* folder : {"panels", "window", "document"})
        for (const auto& entry : fs::directory_iterator(fs::path(SUNFLECK_SOURCE_DIR) / "editor" / folder)) {
            const std::string text = read_file(entry.path()).value();
            ++files;
            for (const std::string& name : names)
                if (name[0] == '"' || folder == std::string_view("panels")) {
                    EXPECT_FALSE(names_whole(text, name))
                        << folder << "/" << entry.path().filename() << " names " << name;
                }
        }
    EXPECT_GT(files, 80);
    // The search is not blind: a longer name before the whole one hides nothing.
    EXPECT_TRUE(names_whole("scene::NameOfOne scene::Name{}", "scene::Name"));
    EXPECT_FALSE(names_whole("scene::NameOfOne scene::Name_", "scene::Name"));
}

TEST_F(EditorWindow, PanelsGetTheirUsualSizesBack) {
    editor->start({small_scene});
    ASSERT_TRUE(editor->settles()) << editor->log();
    const auto size = [&] {
        const auto picture = editor->find("viewport/picture");
        return picture ? std::pair(picture->width, picture->height) : std::pair(0.0, 0.0);
    };
    const auto usual = size();
    // A slow window may see the pointer only where it has left the border.
    const auto drags = [&](const char* border, int x, int y) {
        return editor->wait_until([&] {
            const auto before = size();
            return editor->drag(border, x, y) && editor->catch_up() && size() != before;
        });
    };
    ASSERT_TRUE(drags("border left", 60, 0));
    ASSERT_TRUE(drags("border right", -60, 0));
    ASSERT_TRUE(drags("border bottom", 0, -60));
    EXPECT_LT(size().first, usual.first);
    EXPECT_LT(size().second, usual.second);
    menu("View", "Usual panel sizes");
    EXPECT_TRUE(editor->wait_until([&] { return size() == usual; }));
}

// At twice the size they take two lines.
TEST_F(EditorWindow, SwitchesOverThePictureLieWithinIt) {
    editor->start({small_scene, "--scale", "2"});
    ASSERT_TRUE(editor->appears("viewport/Play"));
    const tests::Widget picture = editor->find("viewport/picture").value();
    for (const char* name : {"Select", "Move", "Rotate", "Scale", "Inspect", "World", "Snap off", "Play"}) {
        const auto found = editor->find(std::string("viewport/") + name);
        ASSERT_TRUE(found) << name;
        EXPECT_GE(found->x, picture.x) << name;
        EXPECT_LE(found->x + found->width, picture.x + picture.width) << name;
    }
}

} // namespace
} // namespace sunfleck
