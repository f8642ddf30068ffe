// Seeded random edits through the window, some while the scene plays or its light is made: all of them undone give the
// bytes of the first save, all of them done again those of the last.
#include "tests/editor/window_fixture.h"
#include "tests/support/test_size.h"

#include <random>

namespace sunfleck {
namespace {

using tests::DrivenEditor;

// Each edit's choices are of its own, so that a choice that was not there leaves the others as they are.
class RandomArtist {
public:
    RandomArtist(DrivenEditor& editor, std::uint32_t seed) : editor_(editor), seed_(seed) {}

    void edit() {
        std::seed_seq sequence{seed_, count_++};
        random_.seed(sequence);
        switch (random_() % 9) {
        case 0:
            return menu("Add");
        case 1:
            return select_and_press("ctrl+d");
        case 2:
            return select_and_press("ctrl+g");
        case 3:
            return select_and_press(random_() % 3 == 0 ? "Delete" : "ctrl+d");
        case 4:
            return press(random_() % 2 == 0 ? "ctrl+z" : "ctrl+shift+z");
        case 5:
            return press("ctrl+space"); // plays, or ends it
        case 6:
            return move();
        default:
            return number();
        }
    }

private:
    void note(const std::string& what) const { std::printf("edit %u: %s\n", count_, what.c_str()); }
    void press(const std::string& keys) {
        note(keys);
        editor_.key(keys);
    }
    void select_and_press(const std::string& keys) {
        select();
        press(keys);
    }
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
        if (name.empty())
            return;
        note("select " + name);
        static_cast<void>(editor_.click(name));
    }
    void menu(const std::string& group) {
        if (!editor_.click("menu/" + group))
            return;
        std::string entry;
        const bool fell = DrivenEditor::wait_until(
            [&] {
                entry = some("menu/" + group + "/");
                return !entry.empty();
            },
            5.0);
        if (!fell) // the click has closed the list of a field, say
            return press("Escape");
        note("choose " + entry);
        EXPECT_TRUE(editor_.click(entry));
        EXPECT_TRUE(DrivenEditor::wait_until([&] { return some("menu/" + group + "/").empty(); }))
            << "the menu stays open after " << entry;
    }
    void move() {
        select();
        const int way = int(random_() % 80) - 40;
        if (!editor_.find("viewport/gizmo y"))
            return;
        note("move by " + std::to_string(way));
        static_cast<void>(editor_.drag("viewport/gizmo y", 0, way));
    }
    void number() {
        if (random_() % 3 == 0)
            select();
        if (!editor_.catch_up())
            return;
        const std::string box = some("inspector/", random_() % 2 == 0 ? "/x" : "/value");
        static const char* const values[] = {"0.5", "1", "0.25", "2", "0", "nan", "1e9", "-0.5"};
        const char* const value = values[random_() % std::size(values)];
        if (box.empty() || box.ends_with("name"))
            return;
        note(box + " = " + value);
        static_cast<void>(editor_.enter(box, value));
    }
    DrivenEditor& editor_;
    std::uint32_t seed_, count_ = 0;
    std::mt19937 random_;
};

using EditorWindowHistory = tests::EditorWindowTest;

TEST_F(EditorWindowHistory, UndoAndRedoThroughTheWindow) {
    const char* const seed_text = std::getenv("SUNFLECK_SEED");
    const std::uint32_t seed = seed_text != nullptr ? std::uint32_t(std::atoi(seed_text)) : 1u;
    SCOPED_TRACE("seed " + std::to_string(seed));
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles()) << editor->log();
    const std::string first = saved("first");
    RandomArtist artist(*editor, seed);
    const char* const edits_text = std::getenv("SUNFLECK_EDITS"); // a long run in pieces of so many, each with its seed
    const int edits = edits_text != nullptr ? std::atoi(edits_text) : tests::by_size(6, 300);
    for (int i = 0; i < edits && editor->runs(); ++i)
        artist.edit();
    ASSERT_TRUE(editor->runs()) << editor->log();
    editor->key("Escape");
    // What was undone among the edits is done again first, so that the end is known.
    const auto many = [&](const std::string& held) {
        std::string command = "xdotool keydown ctrl " + held + "key --delay 25";
        for (int i = 0; i < edits + 5; ++i)
            command += " z";
        editor->run(command + " keyup shift keyup ctrl");
        EXPECT_TRUE(editor->catch_up());
    };
    many("keydown shift ");
    const std::string last = saved("last");
    many("");
    EXPECT_EQ(saved("undone"), first);
    many("keydown shift ");
    EXPECT_EQ(saved("redone"), last);
    const auto report = editor->end();
    ASSERT_TRUE(report.is_object());
    EXPECT_GT(report["edits"], edits / 4) << "most of them were edits";
    EXPECT_NE(first, last);
}

} // namespace
} // namespace sunfleck
