// What the player chooses: kept whole, and damage does no harm.
#include "engine/core/file.h"
#include "game_demo/controls.h"
#include "game_demo/hitch_log.h"
#include "game_demo/menu.h"
#include "game_demo/presets.h"
#include "game_demo/prompt_text.h"
#include "gi_module/reference/path_tracer.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <thread>

namespace sunfleck::demo {
namespace {

namespace fs = std::filesystem;

class DemoSettingsTest : public testing::Test {
protected:
    void SetUp() override {
        path = fs::path(testing::TempDir()) / ("sunfleck_demo_" + std::to_string(getpid())) / "demo.json";
    }
    void TearDown() override { fs::remove_all(path.parent_path()); }
    fs::path path;
};

TEST_F(DemoSettingsTest, ComeBackAsTheyWere) {
    DemoSettings settings;
    settings.preset = Preset::custom;
    settings.exposure = -1.25f;
    settings.light_samples = 777;
    settings.invert_look = true;
    settings.bindings[std::size_t(Action::use)] = app::first_mouse_button + 1;
    settings.bindings[std::size_t(Action::run)] = app::key_f1 + 4;
    ASSERT_TRUE(save_settings(path, settings)); // makes the folder
    const LoadedSettings loaded = load_settings(path);
    EXPECT_TRUE(loaded.found);
    EXPECT_EQ(loaded.problem, "");
    for (const Field& field : DemoSettings::description().fields)
        EXPECT_EQ(field_to_text(field, &loaded.settings), field_to_text(field, &settings));
    EXPECT_EQ(loaded.settings.bindings, settings.bindings);
}

TEST_F(DemoSettingsTest, DamagedFilesGiveTheUsualSettingsAndAreKept) {
    EXPECT_FALSE(load_settings(path).found);
    ASSERT_TRUE(save_settings(path, DemoSettings()));
    const std::string whole = read_file(path).value();
    for (std::size_t length = 0; length < whole.size(); length += 7) {
        ASSERT_TRUE(write_file(path, whole.substr(0, length)));
        const LoadedSettings loaded = load_settings(path);
        EXPECT_NE(loaded.problem.find("damaged"), std::string::npos) << length;
        EXPECT_EQ(loaded.settings.light_samples, DemoSettings().light_samples);
        EXPECT_TRUE(fs::exists(path.string() + ".damaged"));
    }
    const fs::path longest = path.parent_path() / std::string(255, 'n');
    ASSERT_TRUE(write_file(longest, "{"));
    EXPECT_NE(load_settings(longest).problem, "");
    EXPECT_FALSE(fs::exists(longest)) << "else the next save would replace it";
    EXPECT_EQ(read_file(path.parent_path() / std::string(247, 'n').append(".damaged")).value(), "{");
    ASSERT_TRUE(write_file(path, R"({"exposure": 99, "light_samples": "many", "sensitivity": 2.5, "unknown": [1],
                                     "bindings": {"use": "no such key", "run": "R", "fly": "X"}})"));
    const LoadedSettings loaded = load_settings(path);
    EXPECT_NE(loaded.problem, "");
    EXPECT_EQ(loaded.settings.exposure, 0.0f) << "out of range";
    EXPECT_EQ(loaded.settings.sensitivity, 2.5f) << "what is valid is taken";
    EXPECT_EQ(loaded.settings.bindings[std::size_t(Action::use)], 'E');
    EXPECT_EQ(loaded.settings.bindings[std::size_t(Action::run)], 'R');
}

TEST_F(DemoSettingsTest, NamesOfEarlierVersionsAreStillRead) {
    ASSERT_TRUE(save_settings(path, DemoSettings())); // creates the folder
    ASSERT_TRUE(write_file(path, R"({"letter_scale": 1.5})"));
    EXPECT_EQ(load_settings(path).settings.ui_scale, 1.5f);
    ASSERT_TRUE(write_file(path, R"({"letter_scale": 1.5, "ui_scale": 2.0})"));
    EXPECT_EQ(load_settings(path).settings.ui_scale, 2.0f) << "the present name wins";
}

TEST_F(DemoSettingsTest, PresetsDoMoreAndMoreWork) {
    DemoSettings before, settings;
    settings.preset = before.preset = Preset::software;
    apply_preset(before);
    for (std::uint32_t preset = 1; preset <= std::uint32_t(Preset::ultra); ++preset) {
        settings.preset = Preset(preset);
        apply_preset(settings);
        EXPECT_GE(settings.render_scale, before.render_scale);
        EXPECT_GT(settings.light_samples, before.light_samples);
        EXPECT_TRUE(validate(DemoSettings::description(), &settings));
        const gi::Settings lighting = lighting_of(settings);
        EXPECT_TRUE(lighting.validate());
        EXPECT_EQ(lighting.lights, settings.light_samples);
        EXPECT_EQ(lighting.get("movers") == "prt", settings.transfer && has_transfer());
        const gi::Settings first = lighting_of(first_light(settings));
        EXPECT_LT(first.lights, lighting.lights);
        EXPECT_GT(lighting.baked_samples, 0u);
        EXPECT_EQ(first.baked_samples, 0u) << "it soon gives way to all of the light";
        EXPECT_TRUE(settings.transfer || !before.transfer);
        before = settings;
    }
}

TEST_F(DemoSettingsTest, PresetsReflectAsOftenAsThePathTracer) {
    DemoSettings settings;
    for (std::uint32_t preset = 0; preset <= std::uint32_t(Preset::ultra); ++preset) {
        settings.preset = Preset(preset);
        apply_preset(settings);
        EXPECT_GE(lighting_of(settings).bounces, gi::reference::ReferenceSettings{}.bounces) << preset;
    }
}

TEST_F(DemoSettingsTest, HaveNoPlaceWithoutAHome) {
    const auto value_of = [](const char* name) {
        const char* value = std::getenv(name);
        return value != nullptr ? std::optional<std::string>(value) : std::nullopt;
    };
    const auto put_back = [](const char* name, const std::optional<std::string>& value) {
        value ? setenv(name, value->c_str(), 1) : unsetenv(name);
    };
    const auto home = value_of("HOME"), config = value_of("XDG_CONFIG_HOME");
    unsetenv("XDG_CONFIG_HOME");
    setenv("HOME", "/users/someone", 1);
    EXPECT_EQ(settings_path(), "/users/someone/.config/sunfleck/demo.json");
    for (const char* nowhere : {"", "relative"}) {
        setenv("HOME", nowhere, 1);
        EXPECT_TRUE(settings_path().empty()) << nowhere;
    }
    unsetenv("HOME");
    EXPECT_TRUE(settings_path().empty());
    setenv("XDG_CONFIG_HOME", "/elsewhere", 1);
    EXPECT_EQ(settings_path(), "/elsewhere/sunfleck/demo.json");
    put_back("HOME", home);
    put_back("XDG_CONFIG_HOME", config);
}

TEST(Menu, SettingsAndHelpLeadBackToWhereTheyWereOpened) {
    for (const Screen from : {Screen::title, Screen::playing, Screen::paused})
        for (const Screen to : {Screen::help, Screen::settings}) {
            Menu menu;
            menu.show(from);
            menu.show(to);
            EXPECT_EQ(menu.screen(), to);
            menu.back();
            EXPECT_EQ(menu.screen(), from);
        }
}

TEST(RecordingWriter, KeepsTheFileUpToDate) {
    const fs::path path = fs::path(testing::TempDir()) / ("sunfleck_recording_" + std::to_string(getpid()));
    const auto steps_in_file = [&] {
        const auto steps = simulation::read_recording(path);
        return steps ? steps->size() : 0;
    };
    std::vector<simulation::StepInput> given;
    {
        simulation::RecordingWriter writer(path);
        for (std::int32_t i = 0; i < 100; ++i) {
            given.push_back({100, 0, i, 0, 0});
            writer.add(given.back());
        }
        writer.save_if_due(); // the first write is due at once
        for (int i = 0; i < 500 && steps_in_file() == 0; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        EXPECT_EQ(steps_in_file(), 100u) << "before finish";
        given.push_back({});
        writer.add(given.back());
        ASSERT_TRUE(writer.finish());
        EXPECT_EQ(simulation::read_recording(path).value(), given);
        writer.clear();
        ASSERT_TRUE(writer.finish());
        EXPECT_EQ(steps_in_file(), 0u);
    }
    EXPECT_FALSE(simulation::RecordingWriter("/no/such/folder/walk.txt").finish());
    EXPECT_TRUE(simulation::RecordingWriter("").finish()) << "nothing is recorded";
    fs::remove(path);
}

// What begins at a checkpoint is a file of its own kind, which programs that know levels alone refuse.
TEST(RecordingWriter, MayBeginWithASavedGame) {
    const fs::path path = fs::path(testing::TempDir()) / ("sunfleck_start_" + std::to_string(getpid()));
    simulation::RecordingWriter writer(path);
    writer.add({1, 2, 3, 4, 0});
    writer.clear("{ \"a saved\": \"game\" }");
    writer.add({100, 0, 5, 0, 0});
    ASSERT_TRUE(writer.finish());
    const auto read = simulation::read_recording_and_start(path);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->start, "{ \"a saved\": \"game\" }");
    EXPECT_EQ(read->steps, (std::vector<simulation::StepInput>{{100, 0, 5, 0, 0}}));
    const auto alone = simulation::read_recording(path);
    ASSERT_FALSE(alone);
    EXPECT_NE(alone.error().message.find("checkpoint"), std::string::npos) << alone.error().message;
    ASSERT_TRUE(write_file(path, "sunfleck_input 2\n1 0 0 0 0 0\n"));
    EXPECT_FALSE(simulation::read_recording_and_start(path)) << "without its start";
    fs::remove(path);
}

TEST(HitchLog, NamesWhatTookLong) {
    HitchLog log;
    viewer::FrameStatistics usual, long_one;
    usual.gpu_ms = {{"baked light", 2.0}, {"g-buffer", 5.0}};
    usual.cpu_ms = {{"visibility", 3.0}};
    long_one = usual;
    long_one.gpu_ms["baked light"] = 14.0;
    for (int i = 0; i < 40; ++i)
        EXPECT_EQ(log.add(10.0, usual), "");
    EXPECT_EQ(log.add(19.0, long_one), "") << "not twice as long";
    const std::string line = log.add(25.0, long_one);
    EXPECT_EQ(line, "frame 42 took 25 ms, 2.5 times the median of the 30 before: baked light +12 ms, elsewhere +3 ms");
    EXPECT_NE(
        log.summary().find("42 frames: 99 % below 2.4 times the median of the 30 before, the longest 2.5, 1 above"),
        std::string::npos)
        << log.summary();
}

TEST(KeyNames, GoBothWays) {
    for (app::Key key = 0; key < app::key_count; ++key)
        EXPECT_EQ(app::key_by_name(app::key_name(key)), key) << app::key_name(key);
    EXPECT_EQ(app::key_by_name("no such key"), app::no_key);
}

TEST(Controls, HandOnWhatIsHeldAndAllOfTheLook) {
    DemoSettings settings;
    Controls controls;
    app::InputState input;
    input.captured = true;
    input.keys['W'] = input.keys['D'] = true;
    input.mouse_motion = vec2(100.0f, -40.0f);
    controls.take(input, settings, 0.016, true);
    const simulation::StepInput first = controls.next_step(), second = controls.next_step();
    EXPECT_EQ(first.forward, 100);
    EXPECT_EQ(first.right, 100);
    EXPECT_EQ(first.turn, -2200); // to the right
    EXPECT_EQ(first.look_up, 880);
    EXPECT_EQ(second.turn, 0) << "the motion is handed on once";
    EXPECT_EQ(second.forward, 100);
}

// What a view is drawn with before a step takes it is all that the pointer did, and the step takes all of it once.
TEST(Controls, DrawWithMotionThatCameAfterThePoll) {
    DemoSettings settings;
    settings.invert_look = true;
    Controls controls;
    app::InputState input;
    input.mouse_motion = vec2(10.0f, 0.0f);
    controls.take(input, settings, 0.016, true);
    controls.turn(vec2(30.0f, 20.0f), settings);
    EXPECT_NEAR(controls.pending_look().x, -0.088f, 1e-6f);
    EXPECT_NEAR(controls.pending_look().y, 0.044f, 1e-6f);
    const simulation::StepInput step = controls.next_step();
    EXPECT_EQ(step.turn, -880);
    EXPECT_EQ(step.look_up, 440);
    EXPECT_EQ(controls.pending_look(), vec2(0.0f));
}

TEST(Controls, MissNoKeyAndKeepStillWhilePaused) {
    DemoSettings settings;
    Controls controls;
    app::InputState input;
    // A key that went down and up between two polls still counts, once.
    input.went_down = {'E'};
    controls.take(input, settings, 0.016, true);
    EXPECT_EQ(controls.next_step().buttons, std::uint32_t(simulation::button_use));
    EXPECT_EQ(controls.next_step().buttons, 0u);
    // Paused, nothing is done.
    input.keys['W'] = true;
    controls.take(input, settings, 0.016, false);
    EXPECT_EQ(controls.next_step(), simulation::StepInput{});
    // The gamepad's stick: half way is slower, and the dead zone was taken off before.
    input = {};
    input.gamepad.present = true;
    input.gamepad.left = vec2(0.0f, -0.5f);
    input.gamepad.buttons = 1u << 4;
    controls.take(input, settings, 0.016, true);
    EXPECT_EQ(controls.next_step().forward, 50);
    EXPECT_EQ(controls.next_step().buttons, std::uint32_t(simulation::button_run));
}

TEST(Controls, KeysTurnTheViewAtOneRate) {
    const DemoSettings settings;
    for (const int polls : {15, 60}) {
        Controls controls;
        app::InputState input;
        input.keys[app::key_left] = input.keys[app::key_up] = true;
        simulation::StepInput turned;
        for (int i = 0; i < polls; ++i) {
            controls.take(input, settings, 0.5 / polls, true);
            const simulation::StepInput step = controls.next_step();
            turned.turn += step.turn;
            turned.look_up += step.look_up;
        }
        EXPECT_NEAR(turned.turn, 7500, 1) << polls << " polls in half a second";
        EXPECT_NEAR(turned.look_up, 7500, 1);
    }
}

TEST(Controls, WhatTookAMenusButtonUsesNothing) {
    const DemoSettings settings;
    Controls controls;
    app::InputState down, up;
    down.gamepad.present = up.gamepad.present = true;
    down.gamepad.buttons = 1;                    // A
    controls.take(down, settings, 0.016, false); // takes "Resume"
    controls.take(down, settings, 0.016, true);
    EXPECT_EQ(controls.next_step().buttons, 0u);
    controls.take(up, settings, 0.016, true);
    controls.take(down, settings, 0.016, true);
    EXPECT_EQ(controls.next_step().buttons, std::uint32_t(simulation::button_use));
}

TEST(Prompts, NameWhatIsInThePlayersHands) {
    DemoSettings settings;
    settings.bindings[std::size_t(Action::use)] = 'R';
    using simulation::Interaction;
    EXPECT_EQ(prompt_text(settings, Interaction::take, false, false), "R  take the lantern");
    EXPECT_EQ(prompt_text(settings, Interaction::take, false, true), "A  take the lantern");
    EXPECT_EQ(prompt_text(settings, Interaction::open, true, true), "A  open");
    EXPECT_EQ(prompt_text(settings, Interaction::none, true, true), "X  put down the lantern");
    EXPECT_EQ(prompt_text(settings, Interaction::none, false, true), "");
    EXPECT_STRNE(help_text(true), help_text(false));
}

TEST(Controls, LetGoOfWhatAVanishedGamepadHeld) {
    const DemoSettings settings;
    Controls controls;
    app::InputState with_pad, without;
    with_pad.gamepad.present = true;
    controls.take(with_pad, settings, 0.016, true);
    controls.take(without, settings, 0.016, true);
    EXPECT_FALSE(controls.lost_gamepad()) << "nobody played with it";
    with_pad.gamepad.left = vec2(0.0f, -1.0f);
    with_pad.gamepad.buttons = 1u << 4;
    controls.take(with_pad, settings, 0.016, true);
    EXPECT_EQ(controls.next_step().forward, 100);
    controls.take(without, settings, 0.016, true);
    EXPECT_TRUE(controls.lost_gamepad());
    EXPECT_EQ(controls.next_step(), simulation::StepInput{});
    controls.take(without, settings, 0.016, true);
    EXPECT_FALSE(controls.lost_gamepad()) << "it is said once";
    // Who has gone on with the keyboard meanwhile misses nothing.
    controls.take(with_pad, settings, 0.016, true);
    app::InputState keys = with_pad;
    keys.gamepad.left = vec2(0.0f);
    keys.gamepad.buttons = 0;
    keys.went_down = {'W'};
    controls.take(keys, settings, 0.016, true);
    controls.take(without, settings, 0.016, true);
    EXPECT_FALSE(controls.lost_gamepad());
}

} // namespace
} // namespace sunfleck::demo
