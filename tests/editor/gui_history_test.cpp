// Seeded random edits through the window, some while the scene plays or its light is made: all of them undone give the
// bytes of the first save, all of them done again those of the last.
#include "tests/editor/window_fixture.h"
#include "tests/support/test_size.h"

#include <random>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::DrivenEditor;

class RandomArtist {
public:
    RandomArtist(DrivenEditor& editor, std::uint32_t seed) : editor_(editor), random_(seed) {}

    void edit() {
        switch (random_() % 9) {
        case 0:
            return menu("Add", "Add/");
        case 1:
            select();
            return editor_.key("ctrl+d");
        case 2:
            select();
            return editor_.key("ctrl+g");
        case 3:
            select();
            return editor_.key(random_() % 3 == 0 ? "Delete" : "ctrl+d");
        case 4:
            return editor_.key(random_() % 2 == 0 ? "ctrl+z" : "ctrl+shift+z");
        case 5:
            return editor_.key("ctrl+space"); // plays, or ends it
        case 6:
            select();
            static_cast<void>(editor_.drag("viewport/gizmo y", 0, int(random_() % 80) - 40));
            return;
        default:
            return number();
        }
    }

private:
    // One of the widgets whose name begins so.
    std::string some(const std::string& begin, const std::string& end = "") {
        std::vector<std::string> names;
        for (const tests::Widget& widget : editor_.widgets())
            if (widget.name.starts_with(begin) && widget.name.ends_with(end) && widget.width > 4 && widget.height > 4)
                names.push_back(widget.name);
        return names.empty() ? std::string() : names[random_() % names.size()];
    }
    void select() {
        std::string name = some("hierarchy/");
        for (int tries = 0; tries < 5 && (name.find("/open ") != std::string::npos ||
                                          name.find("/eye ") != std::string::npos || name.ends_with("/search"));
             ++tries)
            name = some("hierarchy/");
        if (!name.empty())
            static_cast<void>(editor_.click(name));
    }
    void menu(const std::string& group, const std::string& begin) {
        if (!editor_.click("menu/" + group))
            return;
        std::this_thread::sleep_for(std::chrono::milliseconds(150));
        const std::string entry = some("menu/" + begin);
        static_cast<void>(entry.empty() ? false : editor_.click(entry));
        editor_.key("Escape");
    }
    void number() {
        if (random_() % 3 == 0)
            select();
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        const std::string box = some("inspector/", random_() % 2 == 0 ? "/x" : "/value");
        static const char* const values[] = {"0.5", "1", "0.25", "2", "0", "nan", "1e9", "-0.5"};
        if (!box.empty() && !box.ends_with("name"))
            static_cast<void>(editor_.enter(box, values[random_() % std::size(values)]));
    }
    DrivenEditor& editor_;
    std::mt19937 random_;
};

using EditorWindowHistory = tests::EditorWindowTest;

TEST_F(EditorWindowHistory, UndoAndRedoThroughTheWindow) {
    const char* const seed_text = std::getenv("SUNFLECK_SEED");
    const std::uint32_t seed = seed_text != nullptr ? std::uint32_t(std::atoi(seed_text)) : 1u;
    SCOPED_TRACE("seed " + std::to_string(seed));
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles()) << editor->log();
    // Each into a folder of its own, under the same name.
    const auto saved = [&](const std::string& name) {
        fs::create_directories(folder / name);
        editor->key("ctrl+shift+s");
        name_file(editor->file(name + "/room.scene.json"));
        EXPECT_TRUE(DrivenEditor::wait_until([&] { return fs::exists(folder / name / "room.scene.json"); }))
            << editor->value("status/message");
        EXPECT_TRUE(editor->wait_for("menu/title", "room.scene.json"));
        std::string bytes;
        for (const char* file : {"room.scene.json", "room.glb"})
            if (const auto text = read_file(folder / name / file))
                bytes += *text;
        return bytes;
    };
    const std::string first = saved("first");
    RandomArtist artist(*editor, seed);
    const int edits = tests::by_size(6, 300);
    for (int i = 0; i < edits && editor->runs(); ++i)
        artist.edit();
    ASSERT_TRUE(editor->runs()) << editor->log();
    editor->key("Escape");
    // What was undone among the edits is done again first, so that the end is known.
    const auto many = [&](const std::string& key) {
        std::string command = "xdotool key --delay 25";
        for (int i = 0; i < edits + 5; ++i)
            command += " " + key;
        editor->run(command);
    };
    many("ctrl+shift+z");
    const std::string last = saved("last");
    many("ctrl+z");
    EXPECT_EQ(saved("undone"), first);
    many("ctrl+shift+z");
    EXPECT_EQ(saved("redone"), last);
    const auto report = editor->end();
    ASSERT_TRUE(report.is_object());
    EXPECT_GT(report["edits"], edits / 4) << "most of them were edits";
    EXPECT_NE(first, last);
}

} // namespace
} // namespace sunfleck
