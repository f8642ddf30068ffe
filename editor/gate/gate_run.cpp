#include "editor/gate/gate_run.h"

#include <algorithm>
#include <chrono>

namespace sunfleck::gate {
namespace {

// A name that no program counts is a mistake of spelling: nothing would be accepted.
Status check_accepted(const GateRunOptions& options, const Frame& base, const Frame& head) {
    for (const std::string& name : options.accepted_counters)
        if (!base.counters.count(name) && !head.counters.count(name))
            return Error{"--accept-counters '" + name + "': neither base nor head has such a counter"};
    return {};
}

Status measure_work(const Programs& programs, const GateRunOptions& options, GateRun& run) {
    if (!options.check_work)
        return {};
    WorkCheckOptions work_options = options.work;
    work_options.folder = options.folder;
    if (options.store)
        work_options.pictures = options.store->frames;
    SUNFLECK_ASSIGN(const WorkCheck work, check_work(programs, work_options));
    SUNFLECK_ASSIGN(run.pictures, compare_pictures(work, options.folder));
    if (options.store) {
        SUNFLECK_ASSIGN(run.stored, compare_with_store(*options.store, work.head, options.folder / "head"));
    }
    SUNFLECK_TRY(check_accepted(options, work.frames.front().base, work.frames.front().head));
    return run.comparison.add(work);
}

} // namespace

bool GateRun::pictures_changed() const {
    const auto has_fault = [](const PictureResult& result) { return !result.fault.empty(); };
    return std::any_of(pictures.begin(), pictures.end(), has_fault) ||
           std::any_of(stored.begin(), stored.end(), has_fault);
}

Result<GateRun> measure(const Programs& programs, const GateRunOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    GateRun run{Comparison(options.accepted_counters), {}, 0.0, {}, {}, {}};
    SUNFLECK_TRY(measure_work(programs, options, run));
    run.report.next_look = options.gate.looks.empty() ? 1 : options.gate.looks.front();
    while (run.report.next_look > 0) {
        while (run.comparison.pairs() < run.report.next_look) {
            options.progress(run.comparison.pairs(), run.report.next_look);
            SUNFLECK_ASSIGN(const PairRun pair,
                            run_pair(programs, options.pair, run.comparison.pairs(), options.patience));
            if (run.comparison.pairs() == 0)
                SUNFLECK_TRY(check_accepted(options, pair.frames.front().base, pair.frames.front().head));
            SUNFLECK_TRY(run.comparison.add(pair));
        }
        SUNFLECK_ASSIGN(run.report, run.comparison.judge(options.gate));
    }
    run.minutes = std::chrono::duration<double, std::ratio<60>>(std::chrono::steady_clock::now() - start).count();
    return run;
}

Outcome outcome_of(const GateRun& run) {
    if (run.report.verdict == statistics::Verdict::slower)
        return Outcome::slower;
    if (run.comparison.work_changed() || run.pictures_changed())
        return Outcome::changed;
    return run.report.verdict == statistics::Verdict::fine ? Outcome::fine : Outcome::cannot_tell;
}

} // namespace sunfleck::gate
