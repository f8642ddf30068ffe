// Devices that stop answering under programs as they are, by a Vulkan layer (lossy_layer.cpp): one message, the work
// goes on with a new device, and nothing that it makes is another; the third loss ends it.
#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"
#include "tests/support/run_tool.h"

#include <gtest/gtest.h>

namespace sunfleck {
namespace {

using tests::Outcome, tests::shell;

class RobustLostDevice : public testing::Test {
protected:
    std::string file(const std::string& name) const { return (folder.path / name).string(); }
    static int count(const std::string& text, const std::string& part) {
        int found = 0;
        for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
            ++found;
        return found;
    }
    tests::Folder folder;
    const std::string layer = "VK_LAYER_PATH=" SUNFLECK_LAYERS ":/usr/share/vulkan/explicit_layer.d "
                              "VK_INSTANCE_LAYERS=VK_LAYER_SUNFLECK_lossy ";
};

TEST_F(RobustLostDevice, PicturesAreTheSame) {
    const auto render = [&](const std::string& losses, const std::string& name) {
        return shell(layer + "SUNFLECK_LOSE=" + losses +
                     " " SUNFLECK_TOOL " render cornell --size 48x32 --lights 12 -o " + file(name));
    };
    ASSERT_EQ(render("0", "whole.png").status, 0);
    const std::string whole = read_file(folder.path / "whole.png").value();
    for (const char* losses : {"1", "2,1"}) {
        const Outcome outcome = render(losses, "lost.png");
        ASSERT_EQ(outcome.status, 0) << outcome.output;
        EXPECT_EQ(count(outcome.output, "begins again on a new device"), losses[1] == ',' ? 2 : 1) << outcome.output;
        EXPECT_EQ(read_file(folder.path / "lost.png").value(), whole) << losses;
    }
    const Outcome third = render("2,1,2", "third.png");
    EXPECT_EQ(third.status, 1) << third.output;
    EXPECT_EQ(count(third.output, "3 times"), 1) << third.output;
    EXPECT_FALSE(std::filesystem::exists(folder.path / "third.png"));
}

TEST_F(RobustLostDevice, AWalkIsTheSame) {
    const auto walk = [&](const std::string& losses, const std::string& name) {
        return shell(layer + "SUNFLECK_LOSE=" + losses +
                     " " SUNFLECK_DEMO " --headless --scene four_pillars --size 64x36 --frames 3 --pictures 1 -o " +
                     file(name));
    };
    ASSERT_EQ(walk("0", "whole").status, 0);
    const Outcome outcome = walk("9,5", "lost");
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(count(outcome.output, "new device"), 2) << outcome.output;
    int pictures = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path / "whole"))
        if (entry.path().extension() == ".png") {
            ++pictures;
            EXPECT_EQ(read_file(folder.path / "lost" / entry.path().filename()).value(), read_file(entry).value());
        }
    EXPECT_GT(pictures, 0);
    const Outcome third = walk("9,5,7", "third");
    EXPECT_EQ(third.status, 1) << third.output;
    EXPECT_EQ(count(third.output, "new device"), 2) << third.output;
    EXPECT_EQ(count(third.output, "error:"), 1) << third.output;
    EXPECT_EQ(count(third.output, "3 times"), 1) << third.output;
    EXPECT_FALSE(std::filesystem::exists(folder.path / "third/stats.json")) << "it tells of frames that were not drawn";
}

// Nothing here waits for a time: each step is done when what it asks for is there, or after two minutes.
const char* const window_script = R"(
export XDG_CONFIG_HOME=$PWD/config SUNFLECK_LOSE_FILE=$PWD/lose
until_true() { for i in $(seq 600); do eval "$1" && return; kill -0 $P 2>/dev/null || return; sleep 0.2; done; echo "not so: $1"; }
until_true 'xdotool getdisplaygeometry >/dev/null 2>&1'
$PROGRAM --size 192x108 --record walk.txt > log 2>&1 & P=$!
steps() { awk '/^[0-9]/ { n += $1 } END { print n + 0 }' walk.txt 2>/dev/null || echo 0; }
loaded='W=$(xdotool search --name "Lantern House$" | head -1); [ -n "$W" ]'
until_true "$loaded"
# The recording begins when the game does, which Return starts once the window has the focus.
until_true '[ $(steps) -gt 0 ] || { xdotool windowfocus $W; xdotool key Return; sleep 0.3; false; }'
for loss in 1 2; do
    before=$(steps)
    touch lose
    until_true '[ $(grep -c "new device" log) = '$loss' ]'
    until_true "$loaded"
    # It is paused where the window lost the focus.
    until_true '[ $(steps) -gt '$before' ] || { xdotool windowfocus $W; xdotool key Return; sleep 0.3; false; }'
    echo "played on after loss $loss: $before"
done
touch lose
until_true false
kill -9 $P 2>/dev/null && echo 'it hung'
wait $P; echo status $?
cat log
)";

TEST_F(RobustLostDevice, TheGameGoesOnInItsWindow) {
    if (shell("command -v xvfb-run && command -v xdotool").status != 0)
        GTEST_SKIP() << "xvfb and xdotool are not installed";
    ASSERT_TRUE(write_file(folder.path / "drive.sh", "cd '" + folder.path.string() + "'\nexport " + layer +
                                                         "\nPROGRAM='" SUNFLECK_DEMO " --scene four_pillars'\nP=$$" +
                                                         window_script));
    const Outcome outcome =
        shell("timeout 280 xvfb-run -a -s '-screen 0 800x600x24 -noreset' bash " + file("drive.sh"));
    EXPECT_EQ(count(outcome.output, "played on after loss"), 2) << outcome.output;
    EXPECT_EQ(count(outcome.output, "status 1"), 1) << outcome.output;
    EXPECT_EQ(count(outcome.output, "3 times"), 1) << outcome.output;
    EXPECT_EQ(count(outcome.output, "it hung"), 0) << outcome.output;
    EXPECT_EQ(count(outcome.output, "not so"), 0) << outcome.output;
}

} // namespace
} // namespace sunfleck
