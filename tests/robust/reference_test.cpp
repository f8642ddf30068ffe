// sunfleck reference: whatever ends it, and whenever, the same command goes on to the same bits.
#include "engine/core/file.h"
#include "engine/core/random.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <csignal>
#include <sys/stat.h>
#include <sys/sysmacros.h>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::Outcome, tests::shell;

class RobustReference : public testing::Test {
protected:
    std::string in_folder(const std::string& command) const {
        return "cd '" + folder.path.string() + "' && " + command;
    }
    Outcome tool(const std::string& arguments) const { return shell(in_folder(SUNFLECK_TOOL " " + arguments)); }
    // Runs until the shell's `wait_for` is true, then sends the signal; its output is in the file "log", which no
    // longer holds what an earlier run wrote.
    Outcome stopped(const std::string& arguments, const std::string& wait_for, int signal) const {
        return shell(in_folder("rm -f log; { " SUNFLECK_TOOL " " + arguments + " > log 2>&1 & P=$!; " + wait_for +
                               "; kill -" + std::to_string(signal) + " $P; wait $P; S=$?; cat log; exit $S; }"));
    }
    std::string bytes(const std::string& name) const {
        const auto content = read_file(folder.path / name);
        return content ? *content : "none";
    }
    void flip_a_byte(const std::string& name) const {
        std::string content = bytes(name);
        content[content.size() / 2] = char(content[content.size() / 2] ^ 1);
        ASSERT_TRUE(write_file(folder.path / name, content));
    }
    tests::Folder folder;
};

const std::string until_samples = "for i in $(seq 600); do grep -q spp log && break; sleep 0.05; done";
const std::string until_saved = "for i in $(seq 600); do [ -f a.exr.state2 ] && break; sleep 0.05; done";
const std::string never_done = " --size 64x48 --spp 100000 --save-interval 0.05 -o a.exr";

TEST_F(RobustReference, KilledAnywhereItGivesTheSameBits) {
    const std::string options = "reference cornell --size 48x36 --antialiasing --save-interval 0.05 --spp " +
                                std::to_string(tests::by_size(1000, 20000));
    ASSERT_EQ(tool(options + " -o whole.exr --stats whole.json").status, 0);
    int kills = 0, resumed = 0;
    for (; kills < tests::by_size(60, 400); ++kills) {
        const double seconds = 0.05 + 0.5 * pcg_hash(std::uint32_t(kills)) * 0x1p-32;
        const Outcome outcome =
            stopped(options + " -o parts.exr --stats parts.json", "sleep " + std::to_string(seconds), SIGKILL);
        resumed += outcome.output.find("going on from") != std::string::npos;
        ASSERT_EQ(outcome.output.find("error:"), std::string::npos) << outcome.output;
        if (outcome.status == 0)
            break; // it was quicker
    }
    EXPECT_GT(resumed, 2) << "of " << kills;
    const Outcome last = tool(options + " -o parts.exr --stats parts.json");
    ASSERT_EQ(last.status, 0) << last.output;
    EXPECT_EQ(bytes("parts.exr"), bytes("whole.exr"));
    const auto whole = nlohmann::json::parse(bytes("whole.json")), parts = nlohmann::json::parse(bytes("parts.json"));
    EXPECT_EQ(whole["rays"], parts["rays"]) << "no sample is traced twice or lost";
    EXPECT_FALSE(fs::exists(folder.path / "parts.exr.state"));
    EXPECT_FALSE(fs::exists(folder.path / "parts.exr.state2"));
    for (const auto& entry : fs::directory_iterator(folder.path))
        EXPECT_EQ(entry.path().extension().string().find(".tmp"), std::string::npos) << entry.path();
}

// A picture whose first pass alone takes longer than the test waits: parts of a pass are saved, too.
TEST_F(RobustReference, PartsOfAPassAreSaved) {
    const std::string large = "reference cornell --size 1200x900 --unlimited --spp 4 --save-interval 0.05 -o a.exr";
    ASSERT_NE(stopped(large, "for i in $(seq 600); do [ -f a.exr.state ] && break; sleep 0.02; done", SIGKILL).status,
              0);
    const Outcome again = stopped(large, until_samples, SIGTERM);
    EXPECT_EQ(again.status, 128 + SIGTERM) << again.output;
    EXPECT_NE(again.output.find("going on from 0 samples"), std::string::npos) << again.output;
}

TEST_F(RobustReference, EverySignalThatCanBeCaughtSaves) {
    for (const int signal :
         {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF}) {
        const std::string options = "reference cornell --size 64x48 --spp 100000 -o a.exr";
        const Outcome outcome = stopped(options, until_samples, signal);
        EXPECT_EQ(outcome.status, 128 + signal) << outcome.output;
        EXPECT_TRUE(fs::exists(folder.path / "a.exr.state")) << outcome.output;
        const Outcome resumed = stopped(options, until_samples, SIGTERM);
        EXPECT_NE(resumed.output.find("going on from"), std::string::npos) << resumed.output;
        for (const char* name : {"a.exr.state", "a.exr.state2"})
            fs::remove(folder.path / name);
    }
}

TEST_F(RobustReference, ADamagedStateGivesWayToTheOneBefore) {
    const std::string options = "reference cornell" + never_done;
    ASSERT_EQ(stopped(options, until_saved, SIGTERM).status, 128 + SIGTERM);
    const std::string first = bytes("a.exr.state"), second = bytes("a.exr.state2");
    flip_a_byte("a.exr.state2");
    const Outcome one = stopped(options, until_samples, SIGKILL);
    EXPECT_NE(one.output.find("'a.exr.state2' is damaged"), std::string::npos) << one.output;
    EXPECT_NE(one.output.find("in 'a.exr.state'"), std::string::npos) << one.output;
    ASSERT_TRUE(write_file(folder.path / "a.exr.state", first.substr(0, first.size() - 1)));
    ASSERT_TRUE(write_file(folder.path / "a.exr.state2", second.substr(0, 100)));
    const Outcome none = tool(options);
    EXPECT_EQ(none.status, 1) << none.output;
    EXPECT_NE(none.output.find("a.exr.state2"), std::string::npos) << none.output;
    EXPECT_EQ(bytes("a.exr.state").size(), first.size() - 1) << "nothing is thrown away without being asked for";
}

// A scene file that names a glTF file with a buffer of its own, lit by a picture.
void make_scene(const fs::path& folder, float size) {
    tests::GltfBuilder file;
    file.add_square();
    file.file["scenes"] = {{{"nodes", {0}}}, {{"nodes", {0}}}};
    file.file["extensionsUsed"] = {"KHR_materials_variants"};
    file.file["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "red"}}};
    file.file["nodes"][0]["scale"] = {size, size, size};
    ASSERT_TRUE(write_file(folder / "square.glb", file.glb()));
    ASSERT_TRUE(write_file(folder / "a.scene.json", R"({"sunfleck_scene":2,"gltf":"square.glb"})"));
}

TEST_F(RobustReference, TheStateOfAnotherPictureIsNotTaken) {
    make_scene(folder.path, 1.0f);
    ASSERT_EQ(tool("render cornell -o sky.png --size 8x4 --lights 4 --warmup 0").status, 0);
    const std::string options = "reference a.scene.json --environment sky.png" + never_done;
    ASSERT_EQ(stopped(options, until_saved, SIGTERM).status, 128 + SIGTERM);
    const std::string before = bytes("a.exr.state2");
    const auto expect_refused = [&](const std::string& arguments) {
        const Outcome outcome = shell(in_folder("timeout -s KILL 10 " SUNFLECK_TOOL " " + arguments));
        EXPECT_EQ(outcome.status, 1) << arguments << ": " << outcome.output;
        EXPECT_NE(outcome.output.find("a.exr.state"), std::string::npos) << outcome.output;
        EXPECT_EQ(bytes("a.exr.state2"), before);
    };
    for (const char* extra : {" --movers static", " --animation -1", " --scene 1", " --variant red", " --seed 2",
                              " --bounces 2", " --view irradiance", " --antialiasing", " --warmup 4", " --orbit 1",
                              " --motion off --warmup 2", " --camera 0,0,3,0,0,0,40"})
        expect_refused(options + extra);
    expect_refused("reference a.scene.json" + never_done);
    fs::copy_file(folder.path / "sky.png", folder.path / "kept.png");
    ASSERT_EQ(tool("render cornell -o sky.png --size 8x4 --lights 5 --warmup 0").status, 0);
    expect_refused(options);
    fs::rename(folder.path / "kept.png", folder.path / "sky.png");
    make_scene(folder.path, 1.5f);
    expect_refused(options);
    make_scene(folder.path, 1.0f);
    EXPECT_NE(stopped(options, until_samples, SIGKILL).output.find("going on"), std::string::npos)
        << "the same files again are the same picture";
}

TEST_F(RobustReference, OutputsAreTriedBeforeAnythingIsLoaded) {
    // The scene is none: whoever names it first has looked at the outputs too late.
    ASSERT_TRUE(write_file(folder.path / "scene.glb", "not a scene"));
    const auto expect_error = [&](const std::string& arguments, const std::string& word) {
        const Outcome outcome = tool("reference scene.glb " + arguments);
        EXPECT_EQ(outcome.status, 1) << outcome.output;
        EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " in: " << outcome.output;
    };
    expect_error("-o missing/a.exr", "missing");
    expect_error("-o a.exr --stats missing/b.json", "missing");
    expect_error("-o a.exr --stats a.exr", "--stats");
    expect_error("-o a.exr --stats a.exr.state", "--stats");
    expect_error("-o a.exr --environment a.exr", "a.exr");
    expect_error("-o " + std::string(251, 'n') + ".exr", "too long");
    expect_error("-o a.exr", "scene.glb");
}

// The device that is always full stands for a disk that has become so meanwhile.
TEST_F(RobustReference, AFinalWriteThatFailsLosesNothing) {
    const std::string options = "reference cornell --size 32x24 --spp 16 -o ";
    ASSERT_EQ(tool(options + "whole.exr").status, 0);
    const fs::path full = folder.path / "a.exr";
    if (::getuid() != 0 || ::mknod(full.c_str(), S_IFCHR | 0600, makedev(1, 7)) != 0)
        GTEST_SKIP() << "no device can be made here";
    const Outcome failed = tool(options + "a.exr");
    EXPECT_EQ(failed.status, 1);
    EXPECT_NE(failed.output.find("No space left"), std::string::npos) << failed.output;
    EXPECT_TRUE(fs::is_character_file(full));
    fs::remove(full);
    const Outcome resumed = tool(options + "a.exr");
    ASSERT_EQ(resumed.status, 0) << resumed.output;
    EXPECT_NE(resumed.output.find("going on from 16 samples"), std::string::npos) << resumed.output;
    EXPECT_EQ(bytes("a.exr"), bytes("whole.exr"));
}

} // namespace
} // namespace sunfleck
