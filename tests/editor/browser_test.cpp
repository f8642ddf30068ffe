// The Browser panel: shadow maps and the visibility of a patch, as the lighting lists them.
#include "tests/editor/window_fixture.h"

namespace sunfleck {
namespace {

class EditorWindowBrowser : public tests::EditorWindowTest {
protected:
    double number(const std::string& name) const { return std::atof(editor->value("browser/" + name).c_str()); }
};

TEST_F(EditorWindowBrowser, MapsAreSortedPinnedAndRedrawn) {
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("tab Browser"));
    ASSERT_TRUE(editor->appears("browser/row 0/sample"));
    EXPECT_LT(number("row 0/sample"), number("row 1/sample"));
    ASSERT_TRUE(editor->click("browser/by sample"));
    EXPECT_TRUE(editor->wait_until([&] { return number("row 0/sample") > number("row 1/sample"); })) << "falling";

    EXPECT_EQ(editor->value("browser/row 0/Pin"), "off");
    ASSERT_TRUE(editor->click("browser/row 0/Pin"));
    EXPECT_TRUE(editor->wait_for("browser/row 0/Pin", "on"));
    EXPECT_TRUE(editor->wait_until([&] {
        return editor->value("browser/summary").find("1 pinned") != std::string::npos;
    })) << editor->value("browser/summary");
    ASSERT_TRUE(editor->settles());
    const std::string picture = editor->value("viewport/picture");
    ASSERT_TRUE(editor->click("browser/row 0/Redraw"));
    EXPECT_TRUE(editor->wait_until([&] { return editor->value("viewport/picture") != picture; }));

    // While nothing happens, nothing is drawn, table or not.
    ASSERT_TRUE(editor->settles());
    const std::string rest = editor->value("viewport/picture");
    std::this_thread::sleep_for(std::chrono::seconds(1));
    EXPECT_EQ(editor->value("viewport/picture"), rest);
    EXPECT_EQ(editor->end()["validation_messages"], 0);
}

TEST_F(EditorWindowBrowser, APatchsSamplesComeWithTheirBlockers) {
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles());
    ASSERT_TRUE(editor->click("tab Browser"));
    ASSERT_TRUE(editor->click("browser/Visibility"));
    EXPECT_TRUE(editor->wait_for("browser/summary", "Choose a place in the picture"));
    ASSERT_TRUE(editor->click("browser/Choose a place"));
    ASSERT_TRUE(editor->click("viewport/picture"));
    ASSERT_TRUE(editor->wait_until([&] {
        return editor->value("browser/summary").find(" free, ") != std::string::npos;
    })) << editor->value("browser/summary");
    ASSERT_TRUE(editor->click("tab Inspector")) << "room for nothing else";
    ASSERT_TRUE(editor->appears("browser/row 0/state"));
    // A row singles out its sample; its lamp's name selects.
    ASSERT_TRUE(editor->click("browser/row 0/lamp"));
    EXPECT_TRUE(editor->wait_for("inspector/name", editor->value("browser/row 0/lamp")))
        << editor->value("inspector/name");
    EXPECT_EQ(editor->end()["validation_messages"], 0);
}

} // namespace
} // namespace sunfleck
