#include "tests/unit/gate_naive.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sunfleck::gate_simulation {
namespace {

constexpr std::size_t frames_of_turn = 4, pairs = 16;
constexpr std::size_t resamples = 1000;
constexpr double corrected_error = 0.05 / double(passes);                // one-sided: only a slow-down alarms
constexpr double uncorrected_error = 0.025;                              // an interval at 95 %
constexpr double uncorrected_deviate = 1.960, corrected_deviate = 2.807; // of a normal distribution, for these

// Samples x passes.
using Samples = std::vector<std::array<double, passes>>;

Samples log_times(const statistics::ProcessTimes& times) {
    Samples samples(times.frame_ms.size());
    for (std::size_t i = 0; i < samples.size() * passes; ++i)
        samples[i / passes][i % passes] = std::log(times.pass_ms[i]);
    return samples;
}

statistics::PairTimes measure(World& world, std::size_t frames, std::size_t frames_in_turn) {
    statistics::PairTimes times;
    const Process base = world.start(same_build()), head = world.start(same_build());
    for (std::size_t first = 0; first < frames; first += frames_in_turn) {
        world.draw(base, first, frames_in_turn, times.base);
        if (frames_in_turn == frames)
            world.load();
        world.draw(head, first, frames_in_turn, times.head);
    }
    return times;
}

Samples differences(const statistics::PairTimes& times) {
    Samples result = log_times(times.head);
    const Samples base = log_times(times.base);
    for (std::size_t i = 0; i < result.size(); ++i)
        for (std::size_t pass = 0; pass < passes; ++pass)
            result[i][pass] -= base[i][pass];
    return result;
}

// The sums of as many samples as there are, drawn with replacement.
std::array<double, passes> resampled_sums(const Samples& samples, Random& random) {
    std::array<double, passes> sums{};
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const auto& sample = samples[std::size_t(random.uniform() * double(samples.size()))];
        for (std::size_t pass = 0; pass < passes; ++pass)
            sums[pass] += sample[pass];
    }
    return sums;
}

// Whether the bootstrap interval of head's mean less base's lies above zero for any pass.
bool bootstrap_alarms(const Samples& head, const Samples& base, double error, Random& random) {
    std::array<std::size_t, passes> not_above{};
    for (std::size_t i = 0; i < resamples; ++i) {
        const auto head_sums = resampled_sums(head, random);
        const auto base_sums = base.empty() ? std::array<double, passes>{} : resampled_sums(base, random);
        for (std::size_t pass = 0; pass < passes; ++pass)
            not_above[pass] += head_sums[pass] <= base_sums[pass];
    }
    return std::any_of(not_above.begin(), not_above.end(),
                       [&](std::size_t count) { return double(count) < error * double(resamples); });
}

// Deviate of the rank sum of head's values among both.
double mann_whitney_deviate(const Samples& head, const Samples& base, std::size_t pass) {
    std::vector<std::pair<double, bool>> values;
    for (const auto& sample : head)
        values.emplace_back(sample[pass], true);
    for (const auto& sample : base)
        values.emplace_back(sample[pass], false);
    std::sort(values.begin(), values.end());
    double ranks = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i)
        ranks += values[i].second ? double(i + 1) : 0.0;
    const double n = double(head.size()), m = double(base.size());
    return (ranks - n * (n + m + 1.0) / 2.0) / std::sqrt(n * m * (n + m + 1.0) / 12.0);
}

// Deviate of the sum of the positive differences' ranks.
double signed_rank_deviate(const Samples& samples, std::size_t pass) {
    std::vector<std::pair<double, bool>> sizes;
    for (const auto& sample : samples)
        sizes.emplace_back(std::abs(sample[pass]), sample[pass] > 0.0);
    std::sort(sizes.begin(), sizes.end());
    double ranks = 0.0;
    for (std::size_t i = 0; i < sizes.size(); ++i)
        ranks += sizes[i].second ? double(i + 1) : 0.0;
    const double n = double(sizes.size());
    return (ranks - n * (n + 1.0) / 4.0) / std::sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 24.0);
}

Samples pair_medians(World& world) {
    Samples samples;
    for (std::size_t i = 0; i < pairs; ++i) {
        const auto summary = statistics::summarise_pair(world.measure_pair(same_build(), same_build()), passes).value();
        auto& sample = samples.emplace_back();
        for (std::size_t pass = 0; pass < passes; ++pass)
            sample[pass] = summary.rows[pass].log_ratio;
    }
    return samples;
}

} // namespace

bool base_then_head_mann_whitney(World& world) {
    const statistics::PairTimes times = measure(world, 768, 768);
    const Samples base = log_times(times.base), head = log_times(times.head);
    for (std::size_t pass = 0; pass < passes; ++pass)
        if (mann_whitney_deviate(head, base, pass) > uncorrected_deviate)
            return true;
    return false;
}

bool base_then_head_bootstrap(World& world) {
    const statistics::PairTimes times = measure(world, 768, 768);
    return bootstrap_alarms(log_times(times.head), log_times(times.base), uncorrected_error, world.random());
}

bool interleaved_signed_rank(World& world) {
    const Samples samples = differences(measure(world, 160, frames_of_turn));
    for (std::size_t pass = 0; pass < passes; ++pass)
        if (signed_rank_deviate(samples, pass) > corrected_deviate)
            return true;
    return false;
}

bool pairs_uncorrected(World& world) {
    return bootstrap_alarms(pair_medians(world), {}, uncorrected_error, world.random());
}

bool pairs_bootstrap(World& world) {
    return bootstrap_alarms(pair_medians(world), {}, corrected_error, world.random());
}

} // namespace sunfleck::gate_simulation
