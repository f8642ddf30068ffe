// What hands do in the window, one thing at a time: who is selected, hidden, locked; components and their values;
// handles of several; gestures that end without an entry.
#include "editor/document/edits.h"
#include "tests/editor/window_fixture.h"

#include <cmath>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

constexpr const char* roughness = "inspector/Material/roughness/value";

class EditorWindowEditing : public tests::EditorWindowTest {
protected:
    void SetUp() override {
        EditorWindowTest::SetUp();
        if (IsSkipped())
            return;
        editor->start({"cornell"});
        ASSERT_TRUE(editor->settles()) << editor->log();
    }
    void click_with(const std::string& held, const std::string& name) const {
        ASSERT_TRUE(editor->reach(name));
        editor->run("xdotool keydown " + held + " sleep 0.1 click 1 sleep 0.1 keyup " + held);
        ASSERT_TRUE(editor->catch_up());
    }
    void select_both_blocks() const {
        ASSERT_TRUE(editor->click("hierarchy/tall block"));
        ASSERT_TRUE(editor->wait_for("inspector/name", "tall block"));
        ASSERT_NO_FATAL_FAILURE(click_with("ctrl", "hierarchy/short block"));
        ASSERT_TRUE(editor->wait_for("inspector/selected", "2 entities selected"));
    }
    bool is(const std::string& name, const std::string& value) const {
        return editor->wait_for("hierarchy/" + name, value);
    }
    bool picture_changes(const std::string& before) const {
        return editor->wait_until([&] { return editor->value("viewport/picture") != before; });
    }
    // Where the two are, in a file and in the scene that is saved now.
    static std::pair<mat4, mat4> both_blocks(const fs::path& file) {
        auto opened = editor::Document::open(file);
        EXPECT_TRUE(opened);
        const auto place = [&](const char* name) {
            return opened ? editor::world_of(**opened, (*opened)->find(name)) : mat4(0.0f);
        };
        return {place("tall block"), place("short block")};
    }
    std::pair<mat4, mat4> both_blocks_saved(const std::string& name) const {
        saved(name);
        return both_blocks(folder / name / "room.scene.json");
    }
};

TEST_F(EditorWindowEditing, ControlAndShiftSelectSeveral) {
    ASSERT_NO_FATAL_FAILURE(select_both_blocks());
    EXPECT_TRUE(is("tall block", "selected") && is("short block", "selected"));
    ASSERT_NO_FATAL_FAILURE(click_with("ctrl", "hierarchy/tall block"));
    EXPECT_TRUE(editor->wait_for("inspector/name", "short block")) << "taken out again";
    EXPECT_TRUE(is("tall block", ""));

    // From the one that was clicked to the one that is, whatever lies between them, in either direction.
    std::vector<std::string> rows;
    for (const tests::Widget& widget : editor->widgets())
        if (widget.name.starts_with("hierarchy/") && widget.name != "hierarchy/search" &&
            !widget.name.starts_with("hierarchy/eye ") && !widget.name.starts_with("hierarchy/open "))
            rows.push_back(widget.name);
    ASSERT_GE(rows.size(), 5u);
    for (const auto& [from, until] :
         {std::pair(std::size_t(1), std::size_t(3)), std::pair(std::size_t(4), std::size_t(2))}) {
        ASSERT_TRUE(editor->click(rows[from]));
        ASSERT_NO_FATAL_FAILURE(click_with("shift", rows[until]));
        EXPECT_TRUE(editor->wait_for("inspector/selected", "3 entities selected"));
        for (std::size_t i = 0; i < 5; ++i)
            EXPECT_EQ(editor->value(rows[i]) == "selected", i >= std::min(from, until) && i <= std::max(from, until))
                << i;
    }
    EXPECT_EQ(editor->value("menu/title"), "cornell.scene.json") << "that is no edit";
    editor->end();
}

TEST_F(EditorWindowEditing, WhatIsHiddenLockedOrSilencedIsNoEdit) {
    std::string before = editor->value("viewport/picture");
    ASSERT_TRUE(editor->click("hierarchy/eye tall block"));
    EXPECT_TRUE(is("eye tall block", "hidden"));
    EXPECT_TRUE(picture_changes(before));
    ASSERT_TRUE(editor->click("hierarchy/eye tall block"));
    EXPECT_TRUE(is("eye tall block", "shown"));

    // The same by key, for all that is selected; and all shown again.
    ASSERT_NO_FATAL_FAILURE(select_both_blocks());
    editor->key("h");
    EXPECT_TRUE(is("eye tall block", "hidden") && is("eye short block", "hidden"));
    editor->key("shift+h");
    EXPECT_TRUE(is("eye tall block", "shown") && is("eye short block", "shown"));

    // Solo of what is no lamp silences all lamps; once more: none.
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    editor->key("l");
    EXPECT_TRUE(is("eye lamp", "hidden"));
    EXPECT_EQ(editor->value("hierarchy/eye tall block"), "shown");
    editor->key("l");
    EXPECT_TRUE(is("eye lamp", "shown"));
    ASSERT_TRUE(editor->click("hierarchy/lamp"));
    editor->key("l");
    ASSERT_TRUE(editor->catch_up());
    EXPECT_EQ(editor->value("hierarchy/eye lamp"), "shown") << "alone is what it is already";

    // Clicks in the picture go through what is locked.
    ASSERT_TRUE(editor->settles());
    editor->key("Escape");
    ASSERT_TRUE(editor->click("viewport/picture"));
    ASSERT_TRUE(editor->appears("inspector/name"));
    const std::string first = editor->value("inspector/name");
    editor->key("ctrl+l");
    editor->key("Escape");
    ASSERT_TRUE(editor->wait_until([&] { return !editor->find("inspector/name").has_value(); }));
    ASSERT_TRUE(editor->click("viewport/picture"));
    ASSERT_TRUE(editor->appears("inspector/name"));
    EXPECT_NE(editor->value("inspector/name"), first);
    EXPECT_EQ(editor->value("menu/title"), "cornell.scene.json");
    EXPECT_EQ(editor->end()["edits"], 0);
}

// Two values: "mixed", and what is typed is both's; a dot sets the usual one.
TEST_F(EditorWindowEditing, SeveralAreEditedAtOnceAndReset) {
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->enter(roughness, "0.25"));
    ASSERT_TRUE(editor->wait_for(roughness, "0.25"));
    ASSERT_NO_FATAL_FAILURE(select_both_blocks());
    EXPECT_TRUE(editor->wait_for(roughness, "mixed"));
    EXPECT_EQ(editor->value("inspector/Transform/position/x"), "mixed");
    ASSERT_TRUE(editor->enter(roughness, "0.5"));
    EXPECT_TRUE(editor->wait_for(roughness, "0.5"));
    editor->key("ctrl+z");
    EXPECT_TRUE(editor->wait_for(roughness, "mixed")) << "one entry for both";
    editor->key("ctrl+shift+z");
    EXPECT_TRUE(editor->wait_for(roughness, "0.5"));
    ASSERT_TRUE(editor->click("inspector/Material/roughness/reset"));
    EXPECT_TRUE(editor->wait_until([&] { return !editor->find("inspector/Material/roughness/reset").has_value(); }));
    const std::string usual = editor->value(roughness);
    EXPECT_NE(usual, "0.5");
    EXPECT_NE(usual, "mixed");
    editor->key("ctrl+z");
    EXPECT_TRUE(editor->wait_for(roughness, "0.5"));
    EXPECT_EQ(editor->end()["edits"], 2);
}

TEST_F(EditorWindowEditing, ComponentsAreCopiedPastedRemovedAndAdded) {
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->enter(roughness, "0.25"));
    ASSERT_TRUE(editor->wait_for(roughness, "0.25"));
    ASSERT_TRUE(editor->click("inspector/Material/header", "3"));
    ASSERT_TRUE(editor->click("inspector/Material/Copy"));
    ASSERT_TRUE(editor->click("hierarchy/short block"));
    ASSERT_TRUE(editor->wait_for("inspector/name", "short block"));
    EXPECT_NE(editor->value(roughness), "0.25");
    ASSERT_TRUE(editor->click("inspector/Material/header", "3"));
    ASSERT_TRUE(editor->click("inspector/Material/Paste"));
    EXPECT_TRUE(editor->wait_for(roughness, "0.25"));
    ASSERT_TRUE(editor->click("inspector/Material/header", "3"));
    ASSERT_TRUE(editor->click("inspector/Material/Remove"));
    EXPECT_TRUE(editor->wait_until([&] { return !editor->find("inspector/Material/header").has_value(); }));
    ASSERT_TRUE(editor->click("inspector/Add component"));
    ASSERT_TRUE(editor->click("inspector/Material"));
    ASSERT_TRUE(editor->appears(roughness));
    EXPECT_NE(editor->value(roughness), "0.25") << "one that is new";
    ASSERT_TRUE(editor->click("inspector/Paste Material"));
    EXPECT_TRUE(editor->wait_for(roughness, "0.25"));
    editor->run("xdotool key --delay 60 ctrl+z ctrl+z ctrl+z");
    ASSERT_TRUE(editor->catch_up());
    EXPECT_TRUE(editor->wait_for(roughness, "0.25")) << "as it was pasted first";
    EXPECT_EQ(editor->end()["edits"], 2);
}

// About one pivot: rotated, they keep their distance; scaled, they and their distance grow alike.
TEST_F(EditorWindowEditing, HandlesTurnAndScaleSeveralAboutOnePivot) {
    ASSERT_NO_FATAL_FAILURE(select_both_blocks());
    const auto [tall, low] = both_blocks(fs::path(SUNFLECK_TOOL).parent_path() / "../scenes/cornell.scene.json");
    const float apart = glm::length(vec3(tall[3] - low[3]));
    const vec3 middle(0.5f * (tall[3] + low[3]));
    editor->key("e");
    ASSERT_TRUE(editor->appears("viewport/gizmo y"));
    ASSERT_TRUE(editor->drag("viewport/gizmo y", 60, 0));
    ASSERT_TRUE(editor->wait_for("menu/title", "cornell.scene.json *"));
    const auto [tall_turned, low_turned] = both_blocks_saved("turned");
    EXPECT_NEAR(glm::length(vec3(tall_turned[3] - low_turned[3])), apart, 1e-3f * apart);
    EXPECT_NEAR(glm::length(vec3(0.5f * (tall_turned[3] + low_turned[3])) - middle), 0.0f, 1e-3f * apart);
    EXPECT_GT(glm::length(vec3(tall_turned[3] - tall[3])), 0.02f * apart);
    EXPECT_NEAR(tall_turned[3].y, tall[3].y, 1e-3f * apart) << "about the upright axis";
    // The blocks themselves turn by the same angle.
    const auto turn = [](const mat4& from, const mat4& to) {
        const vec3 a = glm::normalize(vec3(from[0])), b = glm::normalize(vec3(to[0]));
        return std::atan2(glm::cross(a, b).y, glm::dot(a, b));
    };
    EXPECT_GT(std::abs(turn(tall, tall_turned)), 0.02f);
    EXPECT_NEAR(turn(tall, tall_turned), turn(low, low_turned), 1e-3f);

    editor->key("r");
    ASSERT_TRUE(editor->appears("viewport/gizmo middle"));
    ASSERT_TRUE(editor->drag("viewport/gizmo middle", 30, 0));
    ASSERT_TRUE(editor->wait_for("menu/title", "room.scene.json *"));
    const auto [tall_grown, low_grown] = both_blocks_saved("grown");
    const float factor = glm::length(vec3(tall_grown[0])) / glm::length(vec3(tall_turned[0]));
    EXPECT_GT(factor, 1.05f);
    EXPECT_NEAR(glm::length(vec3(low_grown[1])) / glm::length(vec3(low_turned[1])), factor, 1e-3f);
    EXPECT_NEAR(glm::length(vec3(tall_grown[3] - low_grown[3])), factor * apart, 2e-3f * apart);
    EXPECT_NEAR(glm::length(vec3(0.5f * (tall_grown[3] + low_grown[3])) - middle), 0.0f, 2e-3f * apart);
    EXPECT_EQ(editor->end()["edits"], 2) << "one entry for each drag";
}

// On a slow machine, a frame has the last motion and the release at once.
TEST_F(EditorWindowEditing, AHandleThatIsLetGoAtOnceStaysThere) {
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->reach("viewport/gizmo y"));
    const std::string place = "inspector/Transform/position/y", before = editor->value(place);
    editor->run("xdotool mousedown 1 mousemove_relative -- 0 -20 mouseup 1");
    EXPECT_TRUE(editor->wait_until([&] { return editor->value(place) != before; }));
    EXPECT_EQ(editor->end()["edits"], 1);
}

// Of a handle and of a number: Escape and the loss of focus leave no entry, and everything where it was.
TEST_F(EditorWindowEditing, AGestureThatIsGivenUpLeavesNothing) {
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->appears("viewport/gizmo y"));
    const std::string place = "inspector/Transform/position/y", before = editor->value(place);
    struct Drag {
        std::string from, motion;
    };
    for (const Drag& drag : {Drag{"viewport/gizmo y", "0 -20"}, Drag{place, "20 0"}})
        for (const bool by_escape : {true, false}) {
            SCOPED_TRACE(drag.from + (by_escape ? ", Escape" : ", loss of focus"));
            ASSERT_TRUE(editor->reach(drag.from));
            editor->run("xdotool mousedown 1 mousemove_relative -- " + drag.motion +
                        " sleep 0.1 mousemove_relative -- " + drag.motion + " sleep 0.1");
            ASSERT_TRUE(editor->wait_until([&] { return editor->value(place) != before; })) << "it is dragged";
            if (by_escape)
                editor->key("Escape");
            else
                ASSERT_TRUE(editor->minimise());
            editor->run("xdotool mouseup 1");
            ASSERT_TRUE(editor->focus());
            ASSERT_TRUE(editor->catch_up());
            EXPECT_TRUE(editor->wait_for(place, before));
            EXPECT_EQ(editor->value("menu/title"), "cornell.scene.json");
        }
    EXPECT_EQ(editor->end()["edits"], 0);
}

} // namespace
} // namespace sunfleck
