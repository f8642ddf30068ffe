// Order statistics: the one place that says what a median or a percentile is.
#pragma once

#include <vector>

namespace sunfleck::statistics {

// The value below which `share` (0 to 1) of the values lie, interpolated linearly between neighbours: 0 is the least,
// 0.5 the median, 1 the greatest. 0 where there are no values.
double percentile(std::vector<double> values, double share);
double median(std::vector<double> values);

} // namespace sunfleck::statistics
