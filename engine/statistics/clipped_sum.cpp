#include "engine/statistics/clipped_sum.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace sunfleck::statistics {
namespace {

// The median of the sizes of what is not zero; 0 where there is nothing.
double median_size(std::span<const double> samples) {
    std::vector<double> sizes;
    sizes.reserve(samples.size());
    for (const double sample : samples)
        if (sample != 0.0)
            sizes.push_back(std::abs(sample));
    if (sizes.empty())
        return 0.0;
    const auto middle = sizes.begin() + std::ptrdiff_t(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return *middle;
}

} // namespace

std::vector<float> clipped_terms(std::span<const double> samples) {
    std::vector<float> terms(samples.size(), 0.0f);
    const double limit = median_size(samples);
    double squares = 0.0;
    for (const double sample : samples)
        squares += std::min(sample * sample, limit * limit);
    if (squares <= 0.0)
        return terms;
    for (std::size_t i = 0; i < samples.size(); ++i)
        terms[i] = float(std::clamp(samples[i], -limit, limit) / std::sqrt(squares));
    return terms;
}

double clipped_statistic(std::span<const double> samples) {
    const double limit = median_size(samples);
    double sum = 0.0, squares = 0.0;
    for (const double sample : samples) {
        sum += std::clamp(sample, -limit, limit);
        squares += std::min(sample * sample, limit * limit);
    }
    return squares > 0.0 ? sum / std::sqrt(squares) : 0.0;
}

double clipped_statistic(std::span<const double> samples, double centre) {
    std::vector<double> moved(samples.begin(), samples.end());
    for (double& sample : moved)
        sample -= centre;
    return clipped_statistic(moved);
}

double clipped_centre(const std::vector<double>& samples, double deviate) {
    const double beyond =
        deviate > 0.0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    if (samples.empty())
        return deviate == 0.0 ? 0.0 : beyond;
    const auto [least, greatest] = std::minmax_element(samples.begin(), samples.end());
    // Far enough outside that all samples have about the same size there.
    const double range = *greatest - *least + 1e-12;
    double low = *least - 100.0 * range, high = *greatest + 100.0 * range;
    if (clipped_statistic(samples, low) <= deviate || clipped_statistic(samples, high) >= deviate)
        return beyond;
    for (int step = 0; step < 40; ++step) {
        const double middle = 0.5 * (low + high);
        (clipped_statistic(samples, middle) > deviate ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

double normal_deviate(double probability) {
    assert(probability > 0.0 && probability < 0.5);
    double low = 0.0, high = 40.0;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(middle / std::sqrt(2.0)) > probability ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

} // namespace sunfleck::statistics
