// Saves behind the user's back: the file has what there was when the key was pressed, and the document is unsaved until
// it is written.
#include "editor/window/saving.h"
#include "tests/editor/panel_fixture.h"

#include <thread>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

class EditorSaving : public PanelTest {
protected:
    EditorSaving() {
        box_ = add("Box");
        EXPECT_TRUE(session_.save(room_));
    }
    void take_news_until_saved() {
        for (int tries = 0; tries < 3000 && session_.saving != nullptr; ++tries) {
            session_.take_news();
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        EXPECT_EQ(session_.saving, nullptr);
    }
    bool file_has(const char* name) {
        const auto saved = Document::open(room_);
        EXPECT_TRUE(saved) << saved.error().message;
        return saved && !(*saved)->find(name).is_null();
    }
    std::size_t saved_messages() const {
        std::size_t count = 0;
        for (const Message& message : session_.messages.all())
            count += message.text.starts_with("Saved ") ? 1 : 0;
        return count;
    }

    const fs::path room_ = folder_ / "room.scene.json";
    Entity box_;
};

TEST_F(EditorSaving, EditsGoOnMeanwhile) {
    add("Ball");
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    ASSERT_NE(session_.saving, nullptr);
    EXPECT_TRUE(document().unsaved()) << "it is not written yet, as far as anybody was told";
    frames(2);
    EXPECT_EQ(value("status/saving"), "Saving room.scene.json ...");
    add("Cylinder");
    take_news_until_saved();
    EXPECT_EQ(saved_messages(), 2u);
    EXPECT_TRUE(file_has("ball"));
    EXPECT_FALSE(file_has("cylinder")) << "that came after the key";
    EXPECT_TRUE(document().unsaved());
    EXPECT_FALSE(document().file_changed()) << "it was written here";
    document().undo();
    EXPECT_FALSE(document().unsaved()) << "as it was saved";
    frames(2);
    EXPECT_EQ(find("status/saving"), nullptr);
}

TEST_F(EditorSaving, TheKeyOnceMoreSavesWhatCameInBetween) {
    add("Ball");
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    add("Cylinder");
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    take_news_until_saved();
    EXPECT_EQ(saved_messages(), 3u);
    EXPECT_TRUE(file_has("cylinder"));
    EXPECT_FALSE(document().unsaved());
    // Nothing came in between: once is enough.
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    take_news_until_saved();
    EXPECT_EQ(saved_messages(), 4u);
}

// Whoever wants something else waits for it, and is not asked about edits that are being saved.
TEST_F(EditorSaving, WhatComesNextWaitsForIt) {
    add("Ball");
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    ASSERT_NO_FATAL_FAILURE(run("File/New"));
    EXPECT_EQ(session_.dialog, Dialog::none);
    EXPECT_EQ(session_.saving, nullptr);
    EXPECT_EQ(document().entity_count(), 0u);
    EXPECT_TRUE(file_has("ball"));

    auto opened = Document::open(room_);
    ASSERT_TRUE(opened);
    session_.take(std::move(*opened));
    add("Cylinder");
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    EXPECT_FALSE(session_.still_unsaved());
    EXPECT_TRUE(file_has("cylinder"));
}

// Also for the save that the key, pressed twice, has asked for.
TEST_F(EditorSaving, WhatComesNextWaitsForBoth) {
    add("Ball");
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    add("Cylinder");
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    EXPECT_FALSE(session_.still_unsaved());
    EXPECT_EQ(session_.saving, nullptr);
    EXPECT_TRUE(file_has("cylinder"));
}

TEST_F(EditorSaving, AFailureIsSaidAndTheEditsStayUnsaved) {
    add("Ball");
    fs::rename(folder_.path, folder_.path.string() + ".away");
    ASSERT_TRUE(write_file(folder_.path, "no folder"));
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    take_news_until_saved();
    EXPECT_EQ(session_.messages.all().back().kind, Message::Kind::error) << newest_message();
    EXPECT_TRUE(document().unsaved());
    fs::remove(folder_.path);
    fs::rename(folder_.path.string() + ".away", folder_.path);
    EXPECT_FALSE(file_has("ball"));
    ASSERT_NO_FATAL_FAILURE(run("File/Save"));
    take_news_until_saved();
    EXPECT_TRUE(file_has("ball"));
    EXPECT_FALSE(document().unsaved());
}

} // namespace
} // namespace sunfleck::editor
