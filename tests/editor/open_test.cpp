// What comes later appears by itself: a technique that only the tests know is in the editor's panels and menus, its
// setting can be undone and is saved.
#include "tests/editor/window_fixture.h"

namespace sunfleck {
namespace {

class EditorOpen : public tests::EditorWindowTest {
protected:
    void SetUp() override {
        EditorWindowTest::SetUp();
        if (!IsSkipped())
            editor->start({"cornell"}, SUNFLECK_OPEN_EDITOR);
    }
};

TEST_F(EditorOpen, AnAddedTechniqueAppearsIsUndoneAndSaved) {
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("tab Lighting"));
    ASSERT_NO_FATAL_FAILURE(search("lighting/search", "constant"));
    const std::string setting = "lighting/constant_irradiance/value";
    ASSERT_TRUE(editor->wait_for(setting, "0.25"));
    ASSERT_TRUE(editor->enter(setting, "2"));
    ASSERT_TRUE(editor->wait_for(setting, "2"));
    editor->key("ctrl+z");
    EXPECT_TRUE(editor->wait_for(setting, "0.25"));
    editor->key("ctrl+shift+z");
    EXPECT_TRUE(editor->wait_for(setting, "2"));

    // It lights what is reflected from now on; then its view shows.
    ASSERT_NO_FATAL_FAILURE(search("lighting/search", "plan"));
    ASSERT_TRUE(editor->enter("lighting/plan/value", "indirect.diffuse=constant_light"));
    ASSERT_TRUE(editor->wait_for("lighting/plan/value", "indirect.diffuse=constant_light"));
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("tab Views"));
    ASSERT_TRUE(editor->click("views/Final", "5", 10)) << "the wheel: to the end of the list";
    ASSERT_TRUE(editor->click("views/Constant light surfaces"));
    ASSERT_TRUE(editor->wait_for("views/Constant light surfaces", "chosen"));
    ASSERT_TRUE(editor->settles());
    EXPECT_FALSE(editor->find("viewport/error").has_value()) << editor->value("viewport/error");

    const std::string before = editor->value("viewport/picture");
    ASSERT_TRUE(editor->click("menu/Overlays"));
    ASSERT_TRUE(editor->click("menu/Overlays/Constant light cube"));
    EXPECT_TRUE(editor->wait_until([&] { return editor->value("viewport/picture") != before; })) << "it is drawn";
    ASSERT_TRUE(editor->click("tab Counters"));
    ASSERT_TRUE(editor->click("counters/light_samples", "5", 40)) << "the wheel: to the end of the list";
    EXPECT_TRUE(editor->wait_until([&] {
        const std::string pixels = editor->value("counters/constant_light_pixels");
        return !pixels.empty() && pixels[0] >= '1' && pixels[0] <= '9';
    })) << editor->value("counters/constant_light_pixels");

    // Its table, and what can be done to a row.
    ASSERT_TRUE(editor->click("tab Browser"));
    ASSERT_TRUE(editor->click("browser/Constant light channels"));
    ASSERT_TRUE(editor->wait_for("browser/summary", "3 channels"));
    EXPECT_EQ(editor->value("browser/row 1/channel"), "g");
    ASSERT_TRUE(editor->click("browser/row 1/Mark"));
    EXPECT_TRUE(editor->wait_for("browser/row 1/times asked", "1"));
    ASSERT_TRUE(editor->click("tab Counters"));

    editor->key("ctrl+shift+s");
    ASSERT_NO_FATAL_FAILURE(name_file(editor->file("mine.scene.json")));
    ASSERT_TRUE(editor->wait_for("menu/title", "mine.scene.json")) << editor->value("status/message");
    const auto saved = nlohmann::json::parse(read_file(folder / "mine.scene.json").value());
    EXPECT_EQ(saved["settings"]["constant_irradiance"], "2") << saved["settings"].dump();

    // A budget for a counter, which the status bar watches.
    ASSERT_TRUE(editor->click("counters/constant_light_pixels"));
    ASSERT_TRUE(editor->enter("counters/budget/most", "10"));
    EXPECT_TRUE(editor->wait_until([&] {
        return editor->value("status/budget").find("constant_light_pixels") != std::string::npos;
    })) << editor->value("status/budget");
    EXPECT_EQ(editor->end()["validation_messages"], 0);
}

} // namespace
} // namespace sunfleck
