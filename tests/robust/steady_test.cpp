// The demo's window under random use: nothing that one presses makes it stop, print or grow.
#include "engine/core/file.h"
#include "engine/core/random.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace sunfleck {
namespace {

using tests::Outcome, tests::shell;

// Keys, clicks, drags and sizes as xdotool's commands, by a seed.
std::string random_events(std::uint32_t seed, int count) {
    static const char* const keys[] = {"w", "a", "s", "d", "e",    "e",      "q",  "l",     "l",    "t",   "c",
                                       "h", "f", "p", "x", "Down", "Return", "Up", "Right", "Left", "Tab", "Escape"};
    RandomSequence random(SequenceKind::pseudo_random, seed, 0);
    const auto below = [&](int limit) { return int(random.next() * float(limit)); };
    const auto place = [&] { return std::to_string(below(320)) + " " + std::to_string(below(180)); };
    std::ostringstream script;
    for (int i = 0; i < count; ++i) {
        const int kind = below(10);
        const std::string key = keys[below(int(std::size(keys)))];
        if (kind < 4)
            script << "xdotool key " << key << "\n";
        else if (kind < 6)
            script << "xdotool keydown " << key << "; sleep 0.4; xdotool keyup " << key << "\n";
        else if (kind < 7)
            script << "xdotool mousemove_relative -- " << below(200) - 100 << " " << below(60) - 30 << "\n";
        else if (kind < 8)
            script << "xdotool mousemove --window $W " << place() << " click 1\n";
        else if (kind < 9)
            script << "xdotool mousemove --window $W " << place() << " mousedown 1 mousemove --window $W " << place()
                   << " mouseup 1\n";
        else
            script << "xdotool windowsize $W " << 200 + below(200) << " " << 120 + below(120) << "\n";
        script << "sleep 0.1; kill -0 $P 2>/dev/null || break\n";
        if (i % 10 == 0) // P in menus does nothing; away from the desktop the window takes the focus again
            script << "xdotool windowfocus $W\n";
        if (i % 20 == 19)
            script << "grep VmRSS /proc/$P/status >> memory\n";
    }
    return script.str();
}

// The most of the second half against the most of the first, which has seen all pages and sizes of the window by then.
void expect_flat(const std::filesystem::path& file, const std::string& log) {
    std::ifstream lines(file);
    std::vector<double> kilobytes;
    std::string name, unit;
    for (double size = 0.0; lines >> name >> size >> unit;)
        kilobytes.push_back(size);
    if (kilobytes.size() < 4)
        return; // it quit early
    const auto middle = kilobytes.begin() + std::ptrdiff_t(kilobytes.size() / 2);
    EXPECT_LT(*std::max_element(middle, kilobytes.end()), 1.15 * *std::max_element(kilobytes.begin(), middle)) << log;
}

// In the short size a quarter of a minute, in the long one a minute; ./run bench steady takes twenty.
TEST(SteadyWindow, RandomUseDoesNoHarm) {
    if (shell("command -v xvfb-run && command -v xdotool").status != 0)
        GTEST_SKIP() << "xvfb and xdotool are not installed";
    tests::Folder folder;
    const char* const seed_text = std::getenv("SUNFLECK_SEED");
    const std::uint32_t seed = seed_text != nullptr ? std::uint32_t(std::atoi(seed_text)) : 1u;
    const char* const count_text = std::getenv("SUNFLECK_EVENTS");
    const int count = count_text != nullptr ? std::atoi(count_text) : tests::by_size(60, 240);
    const std::string script =
        "cd '" + folder.path.string() +
        "'\nexport XDG_CONFIG_HOME=$PWD/config\n"
        "for i in $(seq 50); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.2; done\n" SUNFLECK_DEMO
        " --scene four_pillars --validation --size 320x180 > log 2>&1 & P=$!\n"
        "for i in $(seq 400); do W=$(xdotool search --name 'Lantern House$' | head -1); [ -n \"$W\" ] && break; "
        "sleep 0.2; done\n"
        "xdotool windowfocus $W; sleep 1; xdotool key Return; sleep 1\n"
        "for once in 1; do\n" +
        random_events(seed, count) +
        "done\n"
        // Quit by a menu is one of the events; else it is asked to end.
        "kill -TERM $P 2>/dev/null; for i in $(seq 100); do kill -0 $P 2>/dev/null || break; sleep 0.1; done\n"
        "kill -9 $P 2>/dev/null && echo 'it hung'; wait $P; echo status $?\n";
    ASSERT_TRUE(write_file(folder.path / "drive.sh", script));
    const Outcome outcome = shell("timeout 3000 xvfb-run -a -s '-screen 0 800x600x24 -noreset' bash '" +
                                  (folder.path / "drive.sh").string() + "'");
    const std::string log = read_file(folder.path / "log").value();
    EXPECT_EQ(outcome.output.find("it hung"), std::string::npos) << "seed " << seed << "\n" << outcome.output << log;
    const bool quit = outcome.output.find("status 0") != std::string::npos;
    const bool asked_to = outcome.output.find("status 143") != std::string::npos;
    EXPECT_TRUE(quit || asked_to) << "seed " << seed << "\n" << outcome.output << log;
    EXPECT_EQ(log.find("alidation"), std::string::npos) << log;
    EXPECT_EQ(log.find("error"), std::string::npos) << log;
    expect_flat(folder.path / "memory", log);
}

} // namespace
} // namespace sunfleck
