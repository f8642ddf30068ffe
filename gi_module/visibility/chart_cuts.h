// Where charts are divided because a wall stands on them: a patch that lies under a wall belongs to two rooms, and
// nothing can hide all of it. Patches that end at the wall are hidden by it (coverage.h).
#pragma once

#include "gi_module/visibility/static_blockers.h"

namespace sunfleck::gi {

// A rectangle of a surface: corner, edges and unit normal.
struct ChartRectangle {
    dvec3 origin{0.0}, u{0.0}, v{0.0}, normal{0.0};
};

// Cuts parallel to each pair of sides, as ascending fractions of the other side, within (0, 1).
struct ChartCuts {
    std::vector<double> across_u, across_v;
};

// Walls are flat, rise by twice `smallest` or more, and reach along at least half of a side, as one or as several on
// one line (a doorway between them). Those closer to each other than `smallest` are the faces of one wall, and the cut
// lies midway. At most three cuts in each direction, the longest walls first; none closer than `smallest` to the
// rectangle's border.
ChartCuts find_chart_cuts(const ChartRectangle& chart, const StaticBlockers& blockers, double smallest);

} // namespace sunfleck::gi
