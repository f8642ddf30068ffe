// Files that are opened and saved: what somebody has made is not lost without a question.
#include "tests/editor/panel_fixture.h"

#include "engine/core/file.h"

namespace sunfleck::editor {
namespace {

class EditorSession : public PanelTest {
protected:
    std::filesystem::path save_room(const std::string& name) {
        Document room;
        for (const scene::EntityTemplate& source : scene::entity_templates())
            add_from(room, source, vec3(1.0f), 1.0f);
        EXPECT_TRUE(room.save(folder_ / name));
        return folder_ / name;
    }
    // Frames until the file has been loaded; whether it has taken the document's place.
    bool finish_loading() {
        const int before = taken_;
        for (int tries = 0; tries < 3000 && session_.opening != nullptr && !session_.opening->finished(); ++tries)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        try_to_finish();
        return taken_ > before;
    }
    void try_to_finish() {
        session_.finish_opening([this](const Loaded& loaded) {
            ++taken_;
            session_.take(loaded.document);
        });
        frame();
    }
    int taken_ = 0;
};

TEST_F(EditorSession, WhatLoadsTakesThePlaceOfWhatNobodyHasEdited) {
    const auto room = save_room("room.scene.json");
    session_.open(room);
    EXPECT_TRUE(finish_loading());
    EXPECT_EQ(document().path(), room);
    EXPECT_EQ(session_.opening, nullptr);
    session_.open(folder_ / "nothing.scene.json");
    EXPECT_FALSE(finish_loading());
    EXPECT_EQ(document().path(), room) << "what cannot be opened leaves the scene";
    EXPECT_NE(newest_message().find("nothing.scene.json"), std::string::npos) << newest_message();
}

TEST_F(EditorSession, EditsMadeWhileAFileLoadsAreAskedAbout) {
    const auto room = save_room("room.scene.json");
    session_.open(room);
    const Entity box = add("Box");
    EXPECT_FALSE(finish_loading());
    EXPECT_EQ(session_.dialog, Dialog::unsaved);
    ASSERT_NO_FATAL_FAILURE(click("dialog/Cancel"));
    EXPECT_EQ(session_.dialog, Dialog::none);
    EXPECT_TRUE(document().exists(box)) << "the edit stays, and the file is not opened";
    EXPECT_TRUE(document().path().empty());

    // Asked before, when there was something to lose: whoever gave that up is not asked again.
    session_.open(room);
    EXPECT_EQ(session_.opening, nullptr);
    ASSERT_NO_FATAL_FAILURE(click("dialog/Discard"));
    ASSERT_NE(session_.opening, nullptr);
    EXPECT_TRUE(finish_loading());
    EXPECT_EQ(document().path(), room);

    // But for what was made since.
    add("Box");
    session_.open(room);
    ASSERT_NO_FATAL_FAILURE(click("dialog/Discard"));
    const Entity ball = add("Ball");
    EXPECT_FALSE(finish_loading());
    EXPECT_TRUE(document().exists(ball));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Discard"));
    EXPECT_FALSE(document().exists(ball));
    EXPECT_EQ(taken_, 2);
}

TEST_F(EditorSession, WhatHasLoadedWaitsForTheHandAndForOtherQuestions) {
    const auto room = save_room("room.scene.json");
    session_.open(room);
    document().begin("Drag");
    EXPECT_FALSE(finish_loading()) << "a drag is not cut off";
    EXPECT_EQ(session_.dialog, Dialog::none);
    document().commit();
    const Entity box = add("Box");
    session_.dialog = Dialog::save_as;
    try_to_finish();
    EXPECT_EQ(session_.dialog, Dialog::save_as) << "and neither is a name that is being typed";
    session_.dialog = Dialog::none;
    frame();
    try_to_finish();
    EXPECT_EQ(session_.dialog, Dialog::unsaved);
    EXPECT_TRUE(document().exists(box));
    EXPECT_EQ(taken_, 0);
}

TEST_F(EditorSession, ANewSceneIsNotReplacedByWhatStillLoads) {
    session_.open(save_room("room.scene.json"));
    ASSERT_NO_FATAL_FAILURE(run("File/New"));
    EXPECT_FALSE(finish_loading());
    EXPECT_EQ(document().entity_count(), 0u);
}

// By typing its name: the first press says what it would replace, and the second one does.
TEST_F(EditorSession, SaveAsReplacesAnotherSceneWhenAskedTwice) {
    const auto mine = folder_ / "mine.scene.json", room = save_room("room.scene.json");
    const std::string theirs = read_file(room).value(), geometry = read_file(folder_ / "room.glb").value();
    add("Box");
    EXPECT_FALSE(document().save(room)) << "without a question it is not replaced at all";
    ASSERT_TRUE(session_.save(mine));
    const auto name = [&](const std::string& path) {
        ASSERT_NO_FATAL_FAILURE(click("dialog/name"));
        key("Ctrl+A");
        type(path);
    };
    add("Ball");
    ASSERT_NO_FATAL_FAILURE(run("File/Save as..."));
    ASSERT_NO_FATAL_FAILURE(name(room.string()));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    EXPECT_NE(value("dialog/problem").find("'room.scene.json' exists"), std::string::npos) << value("dialog/problem");
    EXPECT_EQ(read_file(room).value(), theirs);

    // Another name in between, or the dialog closed: that is not the second time.
    ASSERT_NO_FATAL_FAILURE(name((folder_ / "mine.txt").string()));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    ASSERT_NO_FATAL_FAILURE(name(room.string()));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    ASSERT_NO_FATAL_FAILURE(run("File/Save as..."));
    ASSERT_NO_FATAL_FAILURE(name(room.string()));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    EXPECT_EQ(read_file(room).value(), theirs);
    EXPECT_EQ(read_file(folder_ / "room.glb").value(), geometry);
    EXPECT_EQ(document().path(), mine);

    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    EXPECT_EQ(session_.dialog, Dialog::none) << value("dialog/problem");
    EXPECT_EQ(document().path(), room);
    EXPECT_NE(read_file(room).value(), theirs);

    // Its own file is replaced at once, however its name is written.
    add("Ball");
    EXPECT_TRUE(session_.save(folder_ / "../" / folder_.path.filename() / "room.scene.json"));
    EXPECT_FALSE(document().unsaved());
}

TEST_F(EditorSession, RecentFilesAreListedOnce) {
    const std::string a = (folder_ / "a.scene.json").string(), b = (folder_ / "b.scene.json").string();
    add("Box");
    ASSERT_TRUE(session_.save(a));
    ASSERT_TRUE(session_.save(b));
    ASSERT_TRUE(session_.save(a, Replace::any));
    EXPECT_EQ(session_.recent_files, (std::vector<std::string>{a, b}));
    session_.open(b);
    EXPECT_TRUE(finish_loading());
    EXPECT_EQ(session_.recent_files, (std::vector<std::string>{b, a}));
}

} // namespace
} // namespace sunfleck::editor
