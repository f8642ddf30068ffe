#include "editor/gate/pair_driver.h"

#include "engine/core/random.h"

#include <algorithm>

namespace sunfleck::gate {
namespace {

RandomSequence random_of(const PairOptions& options, std::uint32_t pair) {
    return {SequenceKind::pseudo_random, options.seed, pair};
}

bool base_starts(const PairOptions& options, std::uint32_t pair) {
    return random_of(options, pair).at(0) < 0.5f;
}

Status draw_turn(ProgramPair& pair, const Turn& turn, PairRun& run) {
    std::vector<Frame> base, head;
    for (const bool is_base : {turn.base_first, !turn.base_first}) {
        SUNFLECK_ASSIGN((is_base ? base : head), (is_base ? pair.base : pair.head)->draw(turn.frames));
    }
    for (std::uint32_t i = 0; i < turn.frames.count; ++i)
        run.frames.push_back({std::move(base[i]), std::move(head[i]), i >= turn.warm_up});
    return {};
}

} // namespace

Result<PairPlan> make_plan(const PairOptions& options, std::uint32_t recording_frames, std::uint32_t pair) {
    const std::uint32_t length = options.warm_up + options.frames;
    const std::uint32_t needed = options.first_frames + options.turns * length;
    if (options.turns < 1 || options.frames < 1)
        return Error{"a pair needs at least one turn of one frame"};
    if (recording_frames < needed)
        return Error{"the recording has " + std::to_string(recording_frames) + " frames; " +
                     std::to_string(options.turns) + " turns of " + std::to_string(length) + " frames need " +
                     std::to_string(needed)};
    const std::uint32_t segment = (recording_frames - options.first_frames) / options.turns;
    RandomSequence random = random_of(options, pair);
    random.seek(1);
    PairPlan plan{base_starts(options, pair), {}};
    bool base_first = random.next() < 0.5f;
    if (options.first_frames > 0)
        plan.turns.push_back({{0, options.first_frames}, options.first_frames, base_first});
    for (std::uint32_t i = 0; i < options.turns; ++i, base_first = !base_first) {
        const std::uint32_t room = segment - length + 1;
        const std::uint32_t offset = std::min(std::uint32_t(random.next() * float(room)), room - 1);
        plan.turns.push_back({{options.first_frames + i * segment + offset, length}, options.warm_up, base_first});
    }
    return plan;
}

Result<PairRun> run_pair(const Programs& programs, const PairOptions& options, std::uint32_t pair,
                         const Patience& patience) {
    SUNFLECK_ASSIGN(ProgramPair both, ProgramPair::start(programs, base_starts(options, pair), patience));
    PairRun run{both.base->hello(), both.head->hello(), {}};
    SUNFLECK_ASSIGN(const PairPlan plan, make_plan(options, run.base.frames, pair));
    for (const Turn& turn : plan.turns)
        SUNFLECK_TRY(draw_turn(both, turn, run));
    SUNFLECK_TRY(both.finish());
    return run;
}

} // namespace sunfleck::gate
