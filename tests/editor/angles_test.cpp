// Rotations as angles: in boxes that are typed into and dragged, beyond 90 degrees, too.
#include "editor/window/angles.h"

#include "tests/editor/panel_fixture.h"

#include <random>

namespace sunfleck::editor {
namespace {

float apart(const quat& a, const quat& b) {
    return 1.0f - std::abs(glm::dot(a, b));
}

TEST(EditorAngles, EveryRotationIsThatOfItsAngles) {
    std::mt19937 random(5);
    std::normal_distribution<float> part;
    for (int i = 0; i < 2000; ++i) {
        const quat rotation = glm::normalize(quat(part(random), part(random), part(random), part(random)));
        const Angles angles = angles_of(rotation);
        EXPECT_LE(std::abs(angles.x), 90.0);
        EXPECT_LT(apart(rotation_of(angles), rotation), 1e-6f);
    }
    for (const double y : {-179.0, -120.0, 0.0, 45.0, 90.0, 130.0, 180.0})
        for (const double x : {-90.0, -89.9, 0.0, 30.0, 90.0}) {
            const quat rotation = rotation_of({x, y, 0.0});
            EXPECT_LT(apart(rotation_of(angles_of(rotation)), rotation), 1e-6f) << x << " " << y;
            EXPECT_NEAR(angles_of(rotation).x, x, 0.01);
            EXPECT_EQ(angles_of(rotation).z, 0.0) << "nothing is tilted";
        }
}

TEST(EditorAngles, YIsWhereItLooksAndXHowFarUp) {
    const vec3 ahead(0.0f, 0.0f, -1.0f);
    EXPECT_NEAR(glm::length(rotation_of({0.0, 90.0, 0.0}) * ahead - vec3(-1.0f, 0.0f, 0.0f)), 0.0f, 1e-6f);
    EXPECT_GT((rotation_of({30.0, 120.0, 0.0}) * ahead).y, 0.49f);
    EXPECT_NEAR((rotation_of({30.0, 120.0, 77.0}) * ahead).y, 0.5f, 1e-6f) << "a tilt leaves where it looks";
}

class EditorRotation : public PanelTest {
protected:
    EditorRotation() {
        box_ = add("Box");
        frames(3);
    }
    quat now() { return document().registry().get<scene::Transform>(box_).rotation; }
    std::string shown() const {
        return value(rotation_ + "x") + " " + value(rotation_ + "y") + " " + value(rotation_ + "z");
    }

    const std::string rotation_ = "inspector/Transform/rotation/";
    Entity box_;
};

TEST_F(EditorRotation, TypedAnglesStay) {
    ASSERT_NO_FATAL_FAILURE(enter(rotation_ + "y", "120"));
    frame();
    EXPECT_EQ(shown(), "0 120 0");
    ASSERT_NO_FATAL_FAILURE(enter(rotation_ + "y", "130"));
    frame();
    EXPECT_EQ(shown(), "0 130 0");
    EXPECT_LT(apart(now(), glm::angleAxis(glm::radians(130.0f), vec3(0.0f, 1.0f, 0.0f))), 1e-6f);
    // Beyond what the orientation itself would say.
    ASSERT_NO_FATAL_FAILURE(enter(rotation_ + "x", "100"));
    ASSERT_NO_FATAL_FAILURE(enter(rotation_ + "z", "-190"));
    frame();
    EXPECT_EQ(shown(), "100 130 -190");
    EXPECT_LT(apart(now(), rotation_of({100.0, 130.0, -190.0})), 1e-6f);
    document().undo();
    document().undo();
    frames(2);
    EXPECT_EQ(shown(), "0 130 0");
    // They are this orientation's: of another one nothing that was typed is said.
    document().begin("Turn");
    auto place = document().registry().get<scene::Transform>(box_);
    place.rotation = glm::angleAxis(glm::radians(-50.0f), vec3(0.0f, 1.0f, 0.0f));
    document().set(box_, pool_of<scene::Transform>(document()), std::make_shared<scene::Transform>(place));
    document().commit();
    frames(2);
    EXPECT_EQ(shown(), "0 -50 0");
}

// A drag past a right angle goes on from the angles before it, about the same axis.
TEST_F(EditorRotation, DragsGoOnPastARightAngle) {
    for (const char* axis : {"x", "y", "z"}) {
        SCOPED_TRACE(axis);
        ASSERT_NO_FATAL_FAILURE(enter(rotation_ + "y", "20"));
        ASSERT_NO_FATAL_FAILURE(enter(rotation_ + axis, "80"));
        const std::size_t entries = document().history().entries().size();
        ASSERT_NO_FATAL_FAILURE(point_at(rotation_ + axis));
        press();
        double before = 80.0;
        quat turned = now();
        move(vec2(4.0f, 0.0f));
        for (int step = 0; step < 20; ++step) {
            move(vec2(4.0f, 0.0f));
            const double angle = std::stod(value(rotation_ + axis));
            EXPECT_GT(angle, before - 1e-6);
            EXPECT_LT(angle, before + 5.0) << "and none is left out";
            EXPECT_LT(apart(now(), turned), 2e-3f) << "it does not jump at " << angle;
            before = angle;
            turned = now();
        }
        EXPECT_GT(before, 100.0);
        let_go();
        frames(2);
        EXPECT_EQ(document().history().entries().size(), entries + 1);
        EXPECT_NEAR(std::stod(value(rotation_ + axis)), before, 5.0);
        for (const char* part : {"x", "y", "z"})
            ASSERT_NO_FATAL_FAILURE(enter(rotation_ + part, "0"));
    }
}

TEST_F(EditorRotation, SeveralKeepTheirOtherAngles) {
    const Entity other = add("Ball");
    for (const auto& [entity, x] : {std::pair(box_, "100"), std::pair(other, "-30")}) {
        document().select({entity});
        ASSERT_NO_FATAL_FAILURE(enter(rotation_ + "x", x));
    }
    document().select({box_, other});
    ASSERT_NO_FATAL_FAILURE(enter(rotation_ + "y", "140"));
    frames(2);
    EXPECT_EQ(shown(), "mixed 140 0");
    EXPECT_LT(apart(now(), rotation_of({100.0, 140.0, 0.0})), 1e-6f);
    EXPECT_LT(apart(document().registry().get<scene::Transform>(other).rotation, rotation_of({-30.0, 140.0, 0.0})),
              1e-6f);
}

} // namespace
} // namespace sunfleck::editor
