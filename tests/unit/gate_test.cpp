// The frame-time gate: its statistics one by one, and what it says of single cases.
#include "engine/statistics/clipped_sum.h"
#include "engine/statistics/gate.h"
#include "engine/statistics/sign_flips.h"
#include "engine/statistics/summary.h"
#include "tests/unit/gate_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sunfleck::statistics {
namespace {

using namespace gate_simulation;

// Pairs of the quiet machine without any luck: each row has the same log ratio but for `spread`.
std::vector<PairSummary> plain_pairs(const std::vector<double>& ms, const std::vector<double>& ratios, double spread) {
    Random random(7);
    std::vector<PairSummary> pairs(48);
    for (PairSummary& pair : pairs)
        for (std::size_t i = 0; i < ms.size(); ++i) {
            PairRow& row = pair.rows.emplace_back();
            row.base_ms = ms[i];
            row.head_ms = ms[i] * ratios[i];
            row.compared = row.base_ms > 0.0 && row.head_ms > 0.0;
            row.log_ratio = row.compared ? std::log(ratios[i]) + spread * random.normal() : 0.0;
        }
    return pairs;
}

// --- The statistics -------------------------------------------------------------------------------

TEST(GateStatistics, PercentilesInterpolate) {
    EXPECT_EQ(percentile({}, 0.5), 0.0);
    EXPECT_EQ(median({3.0}), 3.0);
    EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 2.5);
    EXPECT_EQ(percentile({5.0, 1.0, 3.0}, 0.0), 1.0);
    EXPECT_EQ(percentile({5.0, 1.0, 3.0}, 1.0), 5.0);
    EXPECT_DOUBLE_EQ(percentile({0.0, 10.0, 20.0, 30.0, 40.0}, 0.9), 36.0);
}

TEST(GateStatistics, AWildSampleMovesTheCentreByLittle) {
    std::vector<double> samples = {1.0, 1.1, 0.9, 1.05, 0.95, 1.02, 0.98, 1.08, 0.92, 1.01};
    EXPECT_NEAR(clipped_centre(samples, 0.0), 1.0, 0.01);
    samples.push_back(1e6);
    EXPECT_NEAR(clipped_centre(samples, 0.0), 1.0, 0.03);
    EXPECT_LT(clipped_centre(samples, -1.96), 1.1);
    EXPECT_TRUE(std::isinf(clipped_centre({1.0, 2.0, 3.0}, 1.96)));
}

TEST(GateStatistics, IntervalsCoverWhatTheyPromise) {
    Random random(3);
    for (const bool heavy : {false, true})
        for (const std::size_t count : {8u, 12u, 20u, 48u}) {
            int missed = 0;
            constexpr int runs = 2000;
            for (int run = 0; run < runs; ++run) {
                std::vector<double> samples(count);
                for (double& sample : samples) // of a Cauchy distribution where heavy
                    sample = random.normal() / (heavy ? random.normal() : 1.0);
                missed += clipped_centre(samples, 1.96) > 0.0 || clipped_centre(samples, -1.96) < 0.0;
            }
            EXPECT_NEAR(double(missed) / runs, 0.05, 0.015) << count << (heavy ? " heavy" : "");
        }
}

TEST(GateStatistics, TwelvePairsAreTestedAgainstAllChangesOfSigns) {
    SampleTable samples(2, 12);
    for (std::size_t i = 0; i < 12; ++i) {
        samples.at(0, i) = 1.0 + 0.01 * double(i);
        samples.at(1, i) = i % 2 ? 1.0 : -1.0;
    }
    const FlipTestResult result = flip_test(samples, 4095, 1, 0.01);
    EXPECT_LE(result.p[0], 2.0 / 4096.0); // the other row reaches it once: where all its signs agree
    EXPECT_GT(result.p[1], 0.3);
}

// Rows that depend on each other and differ in spread, none of them above zero: an error of 5 % is one of 5 %.
TEST(GateStatistics, TheCorrectedTestKeepsItsError) {
    Random random(5);
    constexpr int runs = 1000;
    for (const std::size_t columns : {12u, 20u}) {
        int alarms = 0;
        for (int run = 0; run < runs; ++run) {
            SampleTable samples(10, columns);
            for (std::size_t column = 0; column < columns; ++column) {
                const double common = random.normal();
                for (std::size_t row = 0; row < samples.rows; ++row)
                    samples.at(row, column) = common + double(row + 1) * random.normal() / random.normal();
            }
            const std::vector<double> p = flip_test(samples, 999, std::uint32_t(run), 0.05).p;
            alarms += *std::min_element(p.begin(), p.end()) <= 0.05;
        }
        EXPECT_NEAR(double(alarms) / runs, 0.05, 0.025) << columns;
    }
}

// --- Input ----------------------------------------------------------------------------------------

TEST(GateInput, BadTimesAreRefused) {
    const ProcessTimes good{{10.0, 11.0}, {1.0, 2.0, 3.0, 4.0}};
    EXPECT_TRUE(summarise_pair({good, good}, 2));
    const double bad_times[] = {std::nan(""), -1.0, std::numeric_limits<double>::infinity()};
    for (const double bad : bad_times) {
        ProcessTimes pass = good, frame = good;
        pass.pass_ms[3] = bad;
        frame.frame_ms[1] = bad;
        EXPECT_FALSE(summarise_pair({good, pass}, 2));
        EXPECT_FALSE(summarise_pair({frame, good}, 2));
    }
    EXPECT_FALSE(summarise_pair({good, {}}, 2));
    EXPECT_FALSE(summarise_pair({good, good}, 3));
    EXPECT_FALSE(summarise_pair({good, {{10.0}, {1.0, 2.0}}}, 2));
}

TEST(GateInput, BadPairsAndOptionsAreRefused) {
    const auto pairs = plain_pairs({5.0, 10.0, 5.0}, {1.0, 1.0, 1.0}, 0.01);
    EXPECT_TRUE(judge({"a"}, pairs));
    EXPECT_FALSE(judge({"a", "b"}, pairs)); // rows of another number of passes
    auto broken = pairs;
    broken[3].rows[0].log_ratio = std::nan("");
    EXPECT_FALSE(judge({"a"}, broken));
    const auto refused = [&](auto change) {
        GateOptions options;
        change(options);
        return !judge({"a"}, pairs, options);
    };
    EXPECT_TRUE(refused([](GateOptions& o) { o.looks.clear(); }));
    EXPECT_TRUE(refused([](GateOptions& o) { o.looks = {20, 12}; }));
    EXPECT_TRUE(refused([](GateOptions& o) { o.looks = {0, 12}; }));
    EXPECT_TRUE(refused([](GateOptions& o) { o.slower_error = 0.0; }));
    EXPECT_TRUE(refused([](GateOptions& o) { o.fine_error = std::nan(""); }));
    EXPECT_TRUE(refused([](GateOptions& o) { o.harm = o.tolerance; }));
    EXPECT_TRUE(refused([](GateOptions& o) { o.frame_tolerance = o.harm * o.judged_share; }));
    EXPECT_TRUE(refused([](GateOptions& o) { o.frame_tolerance = std::nan(""); }));
    EXPECT_TRUE(refused([](GateOptions& o) { o.flips = 0; }));
}

// --- What is said of single cases -----------------------------------------------------------------

TEST(GateVerdict, FewPairsAskForMore) {
    auto pairs = plain_pairs({5.0, 10.0, 5.0}, {1.0, 1.0, 1.0}, 0.01);
    for (const std::size_t count : {0u, 1u, 11u}) {
        const GateReport report = judge({"a"}, {pairs.begin(), pairs.begin() + std::ptrdiff_t(count)}).value();
        EXPECT_EQ(report.verdict, Verdict::cannot_tell);
        EXPECT_EQ(report.look, 0u);
        EXPECT_EQ(report.next_look, 12u);
        EXPECT_EQ(report.pairs, count);
    }
    const GateReport report = judge({"a"}, pairs).value();
    EXPECT_EQ(report.verdict, Verdict::fine);
    EXPECT_EQ(report.pairs, 12u); // later pairs don't matter once a look has decided
    EXPECT_EQ(report.next_look, 0u);
}

TEST(GateVerdict, SaysWhatItCouldNotHaveSeen) {
    const auto pairs = plain_pairs({5.0, 10.0, 5.0}, {1.0, 1.0, 1.0}, 0.3);
    const GateReport report = judge({"a"}, pairs).value();
    EXPECT_EQ(report.verdict, Verdict::cannot_tell);
    EXPECT_EQ(report.look, 4u);
    EXPECT_EQ(report.next_look, 0u);
    EXPECT_GT(report.smallest_seen, 0.1);
    EXPECT_LT(report.smallest_seen, 0.6);
}

TEST(GateVerdict, TheCulpritCostsTheMostMilliseconds) {
    //                                a    b    c     whole  unaccounted
    const std::vector<double> ms = {10.0, 2.0, 1.0, 15.0, 2.0};
    const GateReport report = judge({"a", "b", "c"}, plain_pairs(ms, {1.1, 1.4, 0.5, 1.1, 1.0}, 0.01)).value();
    EXPECT_EQ(report.verdict, Verdict::slower);
    EXPECT_EQ(report.culprit, 0u); // 1 ms; b has the greater ratio
    EXPECT_TRUE(report.rows[1].slower);
    EXPECT_FALSE(report.rows[2].slower);
    EXPECT_FALSE(report.all_alike);
    EXPECT_LT(report.rows[0].p, 0.01);
    EXPECT_NEAR(report.rows[0].ratio, 1.1, 0.02);
    EXPECT_LT(report.rows[0].low, report.rows[0].ratio);
    EXPECT_GT(report.rows[0].high, report.rows[0].ratio);
}

// A few more instructions, measured well, in a row of half a per cent of the frame: 0.03 % of the frame.
TEST(GateVerdict, WhatIsNothingToTheFrameIsNoSlowDown) {
    const std::vector<double> ms = {10.0, 0.08, 15.0, 4.92};
    const auto alarms = [&](double small_ratio) {
        const auto pairs = plain_pairs(ms, {1.0, small_ratio, 1.0, 1.0}, 0.005);
        const GateReport report = judge({"large", "small"}, pairs).value();
        EXPECT_NEAR(report.rows[0].tolerance, 0.01, 1e-12);
        EXPECT_NEAR(report.rows[1].tolerance, 0.0005 * 15.0 / 0.08 / small_ratio, 1e-3);
        return report.verdict == Verdict::slower;
    };
    EXPECT_FALSE(alarms(1.05));
    EXPECT_TRUE(alarms(1.15)); // 0.08 % of it
}

TEST(GateVerdict, AUniformSlowDownIsSaidAsSuch) {
    const std::vector<double> ms = {10.0, 2.0, 3.0, 17.0, 2.0};
    const GateReport report = judge({"a", "b", "c"}, plain_pairs(ms, {1.08, 1.08, 1.08, 1.08, 1.08}, 0.01)).value();
    EXPECT_EQ(report.verdict, Verdict::slower);
    EXPECT_TRUE(report.all_alike);
}

TEST(GateVerdict, NewGoneAndSmallPassesAreListed) {
    const std::vector<double> ms = {10.0, 0.0, 2.0, 0.01, 14.0, 2.0};
    auto pairs = plain_pairs(ms, {1.0, 1.0, 0.0, 1.5, 1.2, 1.0}, 0.01);
    for (PairSummary& pair : pairs)
        pair.rows[1].head_ms = 3.0;
    const GateReport report = judge({"kept", "new", "gone", "small"}, pairs).value();
    EXPECT_EQ(report.verdict, Verdict::slower); // the whole frame
    EXPECT_FALSE(report.culprit.has_value());
    EXPECT_EQ(report.rows[0].kind, RowKind::judged);
    EXPECT_EQ(report.rows[1].kind, RowKind::added);
    EXPECT_EQ(report.rows[2].kind, RowKind::removed);
    EXPECT_EQ(report.rows[3].kind, RowKind::listed);
    EXPECT_FALSE(report.rows[3].slower);
    EXPECT_NEAR(report.rows[3].ratio, 1.5, 0.05); // but seen
}

// A pass that runs in few frames, and what no pass accounts for.
TEST(GateVerdict, PassesThatSeldomRunAreComparedWhereTheyRan) {
    PairTimes times;
    for (int frame = 0; frame < 8; ++frame) {
        const bool ran = frame % 4 == 0;
        for (ProcessTimes* process : {&times.base, &times.head}) {
            const double ms = ran ? (process == &times.head ? 3.0 : 2.0) : 0.0;
            process->pass_ms.push_back(ms);
            process->frame_ms.push_back(10.0 + ms);
        }
    }
    const PairSummary pair = summarise_pair(times, 1).value();
    EXPECT_TRUE(pair.rows[0].compared);
    EXPECT_NEAR(pair.rows[0].log_ratio, std::log(1.5), 1e-12);
    EXPECT_NEAR(pair.rows[0].base_ms, 0.5, 1e-12);
    EXPECT_NEAR(pair.rows[unaccounted_row(1)].base_ms, 10.0, 1e-12);
    EXPECT_NEAR(pair.rows[unaccounted_row(1)].log_ratio, 0.0, 1e-12);
}

TEST(GateVerdict, TheSameInputGivesTheSameReport) {
    World one(gate_simulation::shared, 11), two(gate_simulation::shared, 11);
    Build head = same_build();
    head[5] = 1.03;
    const GateReport a = run_gate(one, same_build(), head), b = run_gate(two, same_build(), head);
    EXPECT_EQ(a.verdict, b.verdict);
    EXPECT_EQ(a.pairs, b.pairs);
    for (std::size_t i = 0; i < a.rows.size(); ++i)
        EXPECT_EQ(a.rows[i].p, b.rows[i].p);
}

} // namespace
} // namespace sunfleck::statistics
