// Granularity of the visibility tests of movers.
#pragma once

#include <cstdint>

namespace sunfleck::gi {

// The coarsest things that a mover is tested against, of which only those that it may shadow are descended into.
// clusters: groups of nodes, by clusters of samples; trees: the roots of the patches' quadtrees, by single samples;
// pairs: nothing is culled, every node and sample is tested. All give the same states.
enum class TestGrouping : std::uint32_t { clusters, trees, pairs };

} // namespace sunfleck::gi
