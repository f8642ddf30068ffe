#include "engine/statistics/sample_series.h"
#include "engine/statistics/summary.h"

#include <gtest/gtest.h>

namespace sunfleck::statistics {
namespace {

TEST(SampleSeries, ShortOnesAreWhole) {
    SampleSeries<int> series;
    for (int i = 0; i < int(series.most); ++i)
        series.add(i);
    ASSERT_EQ(series.values().size(), series.most);
    for (int i = 0; i < int(series.most); ++i)
        EXPECT_EQ(series.values()[std::size_t(i)], i);
}

// Of any length: evenly spread over the whole, so that percentiles are those of all values.
TEST(SampleSeries, LongOnesAreThinnedOutEvenly) {
    SampleSeries<double> series;
    constexpr int count = 100'003;
    for (int i = 0; i < count; ++i) {
        series.add(i);
        ASSERT_LE(series.values().size(), series.most);
    }
    EXPECT_EQ(series.count(), std::uint64_t(count));
    ASSERT_GT(series.values().size(), series.most / 2);
    const double step = series.values()[1];
    for (std::size_t i = 0; i < series.values().size(); ++i)
        EXPECT_EQ(series.values()[i], double(i) * step);
    EXPECT_NEAR(median(series.values()), count / 2.0, step);
    EXPECT_NEAR(percentile(series.values(), 0.95), 0.95 * count, 2 * step);
}

// Memory is taken with the first value: it does not grow with a run, however rarely something is measured.
TEST(SampleSeries, MemoryDoesNotGrow) {
    SampleSeries<double> series;
    series.add(1.0);
    const double* const place = series.values().data();
    for (int i = 0; i < 20'000; ++i) {
        series.add(i);
        ASSERT_EQ(series.values().data(), place);
    }
}

} // namespace
} // namespace sunfleck::statistics
