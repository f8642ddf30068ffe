// Measures pairs until the gate has a verdict.
#pragma once

#include "editor/gate/comparison.h"
#include "engine/core/exit_status.h"

namespace sunfleck::gate {

// Exit statuses of `bench compare`.
enum class Outcome {
    fine = exit_done,
    slower = exit_failed,
    error = exit_usage,
    cannot_tell = exit_cannot_tell,
    changed = exit_changed
};

struct GateRunOptions {
    PairOptions pair;
    statistics::GateOptions gate;
    Patience patience;
    std::set<std::string> accepted_counters;
    bool check_work = true;            // every frame's counters, and pictures, before time is measured
    WorkCheckOptions work;             // `pictures` and `folder` are filled in from the next two
    std::optional<PictureStore> store; // stored pictures that head's must equal
    std::filesystem::path folder;      // for pictures; stays
    // Before each pair: pairs so far, and how many the next look needs.
    std::function<void(std::uint32_t done, std::uint32_t needed)> progress = [](std::uint32_t, std::uint32_t) {};
};

struct GateRun {
    Comparison comparison;
    statistics::GateReport report;
    double minutes = 0.0;
    std::string weaker;                  // why the verdict is worth less than one of pairs; empty: it is not
    std::vector<PictureResult> pictures; // head against base
    std::vector<PictureResult> stored;   // head against the stored ones

    bool pictures_changed() const;
};

Result<GateRun> measure(const Programs& programs, const GateRunOptions& options);

// "slower" comes first: what a change of work costs is what one wants to know of it.
Outcome outcome_of(const GateRun& run);

} // namespace sunfleck::gate
