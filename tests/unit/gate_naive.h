// The usual ways to say that a program became slower. Each is run on two builds that are equal: what it says is a false
// alarm. They are here to show that the simulated machine is as unkind as real ones.
#pragma once

#include "tests/unit/gate_simulation.h"

namespace sunfleck::gate_simulation {

// One process of base, then one of head, 768 frames each: as many as 16 pairs of the gate have. Mann-Whitney over
// frames for each pass at 95 %.
bool base_then_head_mann_whitney(World& world);
// The same frames, but a bootstrap interval of the mean over frames.
bool base_then_head_bootstrap(World& world);
// One process of each, in turns of four frames, 160 frames each: Wilcoxon's signed ranks over frames, corrected for the
// number of passes. More frames make it worse: it becomes sure of the luck of its two processes.
bool interleaved_signed_rank(World& world);
// 16 pairs of processes, measured as the gate does; bootstrap interval at 95 % for each pass, not corrected.
bool pairs_uncorrected(World& world);
// 16 pairs, bootstrap over pairs, corrected for the number of passes; 5 % are promised.
bool pairs_bootstrap(World& world);

} // namespace sunfleck::gate_simulation
