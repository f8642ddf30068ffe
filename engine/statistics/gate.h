// The frame-time gate: has a change made a pass slower? Samples are pairs of processes, never frames. The README of
// this folder has the reasons and the measured rates.
#pragma once

#include "engine/statistics/pair_summary.h"

#include <cstdint>
#include <optional>
#include <string>

namespace sunfleck::statistics {

struct GateOptions {
    // Numbers of pairs at which a verdict is sought; each look spends an equal part of the errors below.
    std::vector<std::uint32_t> looks = {12, 20, 32, 48};
    double tolerance = 0.01;         // slower by no more than this share of the row is no slow-down,
    double frame_tolerance = 0.0005; // nor by no more than this share of the whole frame
    double slower_error = 0.01;      // probability of "slower", of whichever row, where nothing is beyond the tolerance
    double harm = 0.05;              // "fine" promises that no judged row is slower by this share
    double fine_error = 0.05;        // probability of "fine" where one is
    double judged_share = 0.02;      // "fine" speaks of the rows that take at least this share of the frame
    double tested_share = 0.002;     // rows below this share are listed but not tested
    std::uint32_t flips = 4095;      // random changes of signs, where there are more than that
    std::uint32_t seed = 1;
};

enum class Verdict {
    fine,
    slower,
    cannot_tell, // yet, where GateReport::next_look is not zero
};

enum class RowKind {
    judged,  // large enough that "fine" depends on it
    small,   // between the shares tested and judged: only tested for a slow-down
    listed,  // below the tested share, or never ran in both
    added,   // never ran in base
    removed, // never ran in head
};

struct GateRow {
    std::string name;
    RowKind kind = RowKind::listed;
    double base_ms = 0.0, head_ms = 0.0; // median over pairs
    double share = 0.0;                  // of the frame; of base's or head's, whichever is greater
    std::uint32_t pairs = 0;             // in which it could be compared
    double ratio = 1.0;                  // head / base
    double low = 0.0, high = 0.0; // its interval at 95 %, not corrected for rows and looks; 0 and infinity: unknown
    double harm_limit = 0.0;      // "fine" needs this below 1 + harm
    double tolerance = 0.0;       // share by which it may be slower
    double p = 1.0;               // of a slow-down beyond the tolerance, corrected for rows and looks
    double change_ms = 0.0;       // base_ms x (ratio - 1)
    bool slower = false;
    // The least slow-down that this look would have called "slower" in nine cases of ten; infinite where none.
    double smallest_seen = 0.0;
};

struct GateReport {
    Verdict verdict = Verdict::cannot_tell;
    std::uint32_t look = 0;      // the look that decided, or the last one that was possible, from 1; 0: too few pairs
    std::uint32_t pairs = 0;     // that were used
    std::uint32_t next_look = 0; // pairs that the next look needs; 0: decided, or no look is left
    std::vector<GateRow> rows;   // passes, whole frame, unaccounted
    // The pass (or what is unaccounted) with the largest significant change in milliseconds. None where only the whole
    // frame is slower, as where a pass is new.
    std::optional<std::size_t> culprit;
    bool all_alike = false; // the slow-down is about the same share of every judged pass: look at compiler or machine
    double smallest_seen = 0.0; // the greatest of the judged rows'
};

// Judges the pairs so far, in the order in which they were measured. The same input gives the same report: no clock and
// no state, so a caller measures up to the next look and asks again. `passes` are the names of all passes of either
// build.
Result<GateReport> judge(const std::vector<std::string>& passes, const std::vector<PairSummary>& pairs,
                         const GateOptions& options = {});

} // namespace sunfleck::statistics
