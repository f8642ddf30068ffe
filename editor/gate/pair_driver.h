// One pair: a fresh process of base and one of head, both alive, drawing the same frames in short turns.
#pragma once

#include "editor/gate/program_pair.h"

namespace sunfleck::gate {

struct PairOptions {
    std::uint32_t turns = 16;       // of each process
    std::uint32_t frames = 6;       // that count, in a turn
    std::uint32_t warm_up = 2;      // drawn before those, in a turn
    std::uint32_t first_frames = 4; // drawn at the very beginning: what is done only once
    std::uint32_t seed = 1;
};

struct Turn {
    DrawFrames frames;
    std::uint32_t warm_up = 0; // the first of them, which do not count
    bool base_first = true;
};
struct PairPlan {
    bool base_starts = true;
    std::vector<Turn> turns;
};
// Turns spread over the whole recording, A B B A, other frames for another `pair`. Fails where the recording is too
// short.
Result<PairPlan> make_plan(const PairOptions& options, std::uint32_t recording_frames, std::uint32_t pair);

struct DrawnFrame {
    Frame base, head;
    bool counts = false; // not a warm-up frame
};
struct PairRun {
    Hello base, head;
    std::vector<DrawnFrame> frames;
};
Result<PairRun> run_pair(const Programs& programs, const PairOptions& options, std::uint32_t pair,
                         const Patience& patience);

} // namespace sunfleck::gate
