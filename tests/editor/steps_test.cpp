// Handles in steps: as long as their boxes say, along the object's own axes, too, and kept from run to run.
#include "editor/window/state_file.h"
#include "engine/core/file.h"
#include "tests/editor/panel_fixture.h"

#include <thread>

namespace sunfleck::editor {
namespace {

class EditorSteps : public PanelTest {
protected:
    EditorSteps() {
        scene::CameraView view;
        view.position = vec3(1.0f, 2.0f, 6.0f);
        view.target = vec3(0.0f);
        session_.camera.set(view);
        box_ = add("Box");
        session_.gizmo.snap = true;
        frames(3);
    }
    const scene::Transform& place() { return document().registry().get<scene::Transform>(box_); }
    void drag(const std::string& handle, vec2 by) {
        ASSERT_NO_FATAL_FAILURE(point_at("viewport/gizmo " + handle));
        press();
        for (int i = 0; i < 4; ++i)
            move(0.25f * by);
        let_go();
        frames(2);
    }
    static void expect_multiple(float value, float step) {
        EXPECT_GT(std::abs(value), 0.5f * step) << "it has moved";
        EXPECT_NEAR(value / step, std::round(value / step), 1e-3f) << value;
    }
    Entity box_;
};

TEST_F(EditorSteps, AreAsLongAsTheBoxesSay) {
    ASSERT_NO_FATAL_FAILURE(enter("viewport/step of moves", "0.3"));
    ASSERT_NO_FATAL_FAILURE(enter("viewport/step of rotations", "7"));
    ASSERT_NO_FATAL_FAILURE(enter("viewport/step of scales", "0.15"));
    EXPECT_EQ(session_.gizmo.steps, (SnapSteps{0.3f, 7.0f, 0.15f}));
    ASSERT_NO_FATAL_FAILURE(drag("x", vec2(90.0f, 0.0f)));
    expect_multiple(place().position.x, 0.3f);
    EXPECT_EQ(place().position.y, 0.0f);
    session_.gizmo.mode = GizmoMode::rotate;
    ASSERT_NO_FATAL_FAILURE(drag("y", vec2(60.0f, 0.0f)));
    expect_multiple(glm::degrees(glm::angle(place().rotation)), 7.0f);
    session_.gizmo.mode = GizmoMode::scale;
    const vec3 before = place().scale;
    ASSERT_NO_FATAL_FAILURE(drag("middle", vec2(60.0f, 0.0f)));
    expect_multiple(place().scale.x / before.x, 0.15f);
    EXPECT_GT(place().scale.x, before.x);
    EXPECT_NEAR(place().scale.x / before.x, place().scale.z / before.z, 1e-5f);
    EXPECT_EQ(document().history().entries().size(), 4u);
}

TEST_F(EditorSteps, GoAlongLocalAxes) {
    document().begin("Turn");
    scene::Transform turned = place();
    turned.rotation = glm::angleAxis(glm::radians(30.0f), vec3(0.0f, 1.0f, 0.0f));
    document().set(box_, pool_of<scene::Transform>(document()), std::make_shared<scene::Transform>(turned));
    document().commit();
    session_.gizmo.local = true;
    ASSERT_NO_FATAL_FAILURE(enter("viewport/step of moves", "0.25"));
    ASSERT_NO_FATAL_FAILURE(drag("x", vec2(90.0f, 0.0f)));
    const vec3 moved = place().position, along = turned.rotation * vec3(1.0f, 0.0f, 0.0f);
    expect_multiple(glm::dot(moved, along), 0.25f);
    EXPECT_NEAR(glm::length(moved - along * glm::dot(moved, along)), 0.0f, 1e-5f);
    // In the plane of two axes, by whole steps along each.
    ASSERT_NO_FATAL_FAILURE(drag("plane y", vec2(70.0f, 25.0f)));
    const vec3 further = glm::inverse(turned.rotation) * (place().position - moved);
    EXPECT_GT(glm::length(further), 0.2f);
    EXPECT_NEAR(further.y, 0.0f, 1e-4f);
    for (const float part : {further.x, further.z})
        EXPECT_NEAR(part / 0.25f, std::round(part / 0.25f), 1e-3f);
    // About its own axis.
    session_.gizmo.mode = GizmoMode::rotate;
    ASSERT_NO_FATAL_FAILURE(drag("x", vec2(0.0f, 50.0f)));
    const quat by = glm::inverse(turned.rotation) * place().rotation;
    expect_multiple(glm::degrees(glm::angle(by)), 15.0f);
    EXPECT_NEAR(std::abs(glm::axis(by).x), 1.0f, 1e-4f);
}

// It is no "Select none" then.
TEST_F(EditorSteps, EscapeTakesBackADragAndNothingElse) {
    ASSERT_NO_FATAL_FAILURE(point_at("viewport/gizmo x"));
    press();
    move(vec2(40.0f, 0.0f));
    move(vec2(40.0f, 0.0f));
    ASSERT_NE(place().position, vec3(0.0f));
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    EXPECT_EQ(place().position, vec3(0.0f));
    EXPECT_TRUE(document().selected(box_));
    let_go();
    frames(2);
    EXPECT_EQ(document().history().entries().size(), 1u);
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    EXPECT_FALSE(document().selected(box_)) << "and now it is";
}

TEST_F(EditorSteps, WhatIsNoStepIsSaidOnce) {
    for (const char* bad : {"0", "-1", "abc", "nan", "1e9"}) {
        const std::uint64_t said = session_.messages.count();
        ASSERT_NO_FATAL_FAILURE(enter("viewport/step of moves", bad));
        EXPECT_EQ(session_.gizmo.steps, SnapSteps());
        EXPECT_EQ(session_.messages.count(), said + 1) << bad;
        EXPECT_NE(newest_message().find("is not a value of 'Steps of moves'"), std::string::npos) << newest_message();
    }
}

TEST(EditorStateFile, StepsAreKeptFromRunToRun) {
    const tests::Folder folder{"editor_steps"};
    EditorState state;
    state.steps = {0.25f, 5.0f, 0.5f};
    ASSERT_TRUE(save_state(folder / "settings.json", state));
    std::string problem;
    bool may_save = false;
    EXPECT_EQ(load_state(folder / "settings.json", problem, may_save).steps, state.steps);
    ASSERT_TRUE(write_file(folder / "settings.json", R"({"snap": {"length": 0, "angle": 30, "factor": "x"}})"));
    EXPECT_EQ(load_state(folder / "settings.json", problem, may_save).steps, (SnapSteps{0.1f, 30.0f, 0.1f}));
    EXPECT_EQ(problem, "");
}

// While the program runs: once it rests, or now and then where it never does; nothing is written that is there.
TEST(EditorStateFile, IsKeptBeforeTheEnd) {
    const tests::Folder folder{"editor_kept"};
    const std::filesystem::path file = folder / "settings.json";
    StateKeeper keeper;
    auto now = StateKeeper::Clock::now();
    EXPECT_FALSE(keeper.is_due(now + StateKeeper::longest)) << "nothing has been drawn";
    keeper.note_frame(now);
    EXPECT_FALSE(keeper.is_due(now));
    EXPECT_TRUE(keeper.is_due(now + StateKeeper::rest));
    EditorState state;
    state.steps.length = 0.7f;
    ASSERT_TRUE(keeper.keep(file, state, now += StateKeeper::rest));
    const std::string written = read_file(file).value();
    EXPECT_EQ(written, state_text(state));
    EXPECT_FALSE(keeper.is_due(now + 2 * StateKeeper::longest)) << "a window at rest has nothing more to do";

    std::filesystem::remove(file);
    keeper.note_frame(now);
    ASSERT_TRUE(keeper.keep(file, state, now));
    EXPECT_FALSE(std::filesystem::exists(file)) << "it has not changed";
    state.keys["Edit/Undo"] = "F9";
    for (auto until = now + StateKeeper::longest; now < until; now += std::chrono::milliseconds(500)) {
        keeper.note_frame(now);
        EXPECT_FALSE(keeper.is_due(now));
    }
    keeper.note_frame(now);
    EXPECT_TRUE(keeper.is_due(now)) << "though it is drawn all the time";
    ASSERT_TRUE(keeper.keep(file, state, now));
    EXPECT_NE(read_file(file).value().find("\"F9\""), std::string::npos);

    // What cannot be written is said once.
    std::filesystem::create_directories(folder / "folder.json");
    state.keys.clear();
    EXPECT_FALSE(keeper.keep(folder / "folder.json", state, now));
    EXPECT_TRUE(keeper.keep(folder / "folder.json", state, now));
    state.steps.length = 0.9f; // as every movement changes something
    EXPECT_TRUE(keeper.keep(folder / "folder.json", state, now));
    state.steps.length = 1.1f;
    EXPECT_TRUE(keeper.keep(file, state, now));
    EXPECT_EQ(read_file(file).value(), state_text(state));
    state.steps.length = 1.3f;
    EXPECT_FALSE(keeper.keep(folder / "folder.json", state, now)) << "it had gone well in between";
}

// Two editors at the same time: each writes what has changed in it, and leaves the other's alone.
TEST(EditorStateFile, OfTwoEditorsHasWhatBothChanged) {
    const tests::Folder folder{"editor_two"};
    const std::filesystem::path file = folder / "settings.json";
    EditorState first;
    first.recent_files = {"old", "older"};
    first.keys["Edit/Undo"] = "F9";
    first.budgets.counters["light samples"] = 300.0;
    ASSERT_TRUE(save_state(file, first));
    EditorState second = first;
    StateKeeper of_first(first), of_second(second);

    first.recent_files = {"first", "old", "older"};
    first.keys["Edit/Redo"] = "F10";
    first.cameras["first"] = {};
    first.layout.left = 0.31f;
    ASSERT_TRUE(of_first.keep(file, first));
    second.recent_files = {"second", "old"}; // one was removed
    second.keys.clear();
    second.cameras["second"] = {};
    second.layout.right = 0.29f;
    second.budgets.counters["light samples"] = 500.0;
    ASSERT_TRUE(of_second.finish(file, second));

    std::string problem;
    bool may_save = false;
    EditorState both = load_state(file, problem, may_save);
    EXPECT_EQ(problem, "");
    EXPECT_EQ(both.recent_files, (std::vector<std::string>{"second", "old", "first"}));
    EXPECT_EQ(both.keys, (std::map<std::string, std::string>{{"Edit/Redo", "F10"}}));
    EXPECT_EQ(both.cameras.size(), 2u);
    EXPECT_EQ(both.layout.left, 0.31f);
    EXPECT_EQ(both.layout.right, 0.29f);
    EXPECT_EQ(both.budgets.counters["light samples"], 500.0);

    // The first one goes on: what it has not changed since stays as the second one left it.
    first.steps.length = 0.7f;
    ASSERT_TRUE(of_first.keep(file, first));
    both = load_state(file, problem, may_save);
    EXPECT_EQ(both.steps.length, 0.7f);
    EXPECT_EQ(both.recent_files.front(), "second");
    EXPECT_EQ(both.layout.right, 0.29f);

    // What cannot be read, here for its size, stays as it is.
    const std::string large(2u << 20, ' ');
    ASSERT_TRUE(write_file(file, large));
    first.steps.length = 0.9f;
    EXPECT_FALSE(of_first.finish(file, first));
    EXPECT_EQ(read_file(file).value(), large);
}

// Editors that write at the same moment, as when a session ends: none reads what another is about to replace.
TEST(EditorStateFile, OfManyEditorsHasWhatAllChanged) {
    const tests::Folder folder{"editor_many"};
    const std::filesystem::path file = folder / "settings.json";
    ASSERT_TRUE(save_state(file, {}));
    constexpr int editors = 6, changes = 10;
    std::vector<std::thread> running;
    running.reserve(editors);
    for (int number = 0; number < editors; ++number)
        running.emplace_back([&, number] {
            EditorState state;
            StateKeeper keeper(state);
            for (int i = 0; i < changes; ++i) {
                state.keys["of " + std::to_string(number) + ", " + std::to_string(i)] = "F9";
                EXPECT_TRUE(keeper.keep(file, state));
            }
        });
    for (std::thread& one : running)
        one.join();
    std::string problem;
    bool may_save = false;
    EXPECT_EQ(load_state(file, problem, may_save).keys.size(), std::size_t(editors * changes));
    EXPECT_EQ(problem, "");
}

} // namespace
} // namespace sunfleck::editor
