// What is hidden, muted, locked and alone: with all that is below it.
#include "editor/window/switches.h"

#include "editor/window/scene_copy.h"
#include "tests/editor/panel_fixture.h"

namespace sunfleck::editor {
namespace {

using Set = std::unordered_set<Entity>;

class EditorSwitches : public PanelTest {
protected:
    EditorSwitches() {
        inner_ = add("Point light");
        ball_ = add("Ball");
        outer_ = add("Spot light");
        group_ = group(document(), {inner_, ball_});
        frames(3);
    }
    Entity inner_, ball_, outer_, group_; // the group has the first two
};

TEST_F(EditorSwitches, TheEyeOfAGroupIsThatOfAllBelow) {
    const std::string eye = "hierarchy/eye ";
    ASSERT_NO_FATAL_FAILURE(click(eye + document().name(group_)));
    EXPECT_EQ(session_.hidden, (Set{group_, inner_, ball_}));
    frames(2);
    EXPECT_EQ(value(eye + document().name(inner_)), "hidden");
    EXPECT_EQ(value(eye + document().name(outer_)), "shown");
    ASSERT_NO_FATAL_FAILURE(click(eye + document().name(ball_))); // one of them alone
    EXPECT_EQ(session_.hidden, (Set{group_, inner_}));
    ASSERT_NO_FATAL_FAILURE(click(eye + document().name(group_)));
    EXPECT_TRUE(session_.hidden.empty());
}

TEST_F(EditorSwitches, AGroupThatIsAloneHasItsOwnLamps) {
    document().select({group_});
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    EXPECT_EQ(session_.hidden, (Set{outer_}));
    ASSERT_NO_FATAL_FAILURE(run("Show/Solo lamps"));
    EXPECT_TRUE(session_.hidden.empty());
}

TEST_F(EditorSwitches, WhatIsLockedIsLockedWithAllBelowAndNotDeleted) {
    document().select({group_});
    ASSERT_NO_FATAL_FAILURE(run("Show/Lock"));
    EXPECT_EQ(session_.locked, (Set{group_, inner_, ball_}));
    EXPECT_TRUE(is_locked(session_));
    document().select({outer_, ball_});
    EXPECT_FALSE(is_locked(session_)) << "one of them is not";

    // Neither one below, nor together with others.
    document().select({inner_});
    ASSERT_NO_FATAL_FAILURE(run("Edit/Delete"));
    EXPECT_TRUE(document().exists(inner_));
    EXPECT_NE(newest_message().find("Not deleted: point light"), std::string::npos) << newest_message();
    document().select({outer_, ball_});
    ASSERT_NO_FATAL_FAILURE(run("Edit/Delete"));
    EXPECT_FALSE(document().exists(outer_));
    EXPECT_TRUE(document().exists(ball_));
    document().undo();

    // Where one of several below is locked, what would take it along stays, too.
    document().select({group_});
    ASSERT_NO_FATAL_FAILURE(run("Show/Lock"));
    EXPECT_TRUE(session_.locked.empty());
    document().select({ball_});
    ASSERT_NO_FATAL_FAILURE(run("Show/Lock"));
    document().select({group_});
    ASSERT_NO_FATAL_FAILURE(run("Edit/Delete"));
    EXPECT_TRUE(document().exists(group_) && document().exists(inner_));
    document().select({inner_});
    ASSERT_NO_FATAL_FAILURE(run("Edit/Delete"));
    EXPECT_FALSE(document().exists(inner_));
}

TEST_F(EditorSwitches, HandlesLeaveWhatIsLockedAlone) {
    scene::CameraView view;
    view.position = vec3(0.0f, 0.5f, 6.0f);
    view.target = vec3(0.0f);
    session_.camera.set(view);
    const auto place = [&](Entity entity) { return vec3(world_of(document(), entity)[3]); };
    document().select({ball_});
    ASSERT_NO_FATAL_FAILURE(run("Show/Lock"));
    document().select({outer_, ball_, group_});
    ASSERT_NO_FATAL_FAILURE(point_at("viewport/gizmo x"));
    press();
    move(vec2(20.0f, 0.0f));
    move(vec2(20.0f, 0.0f));
    let_go();
    frame();
    EXPECT_GT(place(outer_).x, 0.05f);
    EXPECT_EQ(place(ball_), vec3(0.0f));
    EXPECT_EQ(place(group_), vec3(0.0f));
    document().select({ball_});
    frames(2);
    EXPECT_EQ(find("viewport/gizmo x"), nullptr) << "there is nothing to be moved";
    ASSERT_NO_FATAL_FAILURE(run("Show/Lock"));
    frames(2);
    EXPECT_NE(find("viewport/gizmo x"), nullptr);
}

// The lamp's body stays, and so does a surface that glows.
TEST_F(EditorSwitches, MutedLampsGiveNoLightAndStayInSight) {
    const Entity panel = add("Rectangle light");
    ASSERT_TRUE(document().registry().has<scene::MeshInstance>(panel));
    document().select({panel, group_});
    ASSERT_NO_FATAL_FAILURE(run("Show/Mute lamps"));
    EXPECT_EQ(session_.muted, (Set{panel, inner_}));
    EXPECT_TRUE(session_.hidden.empty());
    EXPECT_TRUE(is_muted(session_));
    document().select({group_, outer_});
    EXPECT_FALSE(is_muted(session_)) << "one of the lamps shines";
    document().select({panel, group_});
    frames(2);
    EXPECT_EQ(value("hierarchy/eye " + document().name(inner_)), "muted");

    ChangeCollector collector;
    HiddenFilter filter;
    PlainCopy copy;
    const auto tell = [&] {
        std::optional<SceneChange> change = collector.collect(session_.document);
        filter.apply(session_.document, session_.hidden, session_.muted, change);
        if (change)
            copy.apply(*change);
    };
    tell();
    EXPECT_FALSE(copy.registry.has<scene::PointLight>(inner_));
    EXPECT_TRUE(copy.registry.has<scene::SpotLight>(outer_));
    EXPECT_FALSE(copy.registry.has<scene::AreaLight>(panel));
    EXPECT_TRUE(copy.registry.has<scene::MeshInstance>(panel));
    EXPECT_EQ(copy.registry.get<scene::Material>(panel).emission, vec3(0.0f));
    EXPECT_NE(document().registry().get<scene::Material>(panel).emission, vec3(0.0f)) << "in the copy alone";
    EXPECT_TRUE(document().registry().has<scene::AreaLight>(panel));

    // Edited meanwhile, they stay dark; then they shine as they were edited.
    document().begin("Set");
    auto light = document().registry().get<scene::PointLight>(inner_);
    light.intensity = vec3(7.0f);
    document().set(inner_, pool_of<scene::PointLight>(document()), std::make_shared<scene::PointLight>(light));
    document().commit();
    tell();
    EXPECT_FALSE(copy.registry.has<scene::PointLight>(inner_));
    SceneChange everything = ChangeCollector::everything(session_.document);
    HiddenFilter::hide(session_.hidden, session_.muted, everything);
    PlainCopy other;
    other.apply(everything);
    EXPECT_FALSE(other.registry.has<scene::AreaLight>(panel));
    ASSERT_NO_FATAL_FAILURE(run("Show/Mute lamps"));
    EXPECT_TRUE(session_.muted.empty());
    tell();
    ASSERT_TRUE(copy.registry.has<scene::PointLight>(inner_) && copy.registry.has<scene::AreaLight>(panel));
    EXPECT_EQ(copy.registry.get<scene::PointLight>(inner_).intensity, vec3(7.0f));
    EXPECT_NE(copy.registry.get<scene::Material>(panel).emission, vec3(0.0f));
}

TEST_F(EditorSwitches, WhatIsMutedEndsWithShowAllAndWithTheScene) {
    document().select({ball_});
    ASSERT_NO_FATAL_FAILURE(run("Show/Mute lamps"));
    EXPECT_TRUE(session_.muted.empty());
    EXPECT_EQ(newest_message(), "Nothing that is selected gives light");
    document().select({outer_});
    ASSERT_NO_FATAL_FAILURE(key("M"));
    EXPECT_EQ(session_.muted, (Set{outer_}));
    ASSERT_NO_FATAL_FAILURE(run("Show/Show all"));
    EXPECT_TRUE(session_.muted.empty());
    ASSERT_NO_FATAL_FAILURE(run("Show/Mute lamps"));
    session_.take(std::make_shared<Document>());
    EXPECT_TRUE(session_.muted.empty());
}

// Over the picture, where nothing else tells why it is black.
TEST_F(EditorSwitches, APictureWithoutLampsSaysSo) {
    const auto said = [&] {
        frames(2);
        return find("viewport/no light") != nullptr;
    };
    EXPECT_FALSE(said());
    document().select({inner_});
    ASSERT_NO_FATAL_FAILURE(run("Show/Mute lamps"));
    EXPECT_FALSE(said()) << "the other one shines";
    session_.hidden = {outer_};
    EXPECT_TRUE(said());
    EXPECT_NE(value("viewport/no light").find("Show all"), std::string::npos);
    add("Sun");
    EXPECT_FALSE(said()) << "a new one shines";
    document().undo();
    EXPECT_TRUE(said());
    ASSERT_NO_FATAL_FAILURE(run("Show/Show all"));
    EXPECT_FALSE(said());
}

} // namespace
} // namespace sunfleck::editor
