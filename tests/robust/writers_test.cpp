// Every kind of file that the programs write: whatever fails in a write, the old or the new is there, whole; an error
// says what and where; nothing else is left; and the same write works once the disk does.
#include "tests/robust/writers.h"

#include "editor/command_line/commands.h"
#include "editor/gate/html_report.h"
#include "editor/gate/picture_store.h"
#include "editor/gate/triples.h"
#include "engine/core/file.h"
#include "engine/core/output.h"
#include "engine/io/image.h"
#include "engine/simulation/input_recording.h"
#include "game_demo/demo_settings.h"
#include "game_demo/game/checkpoint_files.h"
#include "game_demo/state_file.h"
#include "gi_module/reference/accumulation_file.h"
#include "gi_module/transfer/transfer_data.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"
#include "viewer/trace.h"

#include <map>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::Writer;

// 0 or 1: the one of both texts that the file has.
int which_text(const fs::path& path, const std::function<std::string(int)>& text) {
    const auto content = read_file(path);
    return !content ? -1 : *content == text(0) ? 0 : *content == text(1) ? 1 : -1;
}

class RobustWriters : public testing::Test {
protected:
    fs::path at(const std::string& name) const { return folder / ("files/" + name); }
    enum class Amount { all, some };
    void expect_old_or_new(const Writer& writer, Amount amount = Amount::all) const {
        tests::FailingWriter failing(folder / "files", writer);
        const tests::WriterCounts counts = amount == Amount::all ? failing.try_all() : failing.try_some();
        std::printf("%s: %d tried, %d refused, %d written\n", writer.name.c_str(), counts.tried, counts.refused,
                    counts.written);
    }
    void SetUp() override { fs::create_directory(folder / "files"); }

    tests::Folder folder{"sunfleck_writers"};
};

gi::reference::Accumulation accumulation_of(int which) {
    gi::reference::Accumulation result;
    result.width = 60;
    result.height = 40;
    result.samples = std::uint32_t(which + 1);
    result.sums.assign(std::size_t(3 * 60 * 40), which + 0.5);
    result.counts.assign(60 * 40, result.samples);
    result.covered.assign(60 * 40, 1);
    result.rays = std::uint64_t(which);
    return result;
}

// Of two generations, as in a run that has saved before and goes on saving.
TEST_F(RobustWriters, TheStateOfAReference) {
    std::optional<gi::reference::SavedAccumulation> state;
    const auto write = [&](int which) {
        if (which == 1)
            return state->save(accumulation_of(1));
        state.emplace(at("a.exr.state"), 7);
        EXPECT_TRUE(state->save(accumulation_of(0)));
        return state->save(accumulation_of(0));
    };
    const auto read = [&] {
        const auto loaded = gi::reference::SavedAccumulation(at("a.exr.state"), 7).load();
        if (!loaded || loaded->samples == 0)
            return -1;
        const int which = int(loaded->rays);
        return loaded->sums == accumulation_of(which).sums && loaded->counts == accumulation_of(which).counts ? which
                                                                                                              : -1;
    };
    expect_old_or_new({"state of a reference", write, read});
}

TEST_F(RobustWriters, PrecomputedTransfer) {
    const auto data_of = [](int which) {
        gi::TransferData data;
        data.vertices = 300;
        data.rows.resize(300 * gi::transfer_orders);
        for (gi::Harmonics& row : data.rows)
            std::memset(&row, which + 1, sizeof row);
        return data;
    };
    const auto read = [&] {
        const auto data = gi::read_transfer(at("cache"), 5, 300);
        for (const int which : {0, 1})
            if (data && std::memcmp(data->rows.data(), data_of(which).rows.data(),
                                    data->rows.size() * sizeof(gi::Harmonics)) == 0)
                return which;
        return -1;
    };
    expect_old_or_new(
        {"precomputed transfer", [&](int which) { return gi::write_transfer(at("cache"), 5, data_of(which)); }, read});
}

TEST_F(RobustWriters, Recordings) {
    const auto steps_of = [](int which) {
        return std::vector<simulation::StepInput>(std::size_t(500 + which), {which, 0, 0, 0, 0});
    };
    const auto read = [&] {
        const auto steps = simulation::read_recording(at("a.rec"));
        return !steps ? -1 : *steps == steps_of(0) ? 0 : *steps == steps_of(1) ? 1 : -1;
    };
    expect_old_or_new(
        {"recording", [&](int which) { return simulation::write_recording(at("a.rec"), steps_of(which)); }, read});
    // As --record does: on another thread while the game goes on, and all of it in the end.
    const auto record = [&](int which) {
        simulation::RecordingWriter writer(at("a.rec"));
        for (const simulation::StepInput& step : steps_of(which))
            writer.add(step);
        writer.save_if_due();
        return writer.finish();
    };
    expect_old_or_new({"recording that grows", record, read, true, true});
}

TEST_F(RobustWriters, FilesOfTheDemo) {
    const auto settings_of = [](int which) {
        demo::DemoSettings settings;
        settings.light_samples = std::uint32_t(100 + which);
        return settings;
    };
    const auto read = [&] {
        const demo::LoadedSettings loaded = demo::load_settings(at("demo.json"));
        const int which = int(loaded.settings.light_samples) - 100;
        return loaded.problem.empty() && loaded.found && (which == 0 || which == 1) ? which : -1;
    };
    expect_old_or_new({"settings of the demo",
                       [&](int which) { return demo::save_settings(at("demo.json"), settings_of(which)); }, read});

    const auto write_state = [&](int which) {
        demo::StateFile file(at("state").string());
        static_cast<void>(file.write([&] {
            demo::GameState state;
            state.screen = which == 0 ? "title" : "playing";
            return state;
        }));
        return file.finish();
    };
    const auto read_state = [&] {
        const auto text = read_file(at("state"));
        const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
        const std::string screen = json.is_object() ? json.value("screen", "") : "";
        return screen == "title" ? 0 : screen == "playing" ? 1 : -1;
    };
    expect_old_or_new({"--state of the demo", write_state, read_state, false, true});
}

// Of the newest and the one before it, the newest that is there is what is loaded.
TEST_F(RobustWriters, Checkpoints) {
    const auto text_of = [](int which) { return std::string(20'000, char('a' + which)); };
    const demo::CheckpointFiles files(at("games"), "lantern_game");
    const auto read = [&] {
        const int newest = which_text(files.newest(), text_of);
        if (fs::exists(files.older()) && which_text(files.older(), text_of) < 0)
            return -1;
        return newest;
    };
    expect_old_or_new({"checkpoint", [&](int which) { return files.write(text_of(which)); }, read});
}

TEST_F(RobustWriters, Pictures) {
    const auto picture_of = [](int which) {
        return io::Picture{40, 30, std::vector<vec4>(1200, vec4(0.2f + 0.4f * float(which)))};
    };
    for (const char* name : {"a.png", "a.exr"}) {
        const auto read = [&] {
            const auto picture = io::read_picture(at(name));
            if (!picture || picture->pixels.size() != 1200)
                return -1;
            for (const int which : {0, 1})
                if (std::abs(picture->pixels[1199].x - picture_of(which).pixels[1199].x) < 0.01f)
                    return which;
            return -1;
        };
        expect_old_or_new({name, [&](int which) { return io::write_picture(at(name), picture_of(which)); }, read});
    }
}

TEST_F(RobustWriters, GeometryAndTraces) {
    tests::GltfBuilder square;
    square.add_square();
    const auto export_named = [&](int which) {
        tests::World world;
        EXPECT_TRUE(world.import(square.glb()));
        const ecs::Entity entity = world.registry.create();
        world.registry.emplace<scene::Name>(entity, {which == 0 ? "old" : "new"});
        world.registry.emplace<scene::Transform>(entity, {});
        return io::export_gltf(at("a.glb"), world.registry, world.meshes, world.textures);
    };
    const auto read_named = [&] {
        tests::World world;
        if (!io::load_scene(at("a.glb"), world.registry, world.meshes, world.textures))
            return -1;
        return !scene::find_by_name(world.registry, "old").is_null()   ? 0
               : !scene::find_by_name(world.registry, "new").is_null() ? 1
                                                                       : -1;
    };
    expect_old_or_new({"geometry", export_named, read_named});

    const auto trace = [&](int which) {
        viewer::FrameStatistics frame;
        frame.frame_ms = which;
        viewer::Trace frames;
        frames.add(frame);
        return frames.write(at("a.json"));
    };
    const auto read_trace = [&] {
        const auto text = read_file(at("a.json"));
        const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
        return json.is_object() ? int(json["traceEvents"].back()["dur"].get<double>() / 1e3) : -1;
    };
    expect_old_or_new({"trace", trace, read_trace});
}

TEST_F(RobustWriters, FilesOfTheGate) {
    const auto triple = [&](int which) {
        gate::Triple one;
        one.number = std::uint32_t(which);
        one.hello = {"device", "driver", "walk", "8x8", 600, false, {}};
        return one;
    };
    const auto append = [&](int which) {
        const auto there = gate::read_triples(at("triples"));
        if (which == 1 && there && there->size() > 1)
            return Status(); // it is there
        return gate::append_triple(at("triples"), triple(which));
    };
    const auto read_last = [&] {
        const auto triples = gate::read_triples(at("triples"));
        return triples && !triples->empty() && triples->size() == triples->back().number + 1
                   ? int(triples->back().number)
                   : -1;
    };
    expect_old_or_new({"samples of the self-test", append, read_last});

    const auto picture_of = [](int which) { return std::string(9'000, char('a' + which)); };
    const fs::path drawn[] = {folder / "drawn0", folder / "drawn1"};
    for (const int which : {0, 1}) {
        fs::create_directory(drawn[which]);
        ASSERT_TRUE(write_file(drawn[which] / "a.png", picture_of(which)));
    }
    const auto accept = [&](int which) {
        const gate::Hello hello{"device", "driver", std::to_string(which), "8x8", 600, true, {}};
        const auto written = gate::accept_pictures({at("stored"), {}, {}, {}, {}, {{"a", 5}}}, hello, drawn[which]);
        return written ? Status() : Status(written.error());
    };
    const auto read_store = [&] {
        const auto store = gate::read_picture_store(at("stored"));
        const int picture = which_text(at("stored/a.png"), picture_of);
        // The manifest comes last.
        return store && picture >= std::stoi(store->recording) ? std::stoi(store->recording) : -1;
    };
    expect_old_or_new({"stored pictures", accept, read_store});

    const char* remarks[] = {"the old report", "the new report"};
    const auto report = [&](int which) {
        gate::GateRun run;
        run.weaker = remarks[which];
        return gate::write_html_report(at("report.html"), run);
    };
    const auto read_report = [&] {
        const auto text = read_file(at("report.html"));
        if (!text || !text->ends_with("</html>\n"))
            return -1;
        return text->find(remarks[0]) != std::string::npos ? 0 : text->find(remarks[1]) != std::string::npos ? 1 : -1;
    };
    expect_old_or_new({"report of the gate", report, read_report});
}

// Commands as a whole, with what they read and what they try before they begin.
TEST_F(RobustWriters, ReferenceAndCompare) {
    tests::GltfBuilder square;
    square.add_square();
    ASSERT_TRUE(write_file(folder / "square.glb", square.glb()));
    const auto trace = [&](int which) {
        command_line::ReferenceOptions options;
        options.scene.scene = (folder / "square.glb").string();
        options.scene.size = {8, 6};
        options.scene.lighting["seed"] = std::to_string(which + 1);
        options.samples = 1;
        options.output = at("a.exr").string();
        options.statistics = at("a.json").string();
        return command_line::reference(options);
    };
    std::string whole[2];
    for (const int which : {0, 1}) {
        ASSERT_TRUE(trace(which));
        whole[which] = read_file(at("a.exr")).value();
    }
    const auto read = [&] {
        const auto statistics = read_file(at("a.json"));
        return statistics && nlohmann::json::accept(*statistics)
                   ? which_text(at("a.exr"), [&](int which) { return whole[which]; })
                   : -1;
    };
    // Where only --stats fails, the picture is new.
    expect_old_or_new({"reference", trace, read, true}, Amount::some);

    const auto picture_of = [](int which) {
        return io::Picture{40, 30, std::vector<vec4>(1200, vec4(0.2f + 0.4f * float(which)))};
    };
    for (const int which : {0, 1})
        ASSERT_TRUE(io::write_picture(folder / std::to_string(which).append(".png"), picture_of(which)));
    const auto compare = [&](int which) {
        return command_line::compare({(folder / "0.png").string(),
                                      (folder / std::to_string(which).append(".png")).string(),
                                      at("difference.png").string(), true});
    };
    const auto read_difference = [&] {
        const auto picture = io::read_picture(at("difference.png"));
        return !picture || picture->pixels.size() != 1200 ? -1 : picture->pixels[7].x > 0.1f ? 1 : 0;
    };
    expect_old_or_new({"compare --diff", compare, read_difference}, Amount::some);
}

// Where the sources write, and where that is tried. All of them but the journal and the lock call write_file.
TEST(RobustWriterList, HasEachPlaceOfTheSources) {
    const std::string text_at_the_end = "one text, written when all else is done";
    const std::map<std::string, std::string> known = {
        {"engine/core/output.cpp", "RobustWriteFaults"},
        {"engine/io/scene_file.cpp", "RobustWriteFaults.ASceneIsOldOrNew"},
        {"engine/io/sky_pictures.cpp", "one picture under a new name, by write_file"},
        {"engine/io/image.cpp", "RobustWriters.Pictures"},
        {"engine/io/gltf_export.cpp", "RobustWriters.GeometryAndTraces"},
        {"engine/simulation/input_recording.cpp", "RobustWriters.Recordings"},
        {"gi_module/reference/accumulation_file.cpp", "RobustWriters.TheStateOfAReference"},
        {"gi_module/transfer/transfer_cache.cpp", "RobustWriters.PrecomputedTransfer"},
        {"viewer/trace.cpp", "RobustWriters.GeometryAndTraces"},
        {"game_demo/demo_settings.cpp", "RobustWriters.FilesOfTheDemo"},
        {"game_demo/state_file.cpp", "RobustWriters.FilesOfTheDemo"},
        {"game_demo/game/checkpoint_files.cpp", "RobustWriters.Checkpoints"},
        {"game_demo/game/solution_run.cpp", text_at_the_end},
        {"game_demo/headless.cpp", text_at_the_end},
        {"editor/command_line/reference_command.cpp", "RobustWriters.ReferenceAndCompare"},
        {"editor/command_line/render_command.cpp", text_at_the_end},
        {"editor/command_line/bench_command.cpp", text_at_the_end},
        {"editor/command_line/bench_level.cpp", text_at_the_end},
        {"editor/command_line/bench_picture.cpp", "one text, replaced after each row"},
        {"editor/command_line/bench_self_test.cpp", "one text, replaced after each amount"},
        {"editor/gate/html_report.cpp", "RobustWriters.FilesOfTheGate"},
        {"editor/gate/picture_store.cpp", "RobustWriters.FilesOfTheGate"},
        {"editor/gate/triples.cpp", "RobustWriters.FilesOfTheGate"},
        {"editor/gate/self_test_builds.cpp", "programs of a run's own, which go with it"},
        {"editor/document/journal.cpp", "EditorJournalFaults"},
        {"editor/panels/profile.cpp", "one text under a new name"},
        {"editor/window/presets.cpp", "EditorWriters"},
        {"editor/window/state_file.cpp", "EditorWriters"},
        {"editor/window/script_files.cpp", "EditorWriters"},
        {"editor/window/recovery.cpp", "EditorWriters"},
    };
    std::set<std::string> listed, found;
    for (const auto& [file, where] : known)
        listed.insert(file);
    const fs::path root = SUNFLECK_SOURCE_DIR;
    for (const char* folder : {"engine", "gi_module", "viewer", "game_demo", "editor", "assets"})
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            if (entry.path().extension() != ".cpp")
                continue;
            const std::string text = read_file(entry.path()).value();
            for (const char* word : {"write_file(", "write_all(", "ofstream", "O_WRONLY", "O_RDWR", "fopen("})
                if (text.find(word) != std::string::npos)
                    found.insert(fs::relative(entry.path(), root).string());
        }
    EXPECT_EQ(found, listed);
}

} // namespace
} // namespace sunfleck
