// The game in a real window with real keys, from outside: each step waits for what it should bring about, never for a
// time.
#include "engine/core/file.h"
#include "engine/io/scene_file.h"
#include "game_demo/game/saved_game.h"
#include "game_demo/game/world_hashes.h"
#include "tests/support/command_line.h"
#include "tests/support/driven_display.h"
#include "tests/support/key_solver.h"
#include "tests/support/test_size.h"
#include "viewer/built_in_scenes.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

using tests::CommandLine, tests::DrivenDisplay;

// The demo on a display of its own, and the state that it writes.
class DrivenGame {
public:
    explicit DrivenGame(fs::path folder) : folder_(std::move(folder)), display_(folder_ / "display") {}
    ~DrivenGame() { DrivenDisplay::end(process_, SIGTERM); }
    DrivenGame(const DrivenGame&) = delete;
    DrivenGame& operator=(const DrivenGame&) = delete;

    // `sound`: OpenAL's drivers.
    bool start(const std::string& sound) {
        fs::remove(state_file());
        process_ = display_.launch({"env", "XDG_CONFIG_HOME=" + folder_.string(), "XDG_DATA_HOME=" + folder_.string(),
                                    "ALSOFT_DRIVERS=" + sound, SUNFLECK_DEMO, "--scene", "lantern_game", "--size",
                                    "192x108", "--settings", (folder_ / "settings.json").string(), "--state",
                                    state_file().string(), "--record", (folder_ / "walk.txt").string()},
                                   folder_ / "log");
        if (!shows("title", 120.0))
            return false;
        window_ = display_.window("Lantern House$");
        return display_.focus(window_);
    }

    nlohmann::json state() const {
        const auto text = read_file(state_file());
        const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
        return json.is_object() ? json : nlohmann::json::object();
    }
    std::string value(const char* name) const { return state().value(name, std::string()); }
    float place(std::size_t axis) const {
        const nlohmann::json now = state();
        return now.contains("place") ? now["place"][axis].get<float>() : 0.0f;
    }
    bool shows(const std::string& screen, double seconds = 30.0) const {
        return DrivenDisplay::wait_until([&] { return value("screen") == screen; }, seconds);
    }

    // Presses until the condition holds. A slow program may take a while: the key comes once more only after seconds.
    bool press_until(const std::string& key, const std::function<bool()>& condition) const {
        for (int round = 0; round < 12; ++round) {
            display_.run("xdotool key " + key);
            if (DrivenDisplay::wait_until(condition, 4.0))
                return true;
        }
        return false;
    }
    bool hold_until(const std::string& key, const std::function<bool()>& condition, double seconds = 60.0) const {
        display_.run("xdotool keydown " + key);
        const bool came = DrivenDisplay::wait_until(condition, seconds);
        display_.run("xdotool keyup " + key);
        return came;
    }
    // Crouched, and to and fro, until the person stands between both.
    bool strafe_between(float low, float high) const {
        display_.run("xdotool keydown c");
        bool inside = false;
        for (int round = 0; round < 10 && !inside; ++round) {
            const float x = place(0);
            if (x > high)
                hold_until(
                    "a", [&] { return place(0) < high; }, 20.0);
            else if (x < low)
                hold_until(
                    "d", [&] { return place(0) > low; }, 20.0);
            rests();
            inside = place(0) >= low && place(0) <= high;
        }
        display_.run("xdotool keyup c");
        return inside;
    }
    // The person has come to a stop: steps went by, and they are where they were, or look where they did ("yaw").
    bool rests(const char* what = "place") const {
        nlohmann::json before = state();
        return DrivenDisplay::wait_until([&] {
            const nlohmann::json now = state();
            if (now.value("steps", 0) < before.value("steps", 0) + 12)
                return false;
            return std::exchange(before, now)[what] == now[what];
        });
    }
    // From the paused game: the menu's entry of this name is selected, then taken. The menu selects its first entry a
    // frame after it appears, which is not what a key did.
    bool take(const std::string& entry) const {
        std::string selected;
        const auto changes = [&] {
            const std::string before = std::exchange(selected, value("selected"));
            return !selected.empty() && selected != before;
        };
        DrivenDisplay::wait_until(changes, 10.0);
        for (int round = 0; round < 16 && selected != entry; ++round) {
            display_.run("xdotool key Down");
            DrivenDisplay::wait_until(changes, 3.0);
        }
        if (selected != entry)
            return false;
        display_.run("xdotool key Return");
        return true;
    }

    int end(int signal) { return DrivenDisplay::end(std::exchange(process_, -1), signal); }
    tests::Outcome run(const std::string& command) const { return display_.run(command); }
    const std::string& window() const { return window_; }
    bool focus() const { return display_.focus(window_); }
    bool minimise() const { return display_.minimise(window_); }
    std::string log() const {
        const auto text = read_file(folder_ / "log");
        return text ? *text : std::string();
    }

private:
    fs::path state_file() const { return folder_ / "state.json"; }

    fs::path folder_;
    DrivenDisplay display_;
    pid_t process_ = -1;
    std::string window_;
};

class GameWindow : public CommandLine {
protected:
    void SetUp() override {
        CommandLine::SetUp();
        if (!DrivenDisplay::possible())
            GTEST_SKIP() << "Xvfb, xdotool and openbox are not installed";
    }
    fs::path checkpoint() const { return folder / "sunfleck/lantern_game.checkpoint"; }
    // What the window kept when it was left is where its recording leads, played without a window.
    void expect_that_the_recording_leads_there() const {
        const tests::Outcome played = tests::shell("cd " + folder.string() +
                                                   " && " SUNFLECK_DEMO " --headless --simulate --scene lantern_game "
                                                   "--input walk.txt -o played 2>&1");
        ASSERT_EQ(played.status, 0) << played.output;
        const auto statistics = nlohmann::json::parse(read_file(folder / "played/stats.json").value());
        ecs::Registry registry;
        scene::MeshStore meshes;
        scene::TextureStore textures;
        scene::register_components(registry);
        ASSERT_TRUE(io::load_scene(viewer::find_scene("lantern_game").value(), registry, meshes, textures, {}));
        const auto kept = demo::GameWorld::create(registry, meshes, &textures, {}).value();
        ASSERT_TRUE(demo::load_game(*kept, "lantern_game", read_file(checkpoint()).value()));
        demo::WorldHashes hashes;
        hashes.add(kept->simulation(), registry);
        EXPECT_EQ(statistics["world_hash"], hashes.of_world());
        EXPECT_GT(statistics["steps"], 0);
    }
};

// From the title through the first door, whose room is a checkpoint.
void walk_to_the_corner(const DrivenGame& game) {
    bool heard = false; // of the door, whose subtitle is there for seconds
    const auto listen = [&] {
        for (const auto& line : game.state().value("subtitles", nlohmann::json::array()))
            heard = heard || line.get<std::string>().find("porch door slides") != std::string::npos;
        return heard;
    };
    ASSERT_TRUE(game.press_until("Return", [&] { return game.value("screen") == "playing"; }));
    EXPECT_TRUE(DrivenDisplay::wait_until([&] { return game.value("area") == "The porch"; })) << game.state();
    EXPECT_TRUE(DrivenDisplay::wait_until([&] { return game.state().value("hint", false); }))
        << "the first hint says what the game is about";
    ASSERT_TRUE(game.strafe_between(0.75f, 2.5f)) << game.state();
    ASSERT_TRUE(game.hold_until("w", [&] { return listen() && game.place(2) < 7.3f; })) << game.state();
    ASSERT_TRUE(game.strafe_between(-0.2f, 0.2f)) << game.state();
    ASSERT_TRUE(game.hold_until("w", [&] { return game.value("area") == "The corner"; })) << game.state();
}

// Paused, nothing moves; so it does when the window loses the focus.
void pause_and_lose_focus(const DrivenGame& game) {
    ASSERT_TRUE(game.press_until("Escape", [&] { return game.value("screen") == "paused"; }));
    ASSERT_TRUE(game.press_until("Return", [&] { return game.value("screen") == "playing"; }));
    ASSERT_TRUE(game.minimise());
    EXPECT_TRUE(game.shows("paused"));
    ASSERT_TRUE(game.focus()) << game.state();
    const auto steps = game.state().value("steps", std::uint64_t(0));
    ASSERT_TRUE(game.press_until("Return", [&] { return game.value("screen") == "playing"; }));
    EXPECT_TRUE(DrivenDisplay::wait_until([&] { return game.state().value("steps", std::uint64_t(0)) > steps; }));
}

// What the paused game offers besides: a hint, and the room as it was at its entry.
void ask_for_a_hint_and_reset(const DrivenGame& game) {
    const auto choose = [&](const char* entry) {
        ASSERT_TRUE(game.press_until("Escape", [&] { return game.value("screen") == "paused"; }));
        ASSERT_TRUE(game.take(entry)) << entry << " " << game.state();
        EXPECT_TRUE(game.shows("playing"));
        EXPECT_TRUE(game.rests()) << game.state();
    };
    const auto hint = [&] { return game.state().value("hint", false); };
    EXPECT_FALSE(hint()) << "whoever goes on knows what the game is about";
    ASSERT_NO_FATAL_FAILURE(choose("Hint"));
    EXPECT_TRUE(hint()) << game.state();
    ASSERT_NO_FATAL_FAILURE(choose("Reset this room"));
    const float entry = game.place(2);
    ASSERT_TRUE(game.hold_until("w", [&] { return std::abs(game.place(2) - entry) > 0.5f; })) << game.state();
    ASSERT_NO_FATAL_FAILURE(choose("Reset this room"));
    EXPECT_NEAR(game.place(2), entry, 0.05f) << game.state();
}

TEST_F(GameWindow, IsPlayedPausedLeftAndContinued) {
    ASSERT_TRUE(write_file(folder / "settings.json", "{\"subtitles\": true, \"preset\": \"software\"}\n"));
    DrivenGame game(folder);
    ASSERT_TRUE(game.start("none")) << game.log();
    EXPECT_EQ(game.value("sound_device"), "") << "there is none, and the game does not mind";
    EXPECT_FALSE(game.state().value("can_resume", true));
    walk_to_the_corner(game);
    ASSERT_TRUE(DrivenDisplay::wait_until([&] { return game.state().value("can_resume", false); }));
    EXPECT_TRUE(fs::exists(checkpoint()));
    pause_and_lose_focus(game);
    ASSERT_TRUE(game.press_until("Escape", [&] { return game.value("screen") == "paused"; }));
    ASSERT_TRUE(game.take("Quit")) << game.state();
    EXPECT_EQ(game.end(0), 0) << game.log();
    expect_that_the_recording_leads_there();

    ASSERT_TRUE(game.start("null")) << game.log();
    EXPECT_NE(game.value("sound_device"), "");
    EXPECT_TRUE(game.state().value("can_resume", false));
    ASSERT_TRUE(game.press_until("Return", [&] { return game.value("screen") == "playing"; }));
    EXPECT_EQ(game.value("area"), "The corner") << "Enter goes on at the checkpoint";
    EXPECT_LT(game.place(2), 6.24f);

    // Bounced light that was switched off comes back with the checkpoint.
    const auto bounced = [&] { return game.state().value("bounced_light", true); };
    EXPECT_TRUE(bounced());
    ASSERT_TRUE(game.press_until("l", [&] { return !bounced(); }));
    ASSERT_TRUE(game.press_until("Escape", [&] { return game.value("screen") == "paused"; }));
    ASSERT_TRUE(game.take("Last checkpoint")) << game.state();
    EXPECT_TRUE(game.shows("playing"));
    EXPECT_TRUE(DrivenDisplay::wait_until(bounced)) << game.state();
    ASSERT_NO_FATAL_FAILURE(ask_for_a_hint_and_reset(game));

    // Whoever quits within a room goes on where they stood, and looked by keys alone.
    const auto yaw = [&] { return game.state().value("yaw", 0.0); };
    const double before = yaw();
    ASSERT_TRUE(game.hold_until("Left", [&] { return std::abs(yaw() - before) > 0.3; })) << game.state();
    EXPECT_TRUE(game.rests("yaw")) << game.state(); // after the last frame that the key was down in
    const double turned = yaw();
    EXPECT_EQ(game.end(SIGINT), 128 + SIGINT) << game.log();
    expect_that_the_recording_leads_there(); // from the checkpoint on
    ASSERT_TRUE(game.start("none")) << game.log();
    ASSERT_TRUE(game.press_until("Return", [&] { return game.value("screen") == "playing"; }));
    EXPECT_EQ(game.value("area"), "The corner");
    EXPECT_NEAR(yaw(), turned, 1e-3);
    EXPECT_EQ(game.end(SIGINT), 128 + SIGINT) << game.log();
}

// Presses what the solution would do next, by the state of the game in the window.
class SolvedByKeys {
public:
    explicit SolvedByKeys(const DrivenGame& game) : game_(game) {}
    ~SolvedByKeys() { game_.run("xdotool keyup w keyup c"); }
    SolvedByKeys(const SolvedByKeys&) = delete;
    SolvedByKeys& operator=(const SolvedByKeys&) = delete;

    // After each frame. False: the solution does not work.
    bool act() {
        const auto motion = solver_.next(game_.state());
        if (!motion)
            return true;
        std::string keys =
            "xdotool mousemove_relative -- " + std::to_string(motion->right) + " " + std::to_string(motion->down);
        if (std::exchange(walks_, motion->walks) != motion->walks)
            keys += walks_ ? " keydown w" : " keyup w";
        if (std::exchange(slowly_, motion->slowly) != motion->slowly)
            keys += slowly_ ? " keydown c" : " keyup c";
        if (motion->uses)
            keys += " key e";
        game_.run(keys);
        return solver_.problem().empty();
    }
    const std::string& problem() const { return solver_.problem(); }

private:
    const DrivenGame& game_;
    tests::KeySolver solver_;
    bool walks_ = false, slowly_ = false;
};

// Six minutes: the long size only, whose short relative is above.
TEST_F(GameWindow, IsPlayedToItsEnd) {
    if (!tests::long_size())
        GTEST_SKIP() << "takes as long as a person does";
    DrivenGame game(folder);
    ASSERT_TRUE(game.start("null")) << game.log();
    ASSERT_TRUE(game.press_until("Return", [&] { return game.value("screen") == "playing"; }));
    SolvedByKeys solver(game);
    bool works = true;
    const auto ended = [&] {
        works = works && solver.act();
        return !works || game.value("screen") == "finished";
    };
    EXPECT_TRUE(DrivenDisplay::wait_until(ended, 900.0)) << game.state();
    EXPECT_EQ(solver.problem(), "") << game.state();
    EXPECT_EQ(game.value("screen"), "finished");
    EXPECT_TRUE(DrivenDisplay::wait_until([&] { return game.value("selected") == "Play once more"; })) << game.state();
    ASSERT_TRUE(game.press_until("Return", [&] { return game.value("screen") == "playing"; }));
    EXPECT_EQ(game.value("area"), "The porch");
}

TEST_F(GameWindow, AMissingLevelIsOneMessage) {
    const DrivenDisplay display(folder);
    expect_clear_error(
        display.run("XDG_CONFIG_HOME=" + folder.string() + " " SUNFLECK_DEMO " --scene no_such_level.glb"),
        {"error: ", "no_such_level.glb"});
}

} // namespace
} // namespace sunfleck
