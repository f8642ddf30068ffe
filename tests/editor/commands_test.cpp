// Commands and their keys: which run, how they are given others, and what is kept of that.
#include "tests/editor/panel_fixture.h"

#include "editor/window/state_file.h"

namespace sunfleck::editor {
namespace {

class EditorCommands : public PanelTest {
protected:
    std::string keys_of(std::string_view command) {
        const Command* const found = session_.commands->find(command);
        return found != nullptr ? shortcut_text(found->shortcut) : "no such command";
    }
    // Shows the list of commands with this one alone, and asks for its keys.
    void ask_for_keys(const std::string& command) {
        session_.front = "Commands";
        frames(3);
        ASSERT_NO_FATAL_FAILURE(click("commands/search"));
        key("Ctrl+A");
        type(command);
        const std::string keys = keys_of(command);
        ASSERT_NO_FATAL_FAILURE(click("commands/" + command + "/" + (keys.empty() ? "none" : keys)));
        ASSERT_EQ(waits_for(command), true);
    }
    bool waits_for(const std::string& command) const { return find("commands/" + command + "/press keys") != nullptr; }
};

TEST_F(EditorCommands, KeysThatAreAskedForRunNothing) {
    const Entity box = add("Box");
    ASSERT_NO_FATAL_FAILURE(ask_for_keys("View/Flip"));
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+D"));
    EXPECT_EQ(document().entity_count(), 1u) << "nothing is duplicated";
    EXPECT_EQ(keys_of("View/Flip"), "Ctrl+D");
    EXPECT_EQ(keys_of("Edit/Duplicate"), "") << "keys are one command's";
    EXPECT_EQ(newest_message(), "Ctrl+D is now 'View: Flip'; 'Edit: Duplicate', which had it, has no keys");
    EXPECT_FALSE(waits_for("View/Flip"));

    ASSERT_NO_FATAL_FAILURE(ask_for_keys("Edit/Duplicate"));
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    EXPECT_TRUE(document().selected(box)) << "Escape leaves the selection, too";
    EXPECT_EQ(keys_of("Edit/Duplicate"), "");
    EXPECT_EQ(keys_of("Edit/Select none"), "Escape");

    // And then they run commands again.
    ASSERT_NO_FATAL_FAILURE(ask_for_keys("Edit/Duplicate"));
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+Shift+F3"));
    EXPECT_EQ(document().entity_count(), 1u);
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+Shift+F3"));
    EXPECT_EQ(document().entity_count(), 2u);
}

TEST_F(EditorCommands, UsualKeysComeBack) {
    ASSERT_NO_FATAL_FAILURE(ask_for_keys("View/Flip"));
    EXPECT_EQ(find("commands/View/Flip/Usual"), nullptr);
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+D"));
    frames(2);
    ASSERT_NO_FATAL_FAILURE(click("commands/View/Flip/Usual"));
    EXPECT_EQ(keys_of("View/Flip"), "T");
    frames(2);
    EXPECT_EQ(find("commands/View/Flip/Usual"), nullptr);
    EXPECT_EQ(keys_of("Edit/Duplicate"), "") << "which is a change of its own";
    ASSERT_NO_FATAL_FAILURE(click("commands/Usual keys"));
    EXPECT_EQ(keys_of("Edit/Duplicate"), "Ctrl+D");
    EXPECT_TRUE(session_.commands->changed_keys().empty());
    frames(2);
    EXPECT_EQ(value("commands/Usual keys"), "disabled");
}

TEST_F(EditorCommands, WhoeverTurnsAwayIsAskedForKeysNoLonger) {
    add("Box");
    ASSERT_NO_FATAL_FAILURE(ask_for_keys("View/Flip"));
    ASSERT_NO_FATAL_FAILURE(click("viewport/Rotate"));
    EXPECT_FALSE(waits_for("View/Flip"));
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+D"));
    EXPECT_EQ(document().entity_count(), 2u);

    ASSERT_NO_FATAL_FAILURE(ask_for_keys("View/Flip"));
    session_.front = "Messages";
    frames(3);
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+D"));
    EXPECT_EQ(document().entity_count(), 3u);
    session_.front = "Commands";
    frames(3);
    EXPECT_FALSE(waits_for("View/Flip"));
    EXPECT_EQ(keys_of("View/Flip"), "T");
}

TEST_F(EditorCommands, KeysOfOtherThingsAreNoShortcuts) {
    add("Box");
    session_.front = "Commands";
    frames(3);
    ASSERT_NO_FATAL_FAILURE(click("commands/search"));
    ASSERT_NO_FATAL_FAILURE(key("Delete"));
    EXPECT_EQ(document().entity_count(), 1u) << "a text is being typed";
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    frames(2);
    session_.dialog = Dialog::open;
    frames(3);
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+D"));
    EXPECT_EQ(document().entity_count(), 1u) << "a question is open";
    session_.dialog = Dialog::none;
    frames(3);
    ASSERT_NO_FATAL_FAILURE(key("Delete"));
    EXPECT_EQ(document().entity_count(), 0u);
}

TEST(EditorShortcut, ItsTextIsReadAsItWasWritten) {
    for (app::Key key = app::no_key; key < app::first_mouse_button; ++key)
        for (int held = 0; held < 8; ++held) {
            const bool none = key == app::no_key;
            const Shortcut shortcut{key, !none && (held & 1) != 0, !none && (held & 2) != 0, !none && (held & 4) != 0};
            EXPECT_EQ(shortcut_from_text(shortcut_text(shortcut)), shortcut) << shortcut_text(shortcut);
        }
    EXPECT_EQ(shortcut_text({'Z', true, true, true}), "Ctrl+Shift+Alt+Z");
    for (const char* bad : {"Ctrl+", "Hyper+Z", "Ctrl+nothing", "none"})
        EXPECT_EQ(shortcut_from_text(bad).key, app::no_key) << bad;
}

// Keys that are swapped, passed on and taken away, in a file between two runs.
TEST(EditorShortcut, ChangedKeysAreKeptFromRunToRun) {
    const tests::Folder folder{"editor_keys"};
    Commands before;
    EXPECT_TRUE(before.changed_keys().empty());
    const auto give = [&](const char* command, const Shortcut& keys) { before.bind(*before.find(command), keys); };
    const Shortcut copies = before.find("Edit/Duplicate")->shortcut, saves = before.find("File/Save")->shortcut,
                   grid{'Y', true, false, true};
    give("Edit/Duplicate", saves);
    give("File/Save", copies);
    give("View/Grid", before.find("Edit/Undo")->shortcut);
    give("Edit/Undo", before.find("File/Quit")->shortcut);
    give("Show/Lock", grid);
    give("View/Grid", grid);
    EXPECT_EQ(before.find("File/Save")->shortcut, copies);
    EXPECT_EQ(before.find("Show/Lock")->shortcut, Shortcut());
    EXPECT_EQ(before.find("File/Quit")->shortcut, Shortcut());

    EditorState state;
    state.keys = before.changed_keys();
    EXPECT_EQ(state.keys.size(), 6u);
    ASSERT_TRUE(save_state(folder / "settings.json", state));
    std::string problem;
    bool may_save = false;
    Commands after;
    after.change_keys(load_state(folder / "settings.json", problem, may_save).keys);
    EXPECT_EQ(problem, "");
    ASSERT_EQ(after.all().size(), before.all().size());
    for (std::size_t i = 0; i < before.all().size(); ++i)
        EXPECT_EQ(after.all()[i].shortcut, before.all()[i].shortcut) << before.all()[i].path();
    EXPECT_EQ(after.changed_keys(), state.keys);
}

// While a hand drags: what it did so far leaves no entry, and the command works on what was there before.
TEST_F(EditorCommands, ACommandInTheMiddleOfADragTakesTheDragBack) {
    const Entity box = add("Box");
    document().select({box});
    const vec3 before = document().registry().get<scene::Transform>(box).position;
    const std::size_t entries = document().history().position();
    document().begin("Move");
    auto moved = std::make_shared<scene::Transform>(document().registry().get<scene::Transform>(box));
    moved->position.x += 3.0f;
    document().set(box, pool_of<scene::Transform>(document()), std::move(moved));
    ASSERT_NO_FATAL_FAILURE(run("Edit/Delete"));
    EXPECT_FALSE(document().exists(box));
    EXPECT_EQ(document().history().position(), entries + 1);
    EXPECT_EQ(newest_message(), "What was being dragged is where it was");
    ASSERT_TRUE(document().undo());
    EXPECT_EQ(document().registry().get<scene::Transform>(box).position, before);
}

TEST_F(EditorCommands, SoloEndsWithWhatWasHiddenBefore) {
    const Entity box = add("Box"), point = add("Point light"), spot = add("Spot light"), sun = add("Sun");
    const std::unordered_set<Entity> before{box, sun};
    session_.hidden = before;
    document().select({point});
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    EXPECT_EQ(session_.hidden, (std::unordered_set<Entity>{box, spot, sun}));
    document().select({sun}); // from one to the other, also one that was hidden
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    EXPECT_EQ(session_.hidden, (std::unordered_set<Entity>{box, point, spot}));
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    EXPECT_EQ(session_.hidden, before);

    document().select({spot});
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    document().select({});
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps")); // as before, without a selection, too
    EXPECT_EQ(session_.hidden, before);
    EXPECT_FALSE(session_.commands->find("Show/Solo lamps")->is_enabled(session_));

    // Whoever shows everything meanwhile begins anew.
    document().select({spot});
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    ASSERT_NO_FATAL_FAILURE(run("Show/Show all"));
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    EXPECT_EQ(session_.hidden, (std::unordered_set<Entity>{point, sun}));
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    EXPECT_TRUE(session_.hidden.empty());
}

TEST_F(EditorCommands, TheMenuSaysHowLargeTheGridsSquaresAre) {
    for (const auto& [scale, title] : {std::pair(0.3f, "Grid, 0.05 m"), {4.0f, "Grid, 0.5 m"}, {30.0f, "Grid, 5 m"}}) {
        session_.take(std::make_shared<Document>());
        for (const scene::EntityTemplate& source : scene::entity_templates())
            if (source.name == "Box")
                add_from(document(), source, vec3(0.0f), scale);
        EXPECT_EQ(session_.commands->find("View/Grid")->title(session_), title) << session_.scene_size();
    }
}

} // namespace
} // namespace sunfleck::editor
