#include "editor/command_line/bench_compare.h"

#include "editor/gate/verdict_text.h"

#include <cstdio>

namespace sunfleck::command_line {
namespace {

// A program alone plays the level with the gate's options; a command line is taken as it is.
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

} // namespace

Result<gate::Outcome> bench_compare(const CompareRunOptions& options) {
    if (options.base.empty() || options.head.empty())
        return Error{"BASE and HEAD are needed: two programs"};
    gate::Programs programs;
    SUNFLECK_ASSIGN(programs.base, command_of(options.base, options.level));
    SUNFLECK_ASSIGN(programs.head, command_of(options.head, options.level));
    gate::GateRunOptions run_options;
    run_options.pair = options.pair;
    run_options.gate.looks = options.looks;
    run_options.patience = {options.time_limit, [] { return interrupted(); }};
    run_options.accepted_counters = {options.accepted_counters.begin(), options.accepted_counters.end()};
    run_options.check_work = !options.skip_work;
    run_options.work.patience = run_options.patience;
    Progress work_progress("work of every frame"), progress("time");
    run_options.work.progress = [&](double share) { work_progress.show(share, ""); };
    run_options.progress = [&](std::uint32_t done, std::uint32_t needed) {
        progress.show(double(done) / needed,
                      "pair " + std::to_string(done + 1) + " of " + std::to_string(needed) + " to the next look");
    };
    SUNFLECK_ASSIGN(const gate::GateRun run, gate::measure(programs, run_options));
    std::fputs(gate::verdict_text(run).c_str(), stdout);
    return gate::outcome_of(run);
}

} // namespace sunfleck::command_line
