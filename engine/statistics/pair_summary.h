// One pair of processes, base and head, that drew the same frames in turns: what the gate keeps of it.
#pragma once

#include "engine/core/result.h"

#include <cstddef>
#include <vector>

namespace sunfleck::statistics {

// Times in milliseconds of the frames that one process drew, all of them after warm-up.
struct ProcessTimes {
    std::vector<double> frame_ms; // the whole frame, on the wall clock
    // Frames x passes, frame after frame; zero where a pass did not run. What is measured on the CPU (a stage) is a
    // pass, too; passes should not contain each other, or their time counts twice and less is left unaccounted.
    std::vector<double> pass_ms;
};

struct PairTimes {
    ProcessTimes base, head;
};

// What a pair says of one row: one sample, whatever its number of frames.
struct PairRow {
    bool compared = false;  // in at least one frame it ran in both
    double log_ratio = 0.0; // median over those frames of log(head / base) of the same frame
    double base_ms = 0.0,
           head_ms = 0.0; // median of the frames in which it ran, times the share of frames in which it did
};

// Passes in the order of the input, then the whole frame, then what no pass accounts for.
struct PairSummary {
    std::vector<PairRow> rows;
};

constexpr std::size_t whole_frame_row(std::size_t passes) {
    return passes;
}
constexpr std::size_t unaccounted_row(std::size_t passes) {
    return passes + 1;
}
constexpr std::size_t row_count(std::size_t passes) {
    return passes + 2;
}

// Fails where the two drew no frames or another number of them, and where a time is negative or no number.
Result<PairSummary> summarise_pair(const PairTimes& times, std::size_t passes);

} // namespace sunfleck::statistics
