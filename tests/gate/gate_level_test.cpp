// `sunfleck bench level` and `bench pictures` on a real, if small, walk.
#include "engine/core/file.h"
#include "game_demo/walk_through.h"
#include "test_places.h"
#include "tests/support/run_tool.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"
#include "viewer/scene_renderer.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::Outcome;
using tests::shell;

// A frame a second, few pixels and few lights.
const std::string small = " --steps-per-frame 60 --size 96x54 --set lights=20";

class GateLevel : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / ("sunfleck_level_" + std::to_string(getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    Outcome tool(const std::string& arguments) const {
        return shell("cd " + folder.string() + " && " SUNFLECK_TOOL " bench " + arguments);
    }
    nlohmann::json json(const char* name) const { return nlohmann::json::parse(read_file(folder / name).value()); }
    fs::path folder;
};

// What CI looks at: the pictures of the walk that are stored in the project. After a change that was meant to change
// them: sunfleck bench pictures --stored tests/images/level --steps-per-frame 30 --set baked_samples=0 --accept
TEST_F(GateLevel, TheStoredPicturesAreStillDrawn) {
    if (!tests::has_technique("light_samples") || !tests::has_technique("adaptive_shadows"))
        GTEST_SKIP() << "they are what these two draw";
    // Light that is refined differs by more than the limits on another processor: which of two triangles a ray meets
    // may be another there, and then other paths represent some of the clusters of so many samples.
    const Outcome outcome = tool("pictures --stored " SUNFLECK_SOURCE_DIR "/tests/images/level --steps-per-frame 30 "
                                 "--set baked_samples=0 --differences d");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
}

TEST_F(GateLevel, EveryFrameIsWritten) {
    ASSERT_EQ(tool("level --frames 3 --warmup 1 -o a.json" + small).status, 0);
    const auto level = json("a.json");
    for (const char* key : {"device", "driver", "scene", "settings", "frames", "frame_ms", "cpu_ms", "gpu_ms",
                            "counters", "memory_bytes"})
        EXPECT_TRUE(level.contains(key)) << key;
    EXPECT_EQ(level["frames"], 3);
    ASSERT_EQ(level["each_frame"].size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& frame = level["each_frame"][i];
        EXPECT_EQ(frame["frame"], i + 1);
        EXPECT_GT(frame["passes"]["shadow maps"], 0.0);
        EXPECT_GT(frame["stages"]["simulation"], 0.0);
        EXPECT_GT(frame["counters"]["light_samples"], 0.0);
        EXPECT_TRUE(frame["counters"].contains("pixels_repaired")) << "counted on the GPU";
        double parts = 0.0;
        for (const char* group : {"passes", "stages"})
            for (const auto& [name, ms] : frame[group].items())
                parts += ms.get<double>();
        // Passes and stages do not contain each other; 2 % for clocks that are not one.
        EXPECT_LT(parts, 1.02 * frame["frame_ms"].get<double>());
    }
}

// The same frames give the same counters and bits, whatever was drawn at other times.
TEST_F(GateLevel, ServesWhatIsAskedFor) {
    const auto serve = [&](const std::string& requests) {
        return shell("(cd " + folder.string() + " && printf '" + requests +
                     "' | " SUNFLECK_TOOL " bench level --serve" + small + " 2>/dev/null)");
    };
    const Outcome first = serve("frames 0 2\\nframes 30 3\\npicture a.png\\nquit\\n");
    const Outcome second = serve("frames 0 2\\nframes 30 3\\npicture b.png\\n"); // the end of input will do
    EXPECT_EQ(first.status, 0) << first.output;
    EXPECT_EQ(read_file(folder / "a.png").value(), read_file(folder / "b.png").value());
    std::vector<nlohmann::json> lines[2];
    for (const Outcome* outcome : {&first, &second}) {
        std::istringstream text(outcome->output);
        for (std::string line; std::getline(text, line);)
            lines[outcome == &second].push_back(nlohmann::json::parse(line));
    }
    ASSERT_EQ(lines[0].size(), 7u) << first.output; // hello, five frames, picture
    ASSERT_EQ(lines[1].size(), 7u);
    EXPECT_EQ(lines[0][0], lines[1][0]);
    for (std::size_t i = 1; i < 6; ++i)
        EXPECT_EQ(lines[0][i]["counters"], lines[1][i]["counters"]);
    EXPECT_EQ(lines[0][5]["frame"], 32);
    EXPECT_EQ(serve("frames 5 1\\nframes 3 1\\n").status, 2) << "frames must rise";
    EXPECT_EQ(serve("frames 60 100\\n").status, 2) << "the recording ends";
}

TEST_F(GateLevel, AChangedPictureIsCaughtWherever) {
    const std::string pictures = "pictures --stored stored" + small;
    ASSERT_EQ(tool(pictures + " --accept --frame a=2 --frame b=4").status, 0);
    ASSERT_EQ(tool(pictures).status, 0);
    // 2 % more red in a stored picture, and the stored ones said to be another machine's.
    io::Picture picture = io::read_picture(folder / "stored/b.png").value();
    for (vec4& pixel : picture.pixels)
        pixel.x *= 1.02f;
    ASSERT_TRUE(io::write_picture(folder / "stored/b.png", picture));
    auto manifest = json("stored/manifest.json");
    manifest["processor"] = "other";
    ASSERT_TRUE(write_file(folder / "stored/manifest.json", manifest.dump()));
    const Outcome outcome = tool(pictures + " --differences differences");
    EXPECT_EQ(outcome.status, 4) << outcome.output;
    EXPECT_TRUE(fs::exists(folder / "differences/b_difference.png"));
    EXPECT_FALSE(fs::exists(folder / "differences/a_difference.png"));
}

TEST_F(GateLevel, BadInputGetsOneMessage) {
    const std::pair<const char*, const char*> cases[] = {
        {"level --input missing.walk", "missing.walk"},
        {"level --scene cornell", "--input"},
        {"level --set no_such=1", "no_such"},
        {"level --size 0x1", "--size"},
        {"level --preset best", "--preset"},
        {"level --warmup 700", "warm-up"},
        {"level --frames 1 --warmup 0 -o no/such/folder.json --steps-per-frame 60 --size 16x9", "folder.json"},
        {"pictures --stored nowhere", "nowhere"},
        {"compare a.json b.json", "a.json"},
        {"compare --base no_such_revision", "git"},
    };
    for (const auto& [arguments, word] : cases) {
        const Outcome outcome = tool(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments << ": " << outcome.output;
        EXPECT_NE(outcome.output.find(word), std::string::npos) << outcome.output;
    }
    EXPECT_TRUE(fs::is_empty(folder));
    const Outcome outcome =
        shell("cd " SUNFLECK_SOURCE_DIR " && git rev-parse >/dev/null 2>&1 || exit 77; " SUNFLECK_TOOL
              " bench compare --base no_such_revision");
    if (outcome.status != 77) {
        EXPECT_EQ(outcome.status, 2) << outcome.output;
        EXPECT_NE(outcome.output.find("no_such_revision"), std::string::npos) << outcome.output;
    }
}

// The recording in assets/ is what the demo's walker does in the level as it is now. When the level has changed:
// sunfleck_demo --headless --record assets/lantern_house.walk -o FOLDER
TEST_F(GateLevel, TheRecordingIsTheDemosWalk) {
    const fs::path scenes = fs::path(SUNFLECK_TOOL).parent_path() / "../scenes";
    const auto recorded = simulation::read_recording(scenes / "lantern_house.walk").value();
    ecs::Registry registry;
    scene::register_components(registry);
    scene::MeshStore meshes;
    scene::TextureStore textures;
    ASSERT_TRUE(io::load_scene(scenes / "lantern_house.scene.json", registry, meshes, textures));
    simulation::Simulation simulation(registry, meshes);
    demo::WalkThrough walker;
    for (std::size_t i = 0; i < recorded.size(); ++i) {
        const simulation::StepInput input = walker.next(simulation);
        ASSERT_EQ(input, recorded[i]) << "step " << i;
        simulation.step(registry, input);
    }
    EXPECT_LE(simulation.player().rescued(), 0u);
}

} // namespace
} // namespace sunfleck
