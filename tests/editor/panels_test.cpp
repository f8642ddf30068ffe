// Panels, without a window: what they show belongs to what it stands beside, and what is given up leaves no trace.
#include "tests/editor/panel_fixture.h"

#include "editor/window/presets.h"
#include "engine/core/file.h"
#include "gi_module/technique.h"

namespace sunfleck::editor {
namespace {

class EditorPanels : public PanelTest {
protected:
    void show(const std::string& panel) {
        session_.front = panel;
        frames(3);
    }
    void set_setting(const std::string& name, const std::string& text) {
        document().begin("Set");
        ASSERT_TRUE(document().set_setting(name, text));
        document().commit();
        frame();
    }
    // Measuring never begins, as while the scene is drawn all the time.
    void make_cost_threads_that_wait() {
        session_.make_cost_thread = [] {
            return std::make_unique<CostThread>(
                tests::device(), [] { return true; }, [] {});
        };
    }
};

// Of "bounces": "2" over "1" is no cost of "3" over "2", of "1" over "2" or of another scene's value.
TEST_F(EditorPanels, ACostStandsBesideTheValueThatWasMeasured) {
    make_cost_threads_that_wait();
    show("Lighting");
    ASSERT_NO_FATAL_FAILURE(click("lighting/search"));
    type("bounces");
    const std::string cost = "lighting/bounces/cost", button = "lighting/bounces/Measure";
    ASSERT_NO_FATAL_FAILURE(set_setting("bounces", "1"));
    ASSERT_NO_FATAL_FAILURE(set_setting("bounces", "2"));
    ASSERT_NO_FATAL_FAILURE(click(button));
    frame();
    const auto is_begun = [&] { return value(cost) == "measuring ..." || value(cost).starts_with("waits until"); };
    EXPECT_TRUE(is_begun()) << value(cost);
    for (int tries = 0; tries < 3000 && !session_.cost->cost().waits; ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    frame();
    EXPECT_EQ(value(cost), "waits until the scene is at rest ...");
    EXPECT_TRUE(session_.cost->cost().is_of("bounces", "2", "1"));

    ASSERT_NO_FATAL_FAILURE(set_setting("bounces", "3"));
    frame();
    EXPECT_EQ(find(cost), nullptr) << value(cost);
    EXPECT_EQ(session_.cost->cost().setting, "") << "nobody asks about it any more";
    EXPECT_NE(find(button), nullptr);
    document().undo();
    frames(2);
    EXPECT_EQ(find(cost), nullptr);

    ASSERT_NO_FATAL_FAILURE(click(button));
    EXPECT_TRUE(is_begun()) << value(cost);
    auto other = std::make_shared<Document>();
    for (const char* bounces : {"1", "2"}) { // the same values over the same ones
        other->begin("Set");
        ASSERT_TRUE(other->set_setting("bounces", bounces));
        other->commit();
    }
    session_.take(other);
    frames(2);
    EXPECT_EQ(find(cost), nullptr) << "it was another scene's";
    EXPECT_EQ(session_.cost->cost().setting, "");
}

TEST(EditorCostOf, AValueAndTheOneBefore) {
    Cost cost;
    cost.setting = "lights";
    cost.from = "300";
    cost.to = "600";
    EXPECT_TRUE(cost.is_of("lights", "600", "300"));
    EXPECT_FALSE(cost.is_of("bounces", "600", "300"));
    EXPECT_FALSE(cost.is_of("lights", "700", "300"));
    EXPECT_FALSE(cost.is_of("lights", "600", "200"));
    EXPECT_FALSE(cost.is_of("lights", "300", "600"));
}

// What the viewport shows is of no document, whose gestures take the rest back.
TEST_F(EditorPanels, EscapeTakesADragOfTheLookBack) {
    show("Views");
    const std::string glare = "views/glare/value";
    const float usual = session_.view.look.glare;
    const auto drag = [&] {
        ASSERT_NO_FATAL_FAILURE(point_at(glare));
        press();
        move(vec2(30.0f, 0.0f));
        move(vec2(30.0f, 0.0f));
        ASSERT_NE(session_.view.look.glare, usual);
    };
    ASSERT_NO_FATAL_FAILURE(drag());
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    let_go();
    frames(2);
    EXPECT_EQ(session_.view.look.glare, usual);

    ASSERT_NO_FATAL_FAILURE(drag());
    input_.focused = false;
    input_.mouse_buttons[0] = false;
    frames(2);
    input_.focused = true;
    frames(2);
    EXPECT_EQ(session_.view.look.glare, usual) << "nor does a drag that another window interrupts stay";

    ASSERT_NO_FATAL_FAILURE(drag());
    let_go();
    frames(2);
    EXPECT_NE(session_.view.look.glare, usual);
    EXPECT_TRUE(document().history().entries().empty());
}

TEST_F(EditorPanels, WhatIsDraggedWhileItsEntityGoesLeavesNoGesture) {
    const Entity box = add("Box");
    frames(3);
    ASSERT_NO_FATAL_FAILURE(point_at("inspector/Transform/position/x"));
    press();
    move(vec2(30.0f, 0.0f));
    move(vec2(30.0f, 0.0f));
    ASSERT_TRUE(document().in_gesture());
    document().select({});
    frames(2);
    let_go();
    frames(2);
    EXPECT_FALSE(document().in_gesture());
    EXPECT_EQ(document().registry().get<scene::Transform>(box).position, vec3(0.0f));
}

TEST_F(EditorPanels, TheProfileIsSavedBesideWhatWasSavedBefore) {
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder_.path);
    for (std::uint64_t number : {1, 2})
        session_.frames.push_back({number, {}});
    show("Profile");
    for (const auto& [button, name, second] : {std::tuple("Save CSV", "sunfleck_frames.csv", "sunfleck_frames 2.csv"),
                                               {"Save trace", "sunfleck_trace.json", "sunfleck_trace 2.json"}}) {
        ASSERT_TRUE(write_file(folder_ / name, "of yesterday"));
        click(std::string("profile/") + button);
        EXPECT_EQ(read_file(folder_ / name).value(), "of yesterday");
        EXPECT_TRUE(std::filesystem::exists(folder_ / second));
        EXPECT_EQ(newest_message(), "Wrote " + (folder_ / second).string());
    }
    std::filesystem::current_path(before);
}

TEST_F(EditorPanels, TheProfileBeginsAnewWithAnotherSceneUnlessItIsPaused) {
    for (const bool paused : {true, false}) {
        session_.profiling = !paused;
        session_.frames.push_back({1, {}});
        session_.take(std::make_shared<Document>());
        EXPECT_EQ(session_.frames.empty(), !paused);
    }
}

TEST_F(EditorPanels, TheProfileHasItsMedianAndABudgetInRange) {
    for (std::uint64_t number = 1; number <= 20; ++number) {
        session_.frames.push_back({number, {}});
        session_.frames.back().statistics.frame_ms = 5.0;
    }
    show("Profile");
    EXPECT_NE(find("profile/line median 5.00 ms"), nullptr) << "also where frames are alike";
    EXPECT_NE(find("profile/line 95 % 5.00 ms"), nullptr);
    ASSERT_NO_FATAL_FAILURE(enter("profile/budget", "20"));
    EXPECT_EQ(session_.budgets.frame_ms, 20.0f);
    for (const char* bad : {"0", "-5", "nan", "abc", "1e5"}) {
        const std::uint64_t said = session_.messages.count();
        ASSERT_NO_FATAL_FAILURE(enter("profile/budget", bad));
        EXPECT_EQ(session_.budgets.frame_ms, 20.0f) << bad;
        EXPECT_EQ(session_.messages.count(), said + 1) << bad;
        EXPECT_NE(newest_message().find("is not a value of 'Budget of a frame': 1 to 1000 ms"), std::string::npos)
            << newest_message();
    }
    ASSERT_NO_FATAL_FAILURE(point_at("profile/budget"));
    press();
    move(vec2(40.0f, 0.0f));
    move(vec2(40.0f, 0.0f));
    EXPECT_GT(session_.budgets.frame_ms, 20.0f);
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    let_go();
    frames(2);
    EXPECT_EQ(session_.budgets.frame_ms, 20.0f) << "a drag that is given up";
}

TEST_F(EditorPanels, ABudgetOfACounterIsANumber) {
    add("Box");
    ViewRequest request;
    request.width = request.height = 32;
    scene_.change(ChangeCollector::everything(session_.document));
    scene_.show(request);
    const auto settled = [&] { return scene_.picture() != nullptr && scene_.picture()->settled; };
    for (int tries = 0; tries < 3000 && !settled(); ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(settled());
    show("Counters");
    const std::string name(gi::all_counters().front()->name);
    frames(10); // until the columns are as wide as what they hold
    ASSERT_NO_FATAL_FAILURE(click("counters/" + name));
    ASSERT_NO_FATAL_FAILURE(enter("counters/budget/most", "12"));
    EXPECT_EQ(session_.budgets.counters, (std::map<std::string, double>{{name, 12.0}}));
    for (const char* bad : {"abc", "nan", "-3", "inf", ""}) {
        const std::uint64_t said = session_.messages.count();
        ASSERT_NO_FATAL_FAILURE(click("counters/budget/most"));
        key("Ctrl+A");
        key("Delete");
        type(bad);
        key("Enter");
        EXPECT_EQ(session_.budgets.counters[name], 12.0) << bad;
        EXPECT_EQ(session_.messages.count(), said + 1) << bad;
    }
}

TEST_F(EditorPanels, DifferencesAreOfAnyTwo) {
    session_.preset_folder = folder_ / "presets";
    gi::Settings settings = document().settings();
    for (const char* bounces : {"1", "2"}) {
        ASSERT_TRUE(settings.set("bounces", bounces));
        ASSERT_TRUE(save_preset(session_.preset_folder, std::string("with ") + bounces, settings));
    }
    ASSERT_NO_FATAL_FAILURE(set_setting("bounces", "3"));
    show("Compare");
    const std::string line = "compare/difference bounces";
    EXPECT_EQ(find(line), nullptr) << "nothing is kept";
    const auto choose = [&](const std::string& side, const std::string& one) {
        ASSERT_NO_FATAL_FAILURE(click("compare/" + side));
        ASSERT_NO_FATAL_FAILURE(click("compare/" + one));
        frames(2);
    };
    ASSERT_NO_FATAL_FAILURE(choose("second", "with 2"));
    EXPECT_EQ(value(line), "Bounces: 3 here, 2 in with 2");
    ASSERT_NO_FATAL_FAILURE(choose("first", "with 1"));
    EXPECT_EQ(value(line), "Bounces: 1 in with 1, 2 in with 2");
    session_.comparison->keep(settings);
    ASSERT_NO_FATAL_FAILURE(choose("second", "(kept)"));
    EXPECT_EQ(value(line), "Bounces: 1 in with 1, 2 kept");

    // One that is gone is said once, and the scene takes its place.
    std::filesystem::remove_all(session_.preset_folder);
    ASSERT_NO_FATAL_FAILURE(choose("second", "(scene)"));
    EXPECT_EQ(value("compare/first"), "(scene)");
    const std::uint64_t said = session_.messages.count();
    frames(3);
    EXPECT_EQ(session_.messages.count(), said);
    EXPECT_NE(newest_message().find("with 1"), std::string::npos) << newest_message();
}

// Before anything is restored.
TEST_F(EditorPanels, RecoverySaysWhatItWouldRestore) {
    Recovered lost;
    lost.folder = folder_ / "1.0";
    lost.file = (folder_ / "hall.scene.json").string();
    lost.edits = {"Move lamp", "Set intensity of lamp"};
    lost.count = 7;
    std::filesystem::create_directories(lost.folder);
    session_.recovered = {lost};
    session_.dialog = Dialog::recover;
    frames(3);
    const std::string question = value("dialog/question");
    EXPECT_NE(question.find(lost.file), std::string::npos) << question;
    EXPECT_NE(question.find("(7)"), std::string::npos) << question;
    EXPECT_EQ(value("dialog/edit 1"), "Move lamp");
    EXPECT_EQ(value("dialog/edit 2"), "Set intensity of lamp");
    ASSERT_NO_FATAL_FAILURE(click("dialog/Later"));
    EXPECT_EQ(session_.dialog, Dialog::none);
    EXPECT_TRUE(std::filesystem::exists(lost.folder)) << "they are offered again";
}

TEST_F(EditorPanels, PlayingWhatDoesNotMoveIsSaid) {
    const std::uint64_t before = session_.messages.count();
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+Space"));
    EXPECT_TRUE(session_.view.playing);
    ASSERT_EQ(session_.messages.count(), before + 1);
    EXPECT_NE(session_.messages.all().back().text.find("Nothing moves"), std::string::npos);
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+Space"));
    EXPECT_FALSE(session_.view.playing);
    document().begin("Add");
    const Entity wheel = document().create();
    scene::Mover turning;
    turning.path = scene::MoverPath::spin;
    document().set(wheel, pool_of<scene::Name>(document()), std::make_shared<scene::Name>(scene::Name{"wheel"}));
    document().set(wheel, pool_of<scene::Mover>(document()), std::make_shared<scene::Mover>(turning));
    document().commit();
    ASSERT_NO_FATAL_FAILURE(key("Ctrl+Space"));
    EXPECT_EQ(session_.messages.count(), before + 1) << "it turns";
}

} // namespace
} // namespace sunfleck::editor
