#include "editor/command_line/gate_commands.h"

#include "editor/command_line/bench_compare.h"
#include "editor/command_line/common.h"
#include "editor/gate/picture_store.h"
#include "engine/core/output.h"
#include "engine/core/stop_signals.h"

#include "viewer/options.h"

namespace sunfleck::command_line {
namespace {

constexpr std::int64_t most_pairs = 1'000'000; // at a look of the gate

void add_level_options(CLI::App& app, LevelOptions& options) {
    viewer::add_name(app, "--scene", options.scene, "A built-in scene, or a .scene.json, .gltf or .glb file")
        ->capture_default_str();
    viewer::add_name(app, "--input", options.input, "Recorded input to play (default: the scene's own walk)", "FILE");
    app.add_option("--size", options.size, "Rendered size")
        ->type_name("WIDTHxHEIGHT")
        ->check([](const std::string& text) {
            const auto size = viewer::size_value(text);
            return size ? std::string() : size.error().message;
        })
        ->capture_default_str();
    viewer::add_choice(app, "--preset", options.preset, {"software", "low", "medium", "high", "ultra"}, "Quality")
        ->capture_default_str();
    app.add_option("--set", options.settings, "Lighting setting as name=value; repeatable (see sunfleck info)")
        ->type_name("NAME=VALUE")
        ->check(setting_problem);
    viewer::add_whole(app, "--steps-per-frame", options.steps_per_frame, 1, 60, "Simulation steps of 1/60 s a frame");
    viewer::add_name(app, "--device", options.device, "Vulkan device by number or part of its name");
}

// What was printed is part of what was asked for: where it did not arrive, the status is no verdict.
int status_of(const Status& done) {
    return exit_status(done ? flush_standard_output() : done, int(gate::Outcome::error));
}
int outcome_status(const Result<gate::Outcome>& outcome) {
    const int status = status_of(outcome ? Status() : Status(outcome.error()));
    return status == exit_done ? int(*outcome) : status;
}

std::function<int()> add_level(CLI::App& bench, CLI::App*& app) {
    auto options = std::make_shared<LevelOptions>();
    app = bench.add_subcommand("level", "Plays a recorded walk and writes times and counters of every frame");
    app->footer("Example: sunfleck bench level --frames 200 -o level.json\n"
                "Without -o the JSON goes to standard output. docs/gate.md describes it.");
    add_level_options(*app, *options);
    viewer::add_whole(*app, "--frames", options->frames, 0, gate::most_frames,
                      "Frames to measure (0: to the end of the recording)");
    viewer::add_whole(*app, "--warmup", options->warmup, 0, gate::most_frames / 2, "Frames before those");
    viewer::add_name(*app, "-o,--output", options->output, "JSON file to write", "FILE");
    viewer::add_flag(*app, "--serve", options->serve, "Draw what the gate asks for on standard input (docs/gate.md)");
    return [options] {
        watch_interrupts();
        return status_of(bench_level(*options));
    };
}

std::function<int()> add_compare(CLI::App& bench, CLI::App*& app) {
    auto options = std::make_shared<CompareRunOptions>();
    app =
        bench.add_subcommand("compare", "Has a change made a pass slower? Base and head draw the same frames in turns");
    app->footer("Example: sunfleck bench compare old/bin/sunfleck new/bin/sunfleck\n"
                "BASE and HEAD are programs, which then run `bench level --serve` with the options below, or command\n"
                "lines in quotes that speak the gate's protocol (docs/gate.md); or two files of `bench level`, for a\n"
                "weaker verdict. Exit status: 0 fine, 1 slower, 2 error, 3 cannot tell, 4 work or pictures changed.");
    app->add_option("BASE", options->base, "The program before the change");
    app->add_option("HEAD", options->head, "The program after it");
    viewer::add_name(*app, "--base", options->base_revision,
                     "Build BASE from this revision of the project; the program named is HEAD (default: this one)");
    add_level_options(*app, options->level);
    viewer::add_name(*app, "--stored", options->stored, "Folder of stored pictures that head must draw, too", "FOLDER");
    viewer::add_name(*app, "--report", options->report, "Write a report as one HTML file", "FILE");
    app->add_option("--accept-counters", options->accepted_counters, "Counter that was meant to change; repeatable")
        ->check([](const std::string& text) { return text.empty() ? std::string("a name is needed") : std::string(); });
    viewer::add_real(*app, "--time-limit", options->time_limit, 0.1, 1e6,
                     "Seconds that a program may take for an answer");
    app->add_option("--looks", options->looks, "Numbers of pairs at which a verdict is sought")
        ->type_name("N,N,...")
        ->delimiter(',')
        ->check([](const std::string& text) {
            const auto count = viewer::whole_value(text, 1, most_pairs);
            return count ? std::string() : count.error().message;
        })
        ->capture_default_str();
    viewer::add_flag(*app, "--skip-work", options->skip_work, "Measure time alone: not all frames' counters");
    viewer::add_whole(*app, "--turns", options->pair.turns, 1, 10000, "Turns of each process in a pair");
    viewer::add_whole(*app, "--seed", options->pair.seed, 0, 4294967295, "Which frames are drawn, and in which order");
    auto self_test = std::make_shared<SelfTestCommandOptions>();
    auto is_self_test = std::make_shared<bool>(false);
    viewer::add_flag(*app, "--self-test", *is_self_test,
                     "How often does the gate err here? Builds the project many times over; takes hours, and goes on\n"
                     "where it was stopped");
    viewer::add_whole(*app, "--triples", self_test->triples, 1, 100000,
                      "Of the self-test: base, a rebuild and a slower build at once");
    viewer::add_whole(*app, "--rebuilds", self_test->rebuilds, 1, 99,
                      "Of the self-test: builds of the same source with other bytes");
    viewer::add_name(*app, "--folder", self_test->folder, "Of the self-test: for builds and triples", "FOLDER");
    return [options, self_test, is_self_test] {
        watch_interrupts();
        if (*is_self_test) {
            self_test->level = options->level;
            self_test->looks = options->looks;
            self_test->pair = options->pair;
            self_test->time_limit = options->time_limit;
            return outcome_status(bench_self_test(*self_test));
        }
        return outcome_status(bench_compare(*options));
    };
}

std::function<int()> add_pictures(CLI::App& bench, CLI::App*& app) {
    auto options = std::make_shared<PicturesOptions>();
    app = bench.add_subcommand("pictures", "Does a program still draw the stored pictures of named frames?");
    app->footer(
        "Example: sunfleck bench pictures --stored tests/images/level --steps-per-frame 30 --set baked_samples=0\n"
        "Equal to the bit on the processor and driver that they were drawn on, within limits elsewhere\n"
        "(docs/gate.md). Exit status: 0 fine, 2 error, 4 pictures changed.");
    app->add_option("PROGRAM", options->program, "As HEAD of `bench compare` (default: this one)");
    viewer::add_name(*app, "--stored", options->stored, "Folder of stored pictures", "FOLDER")->required();
    viewer::add_flag(*app, "--accept", options->accept, "Store what is drawn now, and list what was written");
    app->add_option("--frame", options->frames, "Frame to store or compare; repeatable")
        ->type_name("NAME=FRAME")
        ->check([](const std::string& text) {
            const auto frame = gate::parse_named_frame(text);
            return frame ? std::string() : frame.error().message;
        });
    viewer::add_name(*app, "--differences", options->differences, "Folder for pictures of the differences, times eight",
                     "FOLDER");
    viewer::add_real(*app, "--time-limit", options->time_limit, 0.1, 1e6,
                     "Seconds that the program may take for an answer");
    add_level_options(*app, options->level);
    return [options] {
        watch_interrupts();
        return outcome_status(bench_pictures(*options));
    };
}

} // namespace

std::function<bool(int&)> add_gate_commands(CLI::App& bench) {
    CLI::App *level = nullptr, *compare = nullptr, *pictures = nullptr;
    const auto run_level = add_level(bench, level);
    const auto run_compare = add_compare(bench, compare);
    const auto run_pictures = add_pictures(bench, pictures);
    return [=](int& status) {
        for (const auto& [app, run] : {std::pair{level, run_level}, {compare, run_compare}, {pictures, run_pictures}})
            if (app->parsed()) {
                status = run();
                return true;
            }
        return false;
    };
}

} // namespace sunfleck::command_line
