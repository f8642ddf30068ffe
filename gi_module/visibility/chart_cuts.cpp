#include "gi_module/visibility/chart_cuts.h"

#include <algorithm>
#include <optional>

namespace sunfleck::gi {
namespace {

constexpr std::size_t most_cuts = 3; // in each direction
constexpr double least_length = 0.5; // of a side
constexpr double rounding = 0x1p-21; // of coordinates: some spacings of floats, which corners have

// A wall's foot: where it stands on one side, and from where to where it reaches along the other, as fractions of them.
struct Foot {
    double place = 0.0, low = 0.0, high = 0.0;
};

// Where a polygon meets the chart's plane, by its extent in fractions of the sides.
struct Trace {
    glm::dvec2 low{1e300}, high{-1e300};
    void add(const ChartRectangle& chart, dvec3 point) {
        const dvec3 from = point - chart.origin;
        const glm::dvec2 place(glm::dot(from, chart.u) / glm::dot(chart.u, chart.u),
                               glm::dot(from, chart.v) / glm::dot(chart.v, chart.v));
        low = glm::min(low, place);
        high = glm::max(high, place);
    }
};

// Nothing if it does not stand there, or is too low for a wall.
std::optional<Trace> trace_of(const ChartRectangle& chart, std::span<const dvec3> polygon, double least_height,
                              double standing) {
    Trace trace;
    double highest = -1e300;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double here = glm::dot(chart.normal, a - chart.origin), next = glm::dot(chart.normal, b - chart.origin);
        highest = std::max(highest, here);
        if (std::abs(here) <= standing)
            trace.add(chart, a);
        else if (std::abs(next) > standing && (here > 0.0) != (next > 0.0))
            trace.add(chart, a + (b - a) * (here / (here - next)));
    }
    if (highest < least_height || !(trace.low.x <= trace.high.x))
        return std::nullopt;
    return trace;
}

// Of feet that touch or overlap: how much of the side they cover together.
double covered(std::vector<Foot> feet) {
    std::sort(feet.begin(), feet.end(), [](const Foot& a, const Foot& b) { return a.low < b.low; });
    double sum = 0.0, until = 0.0;
    for (const Foot& foot : feet) {
        sum += std::max(0.0, foot.high - std::max(foot.low, until));
        until = std::max(until, foot.high);
    }
    return sum;
}

// `apart`: the least distance between walls, as a fraction of the side that they divide.
std::vector<double> cuts_of(std::vector<Foot> feet, double apart) {
    std::sort(feet.begin(), feet.end(), [](const Foot& a, const Foot& b) { return a.place < b.place; });
    std::vector<std::pair<double, double>> found; // length, place
    for (std::size_t first = 0, end = 0; first < feet.size(); first = end) {
        for (end = first + 1; end < feet.size() && feet[end].place - feet[end - 1].place < apart;)
            ++end;
        const double length = covered({feet.begin() + std::ptrdiff_t(first), feet.begin() + std::ptrdiff_t(end)});
        if (length >= least_length)
            found.emplace_back(length, 0.5 * (feet[first].place + feet[end - 1].place));
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<double> cuts;
    cuts.reserve(most_cuts);
    for (const auto& [length, place] : std::span(found).first(std::min(found.size(), most_cuts)))
        cuts.push_back(place);
    std::sort(cuts.begin(), cuts.end());
    return cuts;
}

Bounds bounds_of(const ChartRectangle& chart) {
    Bounds bounds;
    for (const dvec3& corner :
         {chart.origin, chart.origin + chart.u, chart.origin + chart.v, chart.origin + chart.u + chart.v})
        bounds.add(vec3(corner));
    return bounds;
}

} // namespace

ChartCuts find_chart_cuts(const ChartRectangle& chart, const StaticBlockers& blockers, double smallest) {
    const glm::dvec2 apart = smallest / glm::dvec2(glm::length(chart.u), glm::length(chart.v));
    if (std::min(apart.x, apart.y) >= 0.5)
        return {};
    Bounds bounds = bounds_of(chart);
    const vec3 size = glm::max(glm::abs(bounds.minimum), glm::abs(bounds.maximum));
    const double standing = rounding * double(std::max({size.x, size.y, size.z}));
    bounds.minimum -= vec3(float(standing));
    bounds.maximum += vec3(float(standing));
    std::vector<Foot> on_u, on_v;
    blockers.visit_polygons(bounds, [&](std::span<const dvec3> polygon) {
        const std::optional<Trace> trace = trace_of(chart, polygon, 2.0 * smallest, standing);
        if (!trace)
            return;
        const glm::dvec2 extent = trace->high - trace->low, middle = 0.5 * (trace->high + trace->low);
        // Along a side, but for rounding, and not at the border.
        const glm::dvec2 straight = 4.0 * standing / smallest * apart;
        const auto add = [&](std::vector<Foot>& feet, int across, int along) {
            if (extent[across] <= straight[across] && std::abs(middle[across] - 0.5) < 0.5 - apart[across])
                feet.push_back({middle[across], std::max(trace->low[along], 0.0), std::min(trace->high[along], 1.0)});
        };
        add(on_u, 0, 1);
        add(on_v, 1, 0);
    });
    return {cuts_of(std::move(on_u), apart.x), cuts_of(std::move(on_v), apart.y)};
}

} // namespace sunfleck::gi
