// The demo from outside: played back without a window, and used in one.
#include "engine/core/file.h"
#include "engine/simulation/input_recording.h"
#include "tests/support/command_line.h"
#include "tests/support/test_size.h"

#include <nlohmann/json.hpp>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

using tests::CommandLine, tests::Outcome, tests::shell;

// The same recorded input gives the same world and the same pictures, whatever the number of threads.
TEST_F(CommandLine, TheDemoPlaysBackTheSameEveryTime) {
    const std::string in_folder = "cd " + folder.string() + " && ";
    const int frames = tests::by_size(8, 30);
    const std::string common =
        " --headless --frames " + std::to_string(frames) + " --steps-per-frame 6 --size 96x54 --pictures 2 ";
    const Outcome first = shell(in_folder + SUNFLECK_DEMO + common + "-o first --record walk.txt --validation");
    ASSERT_EQ(first.status, 0) << first.output;
    // How far it is, and one line in the end; nothing of the validation layers.
    EXPECT_NE(first.output.find("playing: 50 %"), std::string::npos) << first.output;
    EXPECT_NE(first.output.find(std::to_string(frames) + " frames, "), std::string::npos) << first.output;
    EXPECT_NE(first.output.find("; 2 pictures and stats.json in 'first'\n"), std::string::npos) << first.output;
    EXPECT_EQ(first.output.find("warning"), std::string::npos) << first.output;
    EXPECT_EQ(first.output.find("error"), std::string::npos) << first.output;
    const Outcome second = shell(in_folder + "LP_NUM_THREADS=1 taskset -c 0 " + SUNFLECK_DEMO + common +
                                 "-o second --input walk.txt --each-frame");
    ASSERT_EQ(second.status, 0) << second.output;
    const auto a = nlohmann::json::parse(read_file(folder / "first/stats.json").value());
    const auto b = nlohmann::json::parse(read_file(folder / "second/stats.json").value());
    EXPECT_EQ(a["steps"], frames * 6);
    EXPECT_EQ(a["world_hash"], b["world_hash"]);
    for (const char* key : {"frame_ms", "cpu_ms", "gpu_ms", "counters", "preset"})
        EXPECT_TRUE(a.contains(key)) << key;
    EXPECT_FALSE(a.contains("each_frame"));
    EXPECT_EQ(b["each_frame"]["frame_ms"].size(), std::size_t(frames));
    EXPECT_EQ(b["each_frame"]["gpu_ms"]["g-buffer"].size(), std::size_t(frames));
    EXPECT_FALSE(b["each_frame"]["cpu_ms"].empty());
    EXPECT_EQ(a["counters"]["player_rescued"], 0);
    int pictures = 0;
    for (const auto& entry : fs::directory_iterator(folder / "first"))
        if (entry.path().extension() == ".png") {
            ++pictures;
            EXPECT_EQ(read_file(entry.path()).value(), read_file(folder / "second" / entry.path().filename()).value());
        }
    EXPECT_EQ(pictures, 2);
}

TEST_F(CommandLine, TheDemosBadArgumentsGetOneMessage) {
    const std::string in_folder = "cd " + folder.string() + " && " SUNFLECK_DEMO " ";
    ASSERT_TRUE(write_file(folder / "bad.txt", "sunfleck_input 1\n1 2 3\n"));
    expect_clear_error(shell(in_folder + "--headless"), {"-o DIR"});
    expect_clear_error(shell(in_folder + "--headless -o out --input bad.txt"), {"bad.txt", "line 2"});
    expect_clear_error(shell(in_folder + "--headless -o out --input none.txt"), {"none.txt"});
    expect_clear_error(shell(in_folder + "--headless -o out --scene none.glb"), {"none.glb"});
    expect_clear_error(shell(in_folder + "--headless -o out --size 0x9"), {"--size"});
    expect_clear_error(shell(in_folder + "--headless -o out --scene lantern_huose"),
                       {"did you mean 'lantern_house'?", "cornell"});
    expect_clear_error(shell(in_folder + "--headless -o bad.txt/out"), {"bad.txt/out"});
    expect_clear_error(shell("unset DISPLAY; " + in_folder), {"--headless"});
}

// What a user does in the window.
std::string window_script(const fs::path& folder) {
    return "cd " + folder.string() +
           "\nexport XDG_CONFIG_HOME=$PWD/config\n"
           "for i in $(seq 50); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.2; done\n"
           "if command -v openbox >/dev/null; then openbox & fi\n" SUNFLECK_DEMO " --validation --size 192x108 & P=$!\n"
           "for i in $(seq 400); do W=$(xdotool search --name 'Lantern House$' | head -1); [ -n \"$W\" ] && break; "
           "sleep "
           "0.2; done\n"
           "sleep 2; xdotool windowfocus $W; sleep 0.5; xdotool key Return; sleep 4\n"
           "xdotool keydown w; sleep 1; xdotool keyup w; xdotool mousemove_relative 40 10\n"
           "for k in l t e c f f l; do xdotool key $k; sleep 0.4; done\n"
           "xdotool windowsize $W 300 300; sleep 0.7; xdotool windowsize $W 211 400; sleep 0.7\n"
           "command -v openbox >/dev/null && { xdotool windowminimize $W; sleep 1; xdotool windowmap $W; sleep 1; "
           "xdotool "
           "windowfocus $W; sleep 0.5; xdotool key Return; sleep 1; }\n"
           // A machine that is slow may still show the menu, which Return leaves; in the game it does nothing.
           "for i in $(seq 30); do xdotool key p; sleep 0.5; [ -f sunfleck_0001.png ] && break; [ $((i % 6)) = 0 ] && "
           "{ xdotool windowfocus $W; xdotool key Return; sleep 1; }; done\n"
           "xdotool key Escape; sleep 0.7; for k in Down Return; do xdotool key $k; sleep 0.5; done\n" // settings
           // Out of the settings and down to the last entry. Where a slow machine lost a key, Escape leads from the
           // menu to the game or from the game to the menu, and one of the next rounds finds the entry.
           "for round in 1 2 3 4; do kill -0 $P 2>/dev/null || break; xdotool key Escape; sleep 0.7\n"
           "for k in Down Down Down Down; do xdotool key $k; sleep 0.4; done; xdotool key Return\n"
           "for i in $(seq 20); do kill -0 $P 2>/dev/null || break; sleep 0.5; done; done\n"
           "kill -0 $P 2>/dev/null && { echo 'did not quit'; kill $P; }\n"
           "wait $P\n";
}

// The window under a virtual display: title, a walk, lights, pause, settings, resizing, a picture, a polite end.
TEST_F(CommandLine, TheDemoRunsInAWindow) {
    if (shell("command -v xvfb-run && command -v xdotool").status != 0)
        GTEST_SKIP() << "xvfb and xdotool are not installed";
    ASSERT_TRUE(write_file(folder / "drive.sh", window_script(folder)));
    // Without -noreset the server starts anew whenever its last client leaves, and turns away who comes just then.
    const Outcome outcome =
        shell("timeout 240 xvfb-run -a -s '-screen 0 800x600x24 -noreset' bash " + (folder / "drive.sh").string());
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_TRUE(fs::exists(folder / "sunfleck_0001.png")) << outcome.output;
    EXPECT_TRUE(fs::exists(folder / "config/sunfleck/demo.json")) << outcome.output;
}

// Help leads back to the game, sizes of the window do not turn the view, and a kill loses a second of the recording at
// most.
TEST_F(CommandLine, AKilledWindowLeavesItsRecording) {
    if (shell("command -v xvfb-run && command -v xdotool").status != 0)
        GTEST_SKIP() << "xvfb and xdotool are not installed";
    const std::string script =
        "cd " + folder.string() +
        "\nexport XDG_CONFIG_HOME=$PWD/config\n"
        "for i in $(seq 50); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.2; done\n" SUNFLECK_DEMO
        " --scene four_pillars --size 192x108 --record walk.txt & P=$!\n"
        "for i in $(seq 400); do W=$(xdotool search --name 'Lantern House$' | head -1); [ -n \"$W\" ] && break; "
        "sleep 0.2; done\n"
        "xdotool windowfocus $W; xdotool mousemove --window $W 60 50\n"
        // The recording begins when the game does, which Return starts once the window has taken the focus.
        "for i in $(seq 60); do [ -f walk.txt ] && grep -q '^[0-9]' walk.txt && break; xdotool key Return; sleep 0.5; "
        "done\n"
        "for size in '300 300' '211 400' '640 200' '192 108'; do xdotool windowsize $W $size; sleep 0.4; done\n"
        // Both may come within one slow frame: they act in their order.
        "xdotool key h Escape; sleep 0.5\n"
        "steps() { awk '/^[0-9]/ { n += $1 } END { print n }' walk.txt; }\n"
        // Writing takes a fiftieth of the time at most: on a slow disk, many seconds lie between two writes.
        "before=$(steps); xdotool keydown w; for i in $(seq 200); do grep -q '^[0-9]* 100 ' walk.txt && break; sleep "
        "0.25; "
        "done\n"
        "kill -9 $P; wait $P 2>/dev/null; echo $before $(steps)\n";
    ASSERT_TRUE(write_file(folder / "drive.sh", script));
    const Outcome outcome =
        shell("timeout 120 xvfb-run -a -s '-screen 0 800x600x24 -noreset' bash " + (folder / "drive.sh").string());
    const auto steps = simulation::read_recording(folder / "walk.txt");
    ASSERT_TRUE(steps) << steps.error().message << outcome.output;
    bool walked = false;
    for (const simulation::StepInput& step : *steps) {
        EXPECT_EQ(step.turn, 0) << "no pointer moved";
        EXPECT_EQ(step.look_up, 0);
        walked = walked || step.forward == 100;
    }
    EXPECT_TRUE(walked) << "Escape leads from the help to the game, where W walks\n" << outcome.output;
}

} // namespace
} // namespace sunfleck
