// What is wrong is said, once, and changes nothing: files that are none, drops, texts, places that cannot be written
// to, a window of no size, no display.
#include "editor/document/document.h"
#include "tests/editor/window_fixture.h"
#include "tests/support/test_size.h"

#include <fstream>
#include <regex>
#include <sys/stat.h>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::DrivenEditor;

class EditorWindowBadInput : public tests::EditorWindowTest {
protected:
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
        return editor->file(name);
    }
    // Through the dialog, by its whole path.
    void open(const std::string& path) const {
        editor->key("ctrl+o");
        ASSERT_NO_FATAL_FAILURE(name_file(path));
    }
    // Messages that --report lists from the one with this number on.
    static std::vector<std::string> messages(const nlohmann::json& report, std::size_t from) {
        std::vector<std::string> result;
        for (std::size_t i = from; i < report["messages"].size(); ++i)
            result.push_back(report["messages"][i]);
        return result;
    }
    std::vector<std::string> bad_files(const std::string& glb) const {
        EXPECT_EQ(::mkfifo(editor->file("pipe.glb").c_str(), 0600), 0);
        std::vector<std::string> bad = {write("empty.glb", ""),
                                        write("text.gltf", "not a scene"),
                                        write("cut.glb", glb.substr(0, glb.size() / 2)),
                                        write("list.scene.json", "[]"),
                                        editor->file("pipe.glb"),
                                        write("picture.png", "no scene at all")};
        for (std::size_t at = 40; tests::by_size(0, 1) == 1 && at < 400; at += 20) { // bytes of the header, turned over
            std::string damaged = glb;
            damaged[at] = char(~damaged[at]);
            bad.push_back(write("damaged" + std::to_string(at) + ".glb", damaged));
        }
        return bad;
    }
};

constexpr const char* roughness = "inspector/Material/roughness/value";

TEST_F(EditorWindowBadInput, FilesThatAreNoScenesAreSaidAndLeaveTheScene) {
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->enter(roughness, "0.25"));
    ASSERT_TRUE(editor->wait_for("menu/title", "cornell.scene.json *"));
    editor->key("ctrl+s"); // a built-in scene asks for a name
    ASSERT_NO_FATAL_FAILURE(name_file(editor->file("mine.scene.json")));
    ASSERT_TRUE(editor->wait_for("menu/title", "mine.scene.json")) << message();
    const std::string kept = read_file(folder / "mine.scene.json").value();

    const std::vector<std::string> bad = bad_files(read_file(folder / "mine.glb").value());
    fs::create_directories(folder / "folder.glb");
    std::size_t refused = 0;
    for (const std::string& path : bad) {
        const std::string before = message();
        open(path);
        ASSERT_TRUE(editor->wait_until([&] { return message() != before; }, 20.0)) << path << ": nothing is said";
        ASSERT_TRUE(editor->runs()) << path;
        if (message().find("Opened ") == 0) { // damage that does not matter
            open(editor->file("mine.scene.json"));
            ASSERT_TRUE(editor->wait_for("menu/title", "mine.scene.json"));
            continue;
        }
        ++refused;
        EXPECT_NE(message().find(fs::path(path).filename().string()), std::string::npos) << message();
        EXPECT_EQ(editor->value("menu/title"), "mine.scene.json");
        EXPECT_TRUE(editor->find("hierarchy/tall block").has_value());
    }
    EXPECT_GE(refused, 6u);
    // A folder is entered, and what is not there is said in the dialog.
    open(editor->file("folder.glb"));
    ASSERT_TRUE(editor->find("dialog/name").has_value());
    editor->key("Escape");
    open(editor->file("nothing.glb"));
    EXPECT_TRUE(editor->wait_for("dialog/problem", "There is no such file"));
    editor->key("Escape");
    const auto report = editor->end();
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(read_file(folder / "mine.scene.json").value(), kept);
    int said = 0;
    for (const std::string& text : messages(report, 0))
        for (const std::string& path : bad)
            said += text.find(fs::path(path).filename().string()) != std::string::npos ? 1 : 0;
    EXPECT_GE(said, int(refused));
    EXPECT_LE(said, int(bad.size())) << "one message each";
    EXPECT_EQ(report["edits"], 1) << "the history is as it was";
}

// Dropped, as in the dialog: what is a scene is opened, what is none is said once, and the scene that is open stays.
TEST_F(EditorWindowBadInput, TheCorpusAFolderAndAPipeAreDropped) {
    if (!fs::exists(SUNFLECK_DROP_FILES))
        GTEST_SKIP() << "Xlib is not installed";
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles());
    std::vector<std::string> dropped;
    fs::copy(fs::path(SUNFLECK_SOURCE_DIR) / "tests/corpus", folder / "corpus", fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(folder / "corpus"))
        if (entry.is_regular_file())
            dropped.push_back(entry.path().string());
    std::sort(dropped.begin(), dropped.end());
    ASSERT_GE(dropped.size(), 6u);
    fs::create_directories(folder / "a folder.glb");
    ASSERT_EQ(::mkfifo(editor->file("a pipe.glb").c_str(), 0600), 0);
    dropped.insert(dropped.end(), {editor->file("a folder.glb"), editor->file("a pipe.glb"), editor->file("gone.glb")});
    std::size_t opened = 0, refused = 0;
    std::vector<std::string> errors;
    for (const std::string& path : dropped) {
        SCOPED_TRACE(path);
        const std::string name = fs::path(path).filename().string();
        const std::string title = editor->value("menu/title"), before = message();
        ASSERT_EQ(editor->run(SUNFLECK_DROP_FILES " " + editor->window() + " '" + path + "'").status, 0);
        ASSERT_TRUE(editor->wait_until([&] {
            return message() != before && message().find(name) != std::string::npos;
        })) << message();
        ASSERT_TRUE(editor->settles());
        const bool is_scene = bool(editor::Document::open(path));
        ++(is_scene ? opened : refused);
        EXPECT_EQ(message().starts_with("Opened "), is_scene) << message();
        EXPECT_EQ(editor->value("menu/title"), is_scene ? name : title);
        if (!is_scene)
            errors.push_back(message());
    }
    std::printf("%zu opened, %zu refused\n", opened, refused);
    EXPECT_GE(opened, 2u);
    EXPECT_GE(refused, 5u);
    const auto report = editor->end();
    const std::vector<std::string> said = messages(report, 0);
    for (const std::string& text : errors)
        EXPECT_EQ(std::count(said.begin(), said.end(), text), 1) << text;
    EXPECT_EQ(report["validation_messages"], 0);
}

TEST_F(EditorWindowBadInput, FiftyFilesAtOnceOpenTheFirst) {
    if (!fs::exists(SUNFLECK_DROP_FILES))
        GTEST_SKIP() << "Xlib is not installed";
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles());
    std::string files;
    for (int i = 0; i < 50; ++i) {
        const std::string name = "a" + std::to_string(i) + ".glb";
        fs::copy_file(fs::path(SUNFLECK_TOOL).parent_path() / "../scenes/furnace.glb", folder / name);
        files += " '" + editor->file(name) + "'";
    }
    const tests::Outcome outcome = editor->run(SUNFLECK_DROP_FILES " " + editor->window() + files);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_TRUE(editor->wait_for("menu/title", "a0.glb"));
    EXPECT_TRUE(editor->settles());
    const auto report = editor->end();
    int warned = 0, opened = 0;
    for (const std::string& text : messages(report, 0)) {
        warned += text.find("50 files were dropped") == 0 ? 1 : 0;
        opened += text.find("Opened a") == 0 ? 1 : 0;
    }
    EXPECT_EQ(warned, 1);
    EXPECT_EQ(opened, 1);
}

TEST_F(EditorWindowBadInput, TextsOfAllKinds) {
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->appears(roughness));
    const std::string before = editor->value(roughness);
    std::vector<std::string> texts{"nan", "1e99", std::string(tests::by_size(100, 10000), '9')};
    if (tests::by_size(0, 1) == 1)
        texts.insert(texts.end(), {"inf", "-0.1", "0.5.5", "one"});
    for (const std::string& bad : texts) {
        const std::string said = message();
        ASSERT_TRUE(editor->enter(roughness, bad));
        EXPECT_TRUE(editor->wait_until([&] { return message() != said; }, 60.0)) << bad.substr(0, 20);
        EXPECT_EQ(editor->value(roughness), before) << bad.substr(0, 20);
    }
    // Names: none, one that is taken, quotes, and ten thousand letters.
    const auto rename = [&](const std::string& name) {
        EXPECT_TRUE(editor->select_text("inspector/name"));
        if (name.empty())
            editor->key("BackSpace");
        else
            editor->type(name);
        editor->key("Return");
    };
    rename("");
    EXPECT_TRUE(editor->wait_for("inspector/name", "tall block")) << "an empty name is none";
    rename("short block");
    EXPECT_TRUE(editor->wait_until([&] {
        const std::string now = editor->value("inspector/name");
        return now != "short block" && now.find("short block") == 0;
    })) << editor->value("inspector/name");
    rename("a \"quoted\" \\name");
    EXPECT_TRUE(editor->wait_for("inspector/name", "a \"quoted\" \\name"));
    rename(std::string(tests::by_size(150, 10000), 'x'));
    EXPECT_TRUE(editor->wait_until([&] { return editor->value("inspector/name").find("xxxx") == 0; }, 60.0));
    editor->run("xdotool key --delay 40 ctrl+z ctrl+z ctrl+z");
    EXPECT_TRUE(editor->wait_for("inspector/name", "tall block"));
    EXPECT_EQ(editor->end()["edits"], 0);
}

TEST_F(EditorWindowBadInput, PlacesThatCannotBeWrittenTo) {
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->enter(roughness, "0.25"));
    ASSERT_TRUE(editor->wait_for("menu/title", "cornell.scene.json *"));
    for (const char* place : {"/proc/mine.scene.json", "/nowhere/at/all/mine.scene.json"}) {
        editor->key("ctrl+shift+s");
        ASSERT_NO_FATAL_FAILURE(name_file(place));
        EXPECT_TRUE(editor->appears("dialog/problem")) << place;
        editor->key("Escape");
        EXPECT_EQ(editor->value("menu/title"), "cornell.scene.json *") << "it is unsaved still";
    }
    // A file that vanishes while it is open is said to be gone, and is written again.
    editor->key("ctrl+shift+s");
    ASSERT_NO_FATAL_FAILURE(name_file(editor->file("mine.scene.json")));
    ASSERT_TRUE(editor->wait_for("menu/title", "mine.scene.json"));
    fs::remove(folder / "mine.scene.json");
    editor->key("ctrl+r");
    EXPECT_TRUE(editor->wait_until([&] { return message().find("mine.scene.json") != std::string::npos; }));
    ASSERT_TRUE(editor->enter(roughness, "0.5"));
    editor->key("ctrl+s");
    EXPECT_TRUE(editor->wait_until([&] { return fs::exists(folder / "mine.scene.json"); })) << message();
    EXPECT_FALSE(editor->end().is_null());
}

TEST_F(EditorWindowBadInput, AWindowOfNoSizeAndADeletionInTheMiddleOfADrag) {
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->appears("viewport/gizmo y"));
    editor->point_at(*editor->find("viewport/gizmo y"));
    editor->run("xdotool mousedown 1 mousemove_relative -- 0 -20 sleep 0.1 key Delete sleep 0.1 "
                "mousemove_relative -- 0 -20 sleep 0.1 mouseup 1");
    EXPECT_TRUE(editor->wait_until([&] {
        return !editor->find("hierarchy/tall block").has_value() ||
               editor->value("menu/title") == "cornell.scene.json *";
    }));
    editor->run("xdotool key --delay 60 Escape ctrl+z ctrl+z ctrl+z");
    EXPECT_TRUE(editor->appears("hierarchy/tall block"));
    EXPECT_TRUE(editor->wait_for("menu/title", "cornell.scene.json")) << "all is undone";
    editor->resize(1, 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    ASSERT_TRUE(editor->minimise());
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    editor->run("xdotool windowmap " + editor->window());
    editor->resize(900, 600);
    EXPECT_TRUE(editor->settles());
    EXPECT_TRUE(editor->wait_until([&] {
        const auto picture = editor->find("viewport/picture");
        return picture && picture->width > 100;
    }));
    EXPECT_EQ(editor->end()["validation_messages"], 0);
}

TEST(EditorBadInput, WithoutADisplayItSaysSo) {
    const tests::Outcome outcome =
        tests::shell("env -u DISPLAY -u WAYLAND_DISPLAY timeout 30 " SUNFLECK_EDITOR " cornell");
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    EXPECT_NE(outcome.output.find("DISPLAY"), std::string::npos) << outcome.output;
    EXPECT_EQ(outcome.output.find("--headless"), std::string::npos) << "which it has not: " << outcome.output;
}

// Before a window opens, not when an evening's layout is to be kept.
TEST(EditorBadInput, FilesThatItCannotWriteAreSaidAtOnce) {
    for (const char* option : {"--settings", "--widgets", "--report"}) {
        const tests::Outcome outcome =
            tests::shell("env -u DISPLAY -u WAYLAND_DISPLAY timeout 30 " SUNFLECK_EDITOR " " + std::string(option) +
                         " /nowhere/file.json");
        EXPECT_EQ(outcome.status, 1);
        EXPECT_NE(outcome.output.find("/nowhere/file.json"), std::string::npos) << option << ": " << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    }
}

} // namespace
} // namespace sunfleck
