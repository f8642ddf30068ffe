#include "engine/statistics/sign_flips.h"

#include "engine/core/random.h"
#include "engine/statistics/clipped_sum.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

namespace sunfleck::statistics {
namespace {

// Sums of the same numbers in another order differ in their last bits: such statistics are equal.
constexpr float tie = 1e-5f;

// For each eight columns and each pattern of their signs, the sums of all rows: a change of signs of all columns then
// costs one addition per row and eight columns.
class SumTables {
public:
    explicit SumTables(const SampleTable& samples) : rows_(samples.rows), groups_((samples.columns + 7) / 8) {
        sums_.assign(groups_ * 256 * rows_, 0.0f);
        for (std::size_t row = 0; row < rows_; ++row) {
            std::vector<float> signed_terms = clipped_terms(samples.row(row));
            signed_terms.resize(groups_ * 8, 0.0f);
            for (std::size_t group = 0; group < groups_; ++group)
                fill(row, group, signed_terms.data() + group * 8);
        }
    }

    std::size_t groups() const { return groups_; }
    // Each set bit of the pattern changes the sign of a column.
    void add(std::size_t group, std::uint8_t pattern, float* statistics) const {
        const float* sums = sums_.data() + (group * 256 + pattern) * rows_;
        for (std::size_t row = 0; row < rows_; ++row)
            statistics[row] += sums[row];
    }

private:
    void fill(std::size_t row, std::size_t group, const float* eight) {
        const auto sum = [&](std::size_t pattern) -> float& { return sums_[(group * 256 + pattern) * rows_ + row]; };
        sum(0) = std::accumulate(eight, eight + 8, 0.0f);
        for (std::size_t bit = 0; bit < 8; ++bit) // patterns whose highest bit it is
            for (std::size_t rest = 0; rest < std::size_t(1) << bit; ++rest)
                sum((std::size_t(1) << bit) + rest) = sum(rest) - 2.0f * eight[bit];
    }

    std::size_t rows_, groups_;
    std::vector<float> sums_; // group, pattern, row
};

// The patterns of one change of signs; number 0 changes none.
class FlipSource {
public:
    FlipSource(std::size_t columns, std::uint32_t flips, std::uint32_t seed) : seed_(seed) {
        complete_ = columns < 31 && (std::uint64_t(1) << columns) <= std::uint64_t(flips) + 1;
        count_ = complete_ ? std::uint32_t(1) << columns : flips + 1;
    }
    std::uint32_t count() const { return count_; }
    std::uint8_t pattern(std::uint32_t number, std::size_t group) const {
        if (complete_)
            return std::uint8_t(number >> (8 * group));
        if (number == 0)
            return 0;
        const std::uint32_t word = hash_combine(hash_combine(seed_, number), std::uint32_t(group / 4));
        return std::uint8_t(word >> (8 * (group % 4)));
    }

private:
    std::uint32_t seed_;
    std::uint32_t count_ = 0;
    bool complete_ = false;
};

std::vector<std::size_t> descending(const std::vector<float>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] > values[b]; });
    return order;
}

} // namespace

FlipTestResult flip_test(const SampleTable& samples, std::uint32_t flips, std::uint32_t seed, double error) {
    const SumTables tables(samples);
    const FlipSource source(samples.columns, flips, seed);
    std::vector<float> seen, statistics(samples.rows), greatest;
    std::vector<std::size_t> order;
    std::vector<std::uint32_t> as_great(samples.rows, 0);
    for (std::uint32_t number = 0; number < source.count(); ++number) {
        std::fill(statistics.begin(), statistics.end(), 0.0f);
        for (std::size_t group = 0; group < tables.groups(); ++group)
            tables.add(group, source.pattern(number, group), statistics.data());
        if (number == 0) {
            seen = statistics;
            order = descending(seen);
        }
        // A row competes with itself and the rows that look less conspicuous: those above it are dealt with already.
        float maximum = -std::numeric_limits<float>::infinity();
        for (std::size_t place = samples.rows; place-- > 0;) {
            maximum = std::max(maximum, statistics[order[place]]);
            as_great[order[place]] += maximum >= seen[order[place]] - tie;
        }
        greatest.push_back(maximum);
    }
    FlipTestResult result;
    result.p.resize(samples.rows);
    double least = 0.0;
    for (const std::size_t row : order)
        result.p[row] = least = std::max(least, double(as_great[row]) / double(source.count()));
    const std::size_t beyond = std::size_t(error * double(source.count()));
    std::sort(greatest.begin(), greatest.end(), std::greater<>());
    result.critical = greatest.empty() ? std::numeric_limits<double>::infinity()
                                       : double(greatest[std::min(beyond, greatest.size() - 1)]);
    return result;
}

} // namespace sunfleck::statistics
