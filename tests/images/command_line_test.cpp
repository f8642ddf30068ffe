// The tool from outside: exit status, messages, files.
#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/command_line.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

using tests::CommandLine, tests::Outcome, tests::shell;

const std::string small = " --size 32x24 --lights 8 --warmup 0 --set shadow_map_resolution=32";

TEST_F(CommandLine, RenderWritesThePictureAndStatistics) {
    const Outcome outcome = tool("render cornell -o a.png --stats a.json --validation" + small);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    // Nothing but how far it is, on a machine that takes long.
    std::istringstream lines(outcome.output);
    for (std::string line; std::getline(lines, line);)
        EXPECT_TRUE(std::regex_match(line, std::regex("[a-z ]+: [0-9]+ % *"))) << line;
    const auto json = nlohmann::json::parse(read_file(folder / "a.json").value());
    for (const char* key : {"device", "driver", "scene", "settings", "frames", "frame_ms", "cpu_ms", "gpu_ms",
                            "counters", "memory_bytes"})
        EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_EQ(json["counters"]["light_samples"], 8);
    EXPECT_EQ(json["counters"]["shadow_map_updates"], 8);
    EXPECT_GT(json["gpu_ms"]["shadow maps"], 0.0);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2);
}

struct TraceEvent {
    std::string name;
    double begin, end; // microseconds
};

// Rows of a Chrome trace by name, each in the order of the file.
std::map<std::string, std::vector<TraceEvent>> rows_of(const nlohmann::json& trace) {
    std::map<int, std::string> names;
    std::map<std::string, std::vector<TraceEvent>> rows;
    for (const auto& event : trace.at("traceEvents"))
        if (event.at("ph") == "M")
            names[event.at("tid")] = event.at("args").at("name");
        else {
            EXPECT_EQ(event.at("ph"), "X") << event;
            const double begin = event.at("ts");
            rows[names.at(event.at("tid"))].push_back({event.at("name"), begin, begin + double(event.at("dur"))});
        }
    return rows;
}

// Events of a row follow one another; those that lie in another are listed after it.
void expect_nested(const std::vector<TraceEvent>& row) {
    const double rounding = 1e-6; // microseconds, of sums of some 1e4
    std::vector<TraceEvent> open;
    for (const TraceEvent& event : row) {
        EXPECT_GE(event.end, event.begin) << event.name;
        while (!open.empty() && event.begin >= open.back().end - rounding)
            open.pop_back();
        const TraceEvent around = open.empty() ? event : open.back();
        EXPECT_LE(event.end, around.end + rounding) << event.name << " in " << around.name;
        open.push_back(event);
    }
}

TEST_F(CommandLine, ATraceHasStagesAndPassesOfEveryFrame) {
    const Outcome outcome = tool("render cornell -o a.png --trace a.json --frames 2" + small);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const auto rows = rows_of(nlohmann::json::parse(read_file(folder / "a.json").value()));
    ASSERT_EQ(rows.size(), 2u) << "a row for the CPU and one for the GPU";
    std::map<std::string, int> events;
    for (const auto& [name, row] : rows) {
        expect_nested(row);
        for (const TraceEvent& event : row)
            ++events[event.name];
    }
    for (const char* name : {"simulation", "lighting", "recording", "waiting for the GPU", "g-buffer", "composition"})
        EXPECT_EQ(events[name], 2) << name;
    EXPECT_EQ(events["frame 0"], 1);
    EXPECT_EQ(events["frame 1"], 1);
}

// Milliseconds of a row by name, without those of events within an event.
std::map<std::string, double> own_times(const std::vector<TraceEvent>& row) {
    std::map<std::string, double> times;
    for (const TraceEvent& event : row) {
        times[event.name] += (event.end - event.begin) * 1e-3;
        const TraceEvent* around = nullptr;
        for (const TraceEvent& other : row)
            if (&other < &event && other.begin <= event.begin && event.end <= other.end)
                around = &other;
        if (around != nullptr)
            times[around->name] -= (event.end - event.begin) * 1e-3;
    }
    return times;
}

// The trace and --stats tell the same times; what the CPU did has a name for nearly all of the frame.
TEST_F(CommandLine, ATraceHasTheTimesOfTheStatistics) {
    const Outcome outcome = tool("render cornell -o a.png --trace a.json --stats stats.json" + small);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const auto rows = rows_of(nlohmann::json::parse(read_file(folder / "a.json").value()));
    const auto statistics = nlohmann::json::parse(read_file(folder / "stats.json").value());
    const double frame = statistics.at("frame_ms").at("median"), rounding = 1e-6;
    for (const auto& [name, row] : rows) {
        const bool on_cpu = name == "CPU";
        const std::map<std::string, double> times = own_times(row);
        const auto& stages = statistics.at(on_cpu ? "cpu_ms" : "gpu_ms");
        EXPECT_GT(stages.size(), 5u);
        for (const auto& [stage, time] : stages.items())
            EXPECT_NEAR(times.count(stage) ? times.at(stage) : -1.0, double(time), rounding) << stage;
        if (on_cpu) {
            EXPECT_NEAR(row.front().end - row.front().begin, frame * 1e3, rounding * 1e3);
            EXPECT_LT(times.at("frame 0"), frame * 0.25) << "time without a name"; // 0.01, but for busy machines
        }
    }
}

TEST_F(CommandLine, CompareOfAPictureWithItselfIsNothing) {
    ASSERT_EQ(tool("render table_room -o a.exr --view irradiance" + small).status, 0);
    const Outcome outcome = tool("compare a.exr a.exr --json --diff d.png");
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const auto json = nlohmann::json::parse(outcome.output);
    for (const char* key :
         {"mean_a", "mean_b", "mae", "max", "rmse", "relative_mse", "psnr", "ssim", "flip", "pixels", "left_out"})
        EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_EQ(json["max"], 0.0);
    EXPECT_EQ(json["mean_a"], json["mean_b"]);
    EXPECT_GT(json["mean_a"], 0.0);
}

TEST_F(CommandLine, TheSameBitsWithOneAndTwoRasterThreads) {
    const std::string options = "render four_pillars --frames 2 --orbit 0.25" + small;
    ASSERT_EQ(tool(options + " -o one.exr", "LP_NUM_THREADS=1").status, 0);
    ASSERT_EQ(tool(options + " -o two.exr", "LP_NUM_THREADS=2").status, 0);
    EXPECT_EQ(read_file(folder / "one.exr").value(), read_file(folder / "two.exr").value());
}

TEST_F(CommandLine, SizesFromOnePixelUp) {
    EXPECT_EQ(tool("render cornell -o a.png --size 1x1 --lights 4 --warmup 0").status, 0);
    for (const char* size : {"0x5", "5", "-3x4", "99999x99999", "5x5x5", "axb"})
        expect_clear_error(tool(std::string("render cornell -o b.png --size ") + size), {"--size"});
    EXPECT_FALSE(fs::exists(folder / "b.png"));
}

TEST_F(CommandLine, BadArgumentsGetOneMessage) {
    expect_clear_error(tool("render no_such_scene -o a.png"), {"no_such_scene", "cornell"});
    expect_clear_error(tool("render missing.glb -o a.png"), {"missing.glb"});
    expect_clear_error(tool("render cornell -o a.jpg"), {"a.jpg", ".png"});
    expect_clear_error(tool("render cornell -o a.png --no-such-flag"), {"--no-such-flag"});
    expect_clear_error(tool("render cornell -o a.png --set clamp_scale=nan"), {"clamp_scale"});
    expect_clear_error(tool("render cornell -o a.png --set no_such=1"), {"no_such", "shadow_map_resolution"});
    expect_clear_error(tool("render cornell -o a.png --set shadow_map_bits=24"), {"16 or 32"});
    expect_clear_error(tool("render cornell -o a.png --lights 65537"), {"--lights"});
    expect_clear_error(tool("render cornell -o a.png --camera nowhere"), {"nowhere", "view"});
    expect_clear_error(tool("render cornell -o a.png --camera 1,1,1,1,1,1,40"), {"--camera"});
    expect_clear_error(tool("render cornell -o a.png --device no_such_device"), {"no_such_device"});
    expect_clear_error(tool("render cornell -o no/such/folder/a.png" + small), {"a.png"});
    expect_clear_error(tool("compare a.png b.png"), {"a.png"});
    expect_clear_error(tool("bench no_such_suite"), {"no_such_suite"});
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(CommandLine, AFullDiskLeavesTheOldPicture) {
    ASSERT_EQ(tool("render cornell -o a.png" + small).status, 0);
    const std::string before = read_file(folder / "a.png").value();
    for (const char* name : {"a.png", "b.exr"}) {
        const Outcome outcome =
            shell("cd " + folder.string() + " && (ulimit -f 2; " SUNFLECK_TOOL " render cornell -o " +
                  std::string(name) + " --size 256x256 --lights 4 --warmup 0)");
        expect_clear_error(outcome, {name});
    }
    EXPECT_EQ(read_file(folder / "a.png").value(), before);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "no temporary file stays";
}

TEST_F(CommandLine, AnInterruptedReferenceGoesOn) {
    const std::string options = "reference cornell --size 96x72 --spp 256 -o ";
    ASSERT_EQ(tool(options + "whole.exr").status, 0);
    // Interrupted as soon as the first samples are reported.
    const Outcome stopped = shell("cd " + folder.string() + " && (" SUNFLECK_TOOL " " + options +
                                  "parts.exr > log 2>&1 & P=$!; for i in $(seq 600); do grep -q spp log && break; "
                                  "sleep 0.05; done; kill -INT $P; wait $P; S=$?; cat log; exit $S)");
    EXPECT_NE(stopped.status, 0) << stopped.output;
    EXPECT_FALSE(fs::exists(folder / "parts.exr"));
    ASSERT_TRUE(fs::exists(folder / "parts.exr.state")) << stopped.output;
    // Another picture must not be continued from it.
    expect_clear_error(tool("reference cornell --size 80x60 --spp 256 -o parts.exr"), {"parts.exr.state"});
    const Outcome resumed = tool(options + "parts.exr");
    ASSERT_EQ(resumed.status, 0) << resumed.output;
    EXPECT_NE(resumed.output.find("going on from"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder / "parts.exr.state"));
    EXPECT_EQ(read_file(folder / "whole.exr").value(), read_file(folder / "parts.exr").value());
}

// Files that glTF's own validator calls invalid, and what is wrong with them.
const std::map<std::string, std::string> invalid_models = {
    {"BoxTextured-glTF-techniqueWebGL/BoxTextured.gltf", "KHR_technique_webgl"}, // valid, but requires what none has
    {"BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "not finite"},
    {"IndexOutOfRange/AllIndicesOutOfRange.gltf", "index"},
    {"IndexOutOfRange/IndexOutOfRange.gltf", "index"},
    {"MissingBin/BoxTextured.gltf", "BoxTextured0.bin"},
    {"RecursiveNodes/RecursiveNodes.gltf", "cycle"},
    {"SchemaFailures/sceneWrongType.gltf", ""},
    {"TestNoRootNode/NoScene.gltf", "scene"},
    {"wrongTypes/badArray.gltf", "primitives"},
    {"wrongTypes/badExtension.gltf", "extensions"},
    {"wrongTypes/badNumber.gltf", ""},
    {"wrongTypes/badObject.gltf", "pbrMetallicRoughness"},
    {"wrongTypes/badString.gltf", "text"},
    {"wrongTypes/badUint.gltf", "index"}};

std::vector<fs::path> sample_models() {
    std::vector<fs::path> files;
    for (const char* place : {"/usr/share/assimp/models/glTF2", SUNFLECK_SOURCE_DIR "/../shared/assets",
                              SUNFLECK_SOURCE_DIR "/tests/corpus/gltf"}) {
        std::error_code code;
        for (const auto& entry : fs::recursive_directory_iterator(place, code))
            if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
                files.push_back(entry.path());
    }
    return files;
}

// The short size renders every eighteenth of the valid ones.
TEST_F(CommandLine, EverySampleModelRendersOrSaysWhatIsWrong) {
    const std::vector<fs::path> files = sample_models();
    if (files.size() < 20)
        std::printf("only %zu models are here; assimp-testmodels has more\n", files.size());
    const bool thin_out = !tests::long_size() && files.size() >= 20;
    int rendered = 0, valid = 0;
    for (const fs::path& file : files) {
        std::string problem;
        bool invalid = false;
        for (const auto& [name, what] : invalid_models)
            if (file.string().ends_with(name)) {
                invalid = true;
                problem = what;
            }
        if (!invalid && thin_out && valid++ % 18 != 0)
            continue;
        const Outcome outcome =
            tool("render '" + file.string() + "' -o model.png --validation --set patch_levels=1" + small);
        if (invalid) {
            expect_clear_error(outcome, {file.filename().string(), problem});
            continue;
        }
        EXPECT_EQ(outcome.status, 0) << file << ": " << outcome.output;
        ++rendered;
    }
    EXPECT_GE(rendered, 2);
}

TEST_F(CommandLine, SceneFilesBringTheirSettings) {
    fs::copy(SUNFLECK_SOURCE_DIR "/tests/corpus/gltf/square.gltf", folder / "square.gltf");
    ASSERT_TRUE(write_file(folder / "a.scene.json",
                           R"({"sunfleck_scene":2,"gltf":"square.gltf","settings":{"lights":12,"bounces":2}})"));
    const auto lights = [&](const std::string& extra) {
        const Outcome outcome = tool("render a.scene.json -o a.png --stats a.json --size 32x24 --warmup 0" + extra);
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        return nlohmann::json::parse(read_file(folder / "a.json").value())["settings"]["lights"].get<int>();
    };
    EXPECT_EQ(lights(""), 12);
    EXPECT_EQ(lights(" --lights 8"), 8);
    EXPECT_EQ(lights(" --set lights=9"), 9);
    ASSERT_TRUE(
        write_file(folder / "b.scene.json", R"({"sunfleck_scene":2,"gltf":"square.gltf","settings":{"lamps":1}})"));
    expect_clear_error(tool("render b.scene.json -o b.png" + small), {"lamps"});
}

TEST_F(CommandLine, MisspelledWordsAreCorrected) {
    expect_clear_error(tool("rendr cornell -o a.png"), {"'rendr'", "did you mean 'render'?"});
    expect_clear_error(tool("refrence cornell"), {"did you mean 'reference'?"});
    const Outcome far_off = tool("paint cornell");
    expect_clear_error(far_off, {"'paint'", "--help"});
    EXPECT_EQ(far_off.output.find("did you mean"), std::string::npos) << far_off.output;
    expect_clear_error(tool("render cornel -o a.png"), {"did you mean 'cornell'?"});
    expect_clear_error(tool("render cornell -o a.png --view irradance"), {"did you mean 'irradiance'?"});
}

TEST_F(CommandLine, EveryCommandHasHelpWithAnExample) {
    for (const char* command : {"", "render", "reference", "compare", "bench", "info"}) {
        const Outcome outcome = tool(std::string(command) + " --help");
        EXPECT_EQ(outcome.status, 0);
        EXPECT_NE(outcome.output.find("Example:"), std::string::npos) << command;
    }
    const Outcome info = tool("info --json");
    ASSERT_EQ(info.status, 0) << info.output;
    EXPECT_TRUE(nlohmann::json::parse(info.output).contains("driver"));
    const Outcome reference = tool("info --reference");
    ASSERT_EQ(reference.status, 0) << reference.output;
    EXPECT_NE(reference.output.find("| `lights` * |"), std::string::npos) << reference.output;
}

} // namespace
} // namespace sunfleck
