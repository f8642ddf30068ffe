// What all tests of the editor's window begin and end with: a folder of the test's own, an editor that can be started
// in a display of its own, and its log where something failed.
#pragma once

#include "tests/editor/driven_editor.h"

#include <gtest/gtest.h>

namespace sunfleck::tests {

class EditorWindowTest : public testing::Test {
protected:
    // The size of the window, as of --size.
    explicit EditorWindowTest(std::string size = "1280x800") : size_(std::move(size)) {}

    void SetUp() override {
        if (!DrivenEditor::possible())
            GTEST_SKIP() << "Xvfb, xdotool and openbox are not installed";
        folder = std::filesystem::path(testing::TempDir()) / ("sunfleck_editor_" + std::to_string(getpid()));
        std::filesystem::remove_all(folder);
        editor = std::make_unique<DrivenEditor>(folder, size_);
    }
    void TearDown() override {
        if (HasFailure() && editor != nullptr)
            std::printf("%s\n", editor->log().c_str());
        editor.reset();
        std::filesystem::remove_all(folder);
    }

    // Lets the menu fall and chooses.
    void menu(const std::string& group, const std::string& entry) const {
        ASSERT_TRUE(editor->click("menu/" + group));
        ASSERT_TRUE(editor->click("menu/" + group + "/" + entry)) << group << ": " << entry;
    }
    // Types a path into the file dialog that is open, or is about to open.
    void name_file(const std::string& path) const {
        ASSERT_TRUE(editor->catch_up()); // and no other dialog is meant
        ASSERT_TRUE(editor->write("dialog/name", path));
        editor->key("Return");
        ASSERT_TRUE(editor->catch_up()); // a frame for each key
    }
    // Types into a list's search box, until the list follows.
    void search(const std::string& box, const std::string& text) const {
        ASSERT_TRUE(editor->write(box, text));
        ASSERT_TRUE(editor->wait_for(box, text));
    }
    // The bytes of the scene as it is saved: under the same name each time, into a folder of its own.
    std::string saved(const std::string& name) const {
        std::filesystem::create_directories(folder / name);
        const std::string scene = editor->file(name + "/room.scene.json");
        menu("File", "Save as...");
        name_file(scene);
        EXPECT_TRUE(editor->wait_for("status/message", "Saved " + scene)) << message();
        EXPECT_TRUE(editor->wait_for("menu/title", "room.scene.json"));
        std::string bytes;
        for (const char* file : {"room.scene.json", "room.glb"})
            if (const auto text = read_file(folder / name / file))
                bytes += *text;
            else
                ADD_FAILURE() << text.error().message;
        return bytes;
    }
    std::string message() const { return editor->value("status/message"); }

    std::filesystem::path folder;
    std::unique_ptr<DrivenEditor> editor;

private:
    std::string size_;
};

} // namespace sunfleck::tests
