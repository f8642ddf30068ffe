// How the visibility tests of movers are grouped.
#pragma once

#include <cstdint>

namespace sunfleck::gi {

// What is asked first when a mover is tested: clusters of samples and groups of nodes, down their hierarchy; nodes of
// the patches' trees, by each sample; or every mover, node and sample by itself. All find the same.
enum class TestGrouping : std::uint32_t { clusters, trees, pairs };

} // namespace sunfleck::gi
