#include "engine/statistics/summary.h"

#include <algorithm>
#include <cassert>

namespace sunfleck::statistics {

double percentile(std::vector<double> values, double share) {
    assert(share >= 0.0 && share <= 1.0);
    if (values.empty())
        return 0.0;
    const double place = share * double(values.size() - 1);
    const std::size_t below = std::size_t(place);
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(below), values.end());
    const double low = values[below];
    if (below + 1 == values.size())
        return low;
    const double high = *std::min_element(values.begin() + std::ptrdiff_t(below) + 1, values.end());
    return low + (place - double(below)) * (high - low);
}

double median(std::vector<double> values) {
    return percentile(std::move(values), 0.5);
}

} // namespace sunfleck::statistics
