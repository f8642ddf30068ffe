// The tree of entities: names, what is folded, and room for names in deep trees.
#include "engine/scene/simulation_components.h"
#include "tests/editor/panel_fixture.h"
#include "tests/editor/size_scene.h"

namespace sunfleck::editor {
namespace {

class EditorHierarchy : public PanelTest {
protected:
    // Entities below one another, the topmost first.
    Entities chain(int length) {
        Entities result;
        for (int i = 0; i < length; ++i) {
            result.push_back(add("Ball"));
            if (i > 0) {
                EXPECT_TRUE(reparent(document(), {result[std::size_t(i)]}, result[std::size_t(i - 1)]));
            }
        }
        return result;
    }
    std::string row(Entity entity) { return "hierarchy/" + document().name(entity); }
};

TEST_F(EditorHierarchy, RenamingIsACommand) {
    const Entity box = add("Box");
    session_.front = "Inspector";
    frames(3);
    ASSERT_NO_FATAL_FAILURE(key("F2"));
    frames(3);
    type("crate");
    ASSERT_NO_FATAL_FAILURE(key("Enter"));
    EXPECT_EQ(document().name(box), "crate");

    // By other keys, and wherever it is: in a folded tree, or not among what was searched for.
    session_.commands->bind(*session_.commands->find("Edit/Rename"), shortcut_from_text("Ctrl+Shift+F9"));
    ASSERT_NO_FATAL_FAILURE(click("hierarchy/search"));
    type("nothing of this name");
    frames(2);
    EXPECT_EQ(find("hierarchy/crate"), nullptr);
    ASSERT_NO_FATAL_FAILURE(key("Enter"));
    frames(2);
    document().select({box});
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+Shift+F9"));
    frames(3);
    ASSERT_NE(find("hierarchy/rename"), nullptr);
    type("chest");
    ASSERT_NO_FATAL_FAILURE(key("Enter"));
    EXPECT_EQ(document().name(box), "chest");

    document().select({});
    EXPECT_FALSE(session_.commands->find("Edit/Rename")->is_enabled(session_));
}

TEST_F(EditorHierarchy, ANameThatIsBeingTypedEndsWithItsScene) {
    const Entity box = add("Box");
    frames(2);
    ASSERT_NO_FATAL_FAILURE(key("F2"));
    frames(3);
    type("crate");
    ASSERT_NE(find("hierarchy/rename"), nullptr);
    auto other = std::make_shared<Document>();
    for (const scene::EntityTemplate& source : scene::entity_templates())
        if (source.name == "Ball") {
            EXPECT_EQ(add_from(*other, source, vec3(0.0f), 1.0f), box) << "the same handle";
        }
    session_.take(other);
    frames(4);
    EXPECT_EQ(find("hierarchy/rename"), nullptr);
    EXPECT_EQ(document().name(box), "ball");
    EXPECT_FALSE(document().unsaved() && document().history().entries().size() > 1);
}

// A value that is being typed, likewise: the other scene has the same box.
TEST_F(EditorHierarchy, AValueThatIsBeingTypedEndsWithItsScene) {
    session_.front = "Lighting";
    frames(3);
    ASSERT_NO_FATAL_FAILURE(click("lighting/search"));
    type("bounces");
    frames(2);
    ASSERT_NO_FATAL_FAILURE(click("lighting/bounces/value"));
    type("7");
    const std::string usual = document().settings().get("bounces");
    ASSERT_NE(usual, "7");
    session_.take(std::make_shared<Document>());
    frames(4);
    ASSERT_NO_FATAL_FAILURE(key("Enter"));
    frames(2);
    EXPECT_EQ(document().settings().get("bounces"), usual);
    EXPECT_FALSE(document().unsaved());
}

// A text, whose box the other scene has, too.
TEST_F(EditorHierarchy, ATextThatIsBeingTypedEndsWithItsScene) {
    const auto fill = [](Document& one) {
        Entity entity;
        for (const scene::EntityTemplate& source : scene::entity_templates())
            if (source.name == "Box")
                entity = add_from(one, source, vec3(0.0f), 1.0f);
        add_component(one, {entity}, pool_of<scene::LightSensor>(one));
        return entity;
    };
    const Entity box = fill(document());
    document().select({box});
    frames(3);
    ASSERT_NO_FATAL_FAILURE(click("inspector/LightSensor/opens/value"));
    type("gate");
    auto other = std::make_shared<Document>();
    ASSERT_EQ(fill(*other), box);
    session_.take(other);
    frames(2);
    document().select({box});
    frames(4);
    EXPECT_EQ(document().registry().get<scene::LightSensor>(box).opens, "");
}

TEST_F(EditorHierarchy, WhatIsSelectedElsewhereIsUnfolded) {
    auto large = std::shared_ptr<Document>(tests::make_scene(tests::Shape::deep, 1000));
    session_.take(large);
    frames(3);
    Entity deep = document().roots().front();
    while (!document().children(deep).empty())
        deep = document().children(deep).back();
    ASSERT_FALSE(document().parent(deep).is_null());
    EXPECT_EQ(find(row(deep)), nullptr) << "large trees begin folded";
    document().select({deep});
    frames(3);
    ASSERT_NE(find(row(deep)), nullptr);
    EXPECT_EQ(value(row(deep)), "selected");
    // Folded by hand, it stays so.
    const Entity above = document().parent(deep);
    ASSERT_NO_FATAL_FAILURE(click("hierarchy/open " + document().name(above)));
    frames(3);
    EXPECT_EQ(find(row(deep)), nullptr);
}

TEST_F(EditorHierarchy, DeepRowsHaveRoomForTheirNames) {
    const Entities all = chain(60);
    for (const std::size_t depth : {std::size_t(1), std::size_t(20), std::size_t(40), all.size() - 1}) {
        document().select({all[depth]});
        frames(3);
        const ui::Note* const found = find(row(all[depth]));
        ASSERT_NE(found, nullptr) << depth;
        EXPECT_GT(found->high.x - found->low.x, 6.0f * ui::unit()) << depth;
    }
    // The deeper, the further to the right all the same.
    document().select({all[30]});
    frames(3);
    const ui::Note *const upper = find(row(all[29])), *const lower = find(row(all[31]));
    ASSERT_TRUE(upper != nullptr && lower != nullptr);
    EXPECT_LT(upper->low.x, lower->low.x);
}

} // namespace
} // namespace sunfleck::editor
