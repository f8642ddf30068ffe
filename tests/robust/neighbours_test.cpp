// What else there is on a machine: other programs at the same files, a clock that was set back, no home, and names of
// files that nobody would choose.
#include "editor/command_line/program.h"
#include "engine/core/file.h"
#include "engine/io/scene_file.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"
#include "tests/support/run_tool.h"

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::Outcome, tests::shell;

std::string content_of(const fs::path& path) {
    const auto content = read_file(path);
    return content ? *content : "none";
}

class RobustNeighbours : public testing::Test {
protected:
    Outcome in_folder(const std::string& command) const {
        return shell("cd '" + folder.path.string() + "' || exit; " + command);
    }
    std::string bytes(const std::string& name) const { return content_of(folder.path / name); }
    // A picture that takes precomputed transfer, which is kept in a cache.
    static std::string transfer_of(const std::string& output) {
        return SUNFLECK_TOOL " render gap_room --movers prt --size 24x14 --lights 12 --warmup 0 -o " + output;
    }
    tests::Folder folder;
};

TEST_F(RobustNeighbours, ProgramsShareACacheAndAnOutput) {
    const std::string cache = "export XDG_CACHE_HOME=$PWD/";
    ASSERT_EQ(in_folder(cache + "alone; " + transfer_of("alone.png")).status, 0);
    const Outcome together = in_folder(cache + "shared; for i in 1 2 3; do { " + transfer_of("shared.png") +
                                       " || echo failed; } & done; wait");
    EXPECT_EQ(together.output.find("failed"), std::string::npos) << together.output;
    EXPECT_EQ(together.output.find("warning"), std::string::npos) << together.output;
    EXPECT_EQ(bytes("shared.png"), bytes("alone.png"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), {}), 4) << "no temporary file is left";
}

// Both go on from the same state, and save it in turn.
TEST_F(RobustNeighbours, TwoReferencesOfOnePicture) {
    const std::string trace = SUNFLECK_TOOL " reference cornell --size 48x36 --spp 400 --save-interval 0.05 -o ";
    ASSERT_EQ(in_folder(trace + "alone.exr").status, 0);
    const Outcome both = in_folder("for i in 1 2; do { " + trace + "both.exr || echo failed; } & done; wait");
    EXPECT_EQ(both.output.find("failed"), std::string::npos) << both.output;
    EXPECT_EQ(bytes("both.exr"), bytes("alone.exr"));
}

// Whatever was written is from the future then.
TEST_F(RobustNeighbours, AClockThatWasSetBack) {
    const std::string cache = "export XDG_CACHE_HOME=$PWD/cache; ";
    ASSERT_EQ(in_folder(cache + transfer_of("before.png")).status, 0);
    const std::string trace = SUNFLECK_TOOL " reference cornell --size 48x36 --save-interval 0.05 -o a.exr --spp ";
    in_folder("timeout -s TERM 60 " + trace +
              "10000000 & P=$!; for i in $(seq 1200); do [ -f a.exr.state ] && break; "
              "sleep 0.05; done; kill $P; wait $P");
    ASSERT_TRUE(fs::exists(folder.path / "a.exr.state"));
    ASSERT_EQ(in_folder("find . -exec touch -d '2040-01-01' {} +").status, 0);
    const Outcome after = in_folder(cache + transfer_of("after.png"));
    EXPECT_EQ(after.status, 0) << after.output;
    EXPECT_EQ(bytes("after.png"), bytes("before.png"));
    const Outcome resumed = in_folder(trace + "1");
    EXPECT_EQ(resumed.status, 0) << resumed.output;
    EXPECT_NE(resumed.output.find("going on from"), std::string::npos) << resumed.output;
}

TEST_F(RobustNeighbours, NoHome) {
    ASSERT_EQ(in_folder("XDG_CACHE_HOME=$PWD/cache " + transfer_of("with.png")).status, 0);
    ASSERT_TRUE(write_file(folder.path / "file", "x"));
    for (const std::string home : {"env -u HOME -u XDG_CACHE_HOME", "env -u XDG_CACHE_HOME HOME=/does/not/exist",
                                   "env -u XDG_CACHE_HOME HOME=$PWD/file", "env -u HOME XDG_CACHE_HOME=relative"}) {
        fs::remove(folder.path / "without.png");
        const Outcome outcome = in_folder(home + " " + transfer_of("without.png"));
        EXPECT_EQ(outcome.status, 0) << home << ": " << outcome.output;
        EXPECT_EQ(bytes("without.png"), bytes("with.png")) << home;
        EXPECT_FALSE(fs::exists(folder.path / "relative"));
    }
}

const std::vector<std::string>& odd_names() {
    static const std::vector<std::string> names = {"a b\nc", std::string(244, 'n'),  "\xff\xfe\x80", "$(x) '\"`;*",
                                                   "-",      "\xc3\xa4 \xe2\x88\x9e"};
    return names;
}

// Given to the program as it is, without a shell.
int run(const std::vector<std::string>& words) {
    std::vector<const char*> arguments = {"sunfleck"};
    for (const std::string& word : words)
        arguments.push_back(word.c_str());
    return command_line::run_program(int(arguments.size()), arguments.data());
}

TEST_F(RobustNeighbours, OddNamesOfScenesPicturesAndStatistics) {
    tests::GltfBuilder square;
    square.add_square();
    for (const std::string& name : odd_names()) {
        const std::string at = (folder.path / name).string();
        ASSERT_TRUE(write_file(at + ".glb", square.glb()));
        EXPECT_EQ(
            run({"reference", at + ".glb", "-o", at + ".exr", "--size", "8x6", "--spp", "1", "--stats", at + ".json"}),
            0)
            << name;
        EXPECT_TRUE(nlohmann::json::accept(content_of(at + ".json")));
        EXPECT_EQ(run({"info", at + ".glb", "--json"}), 0) << name;
        fs::remove(at + ".json");
    }
    const std::string at = (folder.path / odd_names()[2]).string();
    EXPECT_EQ(run({"render", at + ".glb", "-o", at + ".png", "--size", "8x6", "--lights", "4", "--warmup", "0",
                   "--stats", at + ".json", "--trace", at + ".trace"}),
              0);
    EXPECT_TRUE(nlohmann::json::accept(content_of(at + ".json")));
}

// As long as names can be, each of them.
TEST_F(RobustNeighbours, NamesOf255Bytes) {
    tests::GltfBuilder square;
    square.add_square();
    const auto at = [&](const std::string& ending) {
        return (folder.path / std::string(255 - ending.size(), 'n').append(ending)).string();
    };
    ASSERT_TRUE(write_file(at(".glb"), square.glb()));
    for (const char* ending : {".png", ".exr"})
        EXPECT_EQ(run({"render", at(".glb"), "-o", at(ending), "--size", "8x6", "--lights", "4", "--warmup", "0",
                       "--stats", at(".json"), "--trace", at(".trace")}),
                  0)
            << ending;
    EXPECT_EQ(run({"compare", at(".png"), at(".png"), "--diff", at(".difference.png")}), 0);
    EXPECT_EQ(run({"info", at(".glb")}), 0);
    for (const char* ending : {".json", ".trace"})
        EXPECT_TRUE(nlohmann::json::accept(content_of(at(ending)))) << ending;
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), {}), 6);
}

TEST_F(RobustNeighbours, OddNamesOfSavedScenes) {
    tests::GltfBuilder square;
    square.add_square();
    for (std::string name : odd_names()) {
        name = name.substr(0, 244); // 255 with the extension
        const fs::path path = folder.path / (name + ".scene.json");
        for (int times = 0; times < 2; ++times) {
            tests::World world, after;
            ASSERT_TRUE(world.import(square.glb()));
            const Status saved = io::save_scene(path, world.registry, world.meshes, world.textures);
            ASSERT_TRUE(saved) << name << ": " << saved.error().message;
            const auto report = io::load_scene(path, after.registry, after.meshes, after.textures);
            ASSERT_TRUE(report) << name << ": " << report.error().message;
            EXPECT_FALSE(scene::find_by_name(after.registry, "square").is_null());
        }
    }
}

} // namespace
} // namespace sunfleck
