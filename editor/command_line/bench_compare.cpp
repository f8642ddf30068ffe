#include "editor/command_line/bench_compare.h"

#include "editor/command_line/metrics.h"
#include "editor/gate/html_report.h"
#include "editor/gate/level_file.h"
#include "editor/gate/revision_build.h"
#include "editor/gate/verdict_text.h"
#include "engine/core/output.h"

#include <algorithm>
#include <cstdio>
#include <functional>

namespace sunfleck::command_line {
namespace {

gate::Patience patience_of(double seconds) {
    return {seconds, [] { return interrupted(); }};
}

bool is_level_file(const std::string& side) {
    return std::filesystem::path(side).extension() == ".json";
}

std::set<std::string> accepted_of(const CompareRunOptions& options) {
    return {options.accepted_counters.begin(), options.accepted_counters.end()};
}

// With --base REV, the one program that is named is head; if none is, this one.
Result<gate::Programs> programs_of(const CompareRunOptions& options) {
    std::string base = options.base, head = options.head;
    if (!options.base_revision.empty()) {
        if (!options.head.empty())
            return Error{"--base stands for the program BASE: one program at most can be named beside it"};
        head = base.empty() ? "/proc/self/exe" : base;
        constexpr double build_seconds = 7200.0;
        SUNFLECK_ASSIGN(
            const std::filesystem::path built,
            gate::build_revision(options.base_revision, patience_of(build_seconds),
                                 [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); }));
        base = built.string();
    }
    if (base.empty() || head.empty())
        return Error{"BASE and HEAD are needed: two programs, or two files of `bench level`"};
    gate::Programs programs;
    SUNFLECK_ASSIGN(programs.base, command_of(base, options.level));
    SUNFLECK_ASSIGN(programs.head, command_of(head, options.level));
    return programs;
}

Result<gate::GateRunOptions> run_options_of(const CompareRunOptions& options) {
    gate::GateRunOptions run;
    run.pair = options.pair;
    run.gate.looks = options.looks;
    run.patience = patience_of(options.time_limit);
    run.accepted_counters = accepted_of(options);
    run.check_work = !options.skip_work;
    run.work.patience = run.patience;
    if (options.stored.empty())
        return run;
    if (options.skip_work)
        return Error{"--stored: pictures are drawn while the work is compared, which --skip-work leaves out"};
    SUNFLECK_ASSIGN(run.store, gate::read_picture_store(options.stored));
    return run;
}

// A program that is named by a path, and plays the level of the options; false: a command line, which is taken as it
// is.
Result<bool> plays_level(const std::string& side) {
    if (side.empty())
        return true; // this program
    SUNFLECK_ASSIGN(const std::vector<std::string> words, gate::split_words(side));
    std::error_code code;
    if (words.size() == 1 && words[0].find('/') != std::string::npos && !std::filesystem::exists(words[0], code))
        return Error{"there is no program '" + words[0] + "'"};
    return words.size() < 2;
}

// What is wrong on the command line, before a revision is built for an hour.
Status check_options(const CompareRunOptions& options) {
    if (options.looks.empty() || options.looks.front() == 0 ||
        std::adjacent_find(options.looks.begin(), options.looks.end(), std::greater_equal<>()) != options.looks.end())
        return Error{"--looks: numbers of pairs from 1 on are needed, each greater than the one before it"};
    SUNFLECK_ASSIGN(const bool base_plays, plays_level(options.base));
    SUNFLECK_ASSIGN(const bool head_plays, plays_level(options.head));
    return base_plays || head_plays ? check_level(options.level) : Status();
}

Result<gate::GateRun> run_gate(const CompareRunOptions& options, const std::filesystem::path& folder) {
    if (is_level_file(options.base) && is_level_file(options.head))
        return gate::compare_files(options.base, options.head, accepted_of(options));
    SUNFLECK_TRY(check_options(options));
    SUNFLECK_ASSIGN(gate::GateRunOptions run_options, run_options_of(options));
    SUNFLECK_ASSIGN(const gate::Programs programs, programs_of(options));
    run_options.folder = folder;
    Progress work_progress("work of every frame"), progress("time");
    run_options.work.progress = [&](double share) { work_progress.show(share, ""); };
    run_options.progress = [&](std::uint32_t done, std::uint32_t needed) {
        progress.show(double(done) / needed,
                      "pair " + std::to_string(done + 1) + " of " + std::to_string(needed) + " to the next look");
    };
    return gate::measure(programs, run_options);
}

Status write_differences(const std::vector<gate::PictureResult>& results, const std::filesystem::path& folder) {
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    for (const gate::PictureResult& result : results) {
        if (result.difference.equal || !result.difference.same_size)
            continue;
        SUNFLECK_ASSIGN(const io::Picture stored, io::read_picture(result.stored));
        SUNFLECK_ASSIGN(const io::Picture drawn, io::read_picture(result.drawn));
        const std::filesystem::path file = folder / (result.frame.name + "_difference.png");
        SUNFLECK_TRY(io::write_picture(file, difference_picture(drawn, stored, false)));
        std::printf("wrote %s\n", file.c_str());
    }
    return {};
}

// The stored set with the frames that are named on the command line, if any are.
Result<gate::PictureStore> store_of(const PicturesOptions& options) {
    gate::PictureStore store;
    if (options.frames.empty() || !options.accept) {
        SUNFLECK_ASSIGN(store, gate::read_picture_store(options.stored));
    }
    store.folder = options.stored;
    if (!options.frames.empty())
        store.frames.clear();
    for (const std::string& text : options.frames) {
        SUNFLECK_ASSIGN(const gate::NamedFrame frame, gate::parse_named_frame(text));
        store.frames.push_back(frame);
    }
    std::sort(store.frames.begin(), store.frames.end(),
              [](const gate::NamedFrame& a, const gate::NamedFrame& b) { return a.frame < b.frame; });
    return store;
}

} // namespace

Result<std::vector<std::string>> command_of(const std::string& side, const LevelOptions& level) {
    SUNFLECK_ASSIGN(std::vector<std::string> words, gate::split_words(side));
    if (words.size() > 1)
        return words;
    words.insert(words.end(), {"bench", "level", "--serve", "--scene", level.scene, "--size", level.size, "--preset",
                               level.preset, "--steps-per-frame", std::to_string(level.steps_per_frame)});
    if (!level.input.empty())
        words.insert(words.end(), {"--input", level.input});
    if (!level.device.empty())
        words.insert(words.end(), {"--device", level.device});
    for (const std::string& setting : level.settings)
        words.insert(words.end(), {"--set", setting});
    return words;
}

Result<gate::Outcome> bench_compare(const CompareRunOptions& options) {
    const NamedFile output = {"--report", options.report};
    const NamedFile inputs[] = {{"BASE", options.base}, {"HEAD", options.head}, {"--input", options.level.input}};
    SUNFLECK_TRY(try_outputs({&output, 1}, inputs));
    SUNFLECK_ASSIGN(const auto folder, gate::TemporaryFolder::make());
    SUNFLECK_ASSIGN(const gate::GateRun run, run_gate(options, folder->path()));
    if (!options.report.empty())
        SUNFLECK_TRY(gate::write_html_report(options.report, run));
    std::fputs(gate::verdict_text(run).c_str(), stdout);
    return gate::outcome_of(run);
}

Result<gate::Outcome> bench_pictures(const PicturesOptions& options) {
    SUNFLECK_ASSIGN(const gate::PictureStore store, store_of(options));
    SUNFLECK_ASSIGN(const auto folder, gate::TemporaryFolder::make());
    SUNFLECK_ASSIGN(const auto command,
                    command_of(options.program.empty() ? "/proc/self/exe" : options.program, options.level));
    gate::WorkCheckOptions work{{}, store.frames, folder->path(), patience_of(options.time_limit), {}};
    Progress progress("pictures");
    work.progress = [&](double share) { progress.show(share, ""); };
    SUNFLECK_ASSIGN(const gate::Hello hello, gate::draw_pictures(command, work));
    if (options.accept) {
        SUNFLECK_ASSIGN(const auto written, gate::accept_pictures(store, hello, folder->path()));
        for (const std::filesystem::path& file : written)
            std::printf("wrote %s\n", file.c_str());
        return gate::Outcome::fine;
    }
    SUNFLECK_ASSIGN(const auto results, gate::compare_with_store(store, hello, folder->path()));
    bool changed = false;
    for (const gate::PictureResult& result : results) {
        changed |= !result.fault.empty();
        const std::string word = !result.fault.empty()     ? "changed: " + result.fault
                                 : result.difference.equal ? "equal"
                                                           : "alike";
        std::printf("%-20s frame %5u  FLIP %.5f  %s\n", result.frame.name.c_str(), result.frame.frame,
                    result.difference.flip, word.c_str());
    }
    if (!options.differences.empty())
        SUNFLECK_TRY(write_differences(results, options.differences));
    return changed ? gate::Outcome::changed : gate::Outcome::fine;
}

} // namespace sunfleck::command_line
