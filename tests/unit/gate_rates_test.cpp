// How often the frame-time gate errs on a simulated machine. SUNFLECK_TEST_SIZE=long has enough runs to prove the
// rates; the usual size would notice if they broke.
#include "tests/support/test_size.h"
#include "tests/unit/gate_naive.h"
#include "tests/unit/gate_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace sunfleck::statistics {
namespace {

using namespace gate_simulation;

struct Rates {
    int runs = 0, slower = 0, fine = 0, named = 0;
    double pairs = 0.0;
    double share(int count) const { return double(count) / double(runs); }
};

// Slows down one pass of 3 to 8 % of the frame by `slow_down`, another one in each run; or moves all passes at random,
// as the layout of another build does.
Rates simulate(const Machine& machine, int runs, double slow_down, double rebuild = 0.0) {
    Rates rates;
    rates.runs = runs;
    for (int run = 0; run < runs; ++run) {
        World world(machine, std::uint64_t(run) * 7919u + 1u);
        Build head = same_build();
        const std::size_t target = 3 + world.random().bits() % 8; // 8 to 3 %
        head[target] *= slow_down;
        for (double& factor : head)
            factor *= std::exp(rebuild * world.random().normal());
        const GateReport report = run_gate(world, same_build(), head);
        rates.slower += report.verdict == Verdict::slower;
        rates.fine += report.verdict == Verdict::fine;
        rates.named += report.verdict == Verdict::slower && report.culprit == target;
        rates.pairs += double(report.pairs) / double(runs);
    }
    return rates;
}

void print(const char* name, const char* what, const Rates& rates) {
    constexpr double minutes_per_pair = 26.0 / 60.0; // on two cores, 12 s of them loading
    std::printf(
        "%-8s %-10s %5d runs: slower %5.1f %%, named %5.1f %%, fine %5.1f %%, cannot tell %4.1f %%, %4.1f pairs "
        "(%3.1f min)\n",
        name, what, rates.runs, 100.0 * rates.share(rates.slower), 100.0 * rates.share(rates.named),
        100.0 * rates.share(rates.fine), 100.0 * rates.share(rates.runs - rates.slower - rates.fine), rates.pairs,
        rates.pairs * minutes_per_pair);
}

// At most 1 % alarms, 5 % wrongly fine, and at least 95 % caught and named; on every machine.
void prove(const char* name, const Machine& machine, int runs) {
    const Rates same = simulate(machine, runs, 1.0);
    print(name, "same", same);
    EXPECT_LE(same.share(same.slower), 0.01) << name;
    EXPECT_GE(same.share(same.fine), 0.95) << name;
    const Rates slower = simulate(machine, runs, 1.05);
    print(name, "5 % slower", slower);
    EXPECT_GE(slower.share(slower.named), 0.95) << name;
    EXPECT_LE(slower.share(slower.fine), 0.05) << name;
}

TEST(GateSimulation, QuietMachine) {
    prove("quiet", quiet, tests::by_size(100, 500));
}
TEST(GateSimulation, SharedMachine) {
    prove("shared", gate_simulation::shared, tests::by_size(250, 2000));
}
TEST(GateSimulation, CrowdedMachine) {
    prove("crowded", crowded, tests::by_size(100, 500));
}
TEST(GateSimulation, WildProcesses) {
    prove("wild", wild, tests::by_size(100, 500));
}
TEST(GateSimulation, BurstsOfNeighbours) {
    prove("bursts", bursts, tests::by_size(100, 500));
}

// The tolerance hides most of the error: without it the test errs as often as it promises, and not more.
TEST(GateSimulation, WithoutToleranceTheErrorIsWhatIsPromised) {
    GateOptions options;
    options.tolerance = options.frame_tolerance = 0.0;
    const int runs = tests::by_size(250, 2000);
    int alarms = 0;
    for (int run = 0; run < runs; ++run) {
        World world(gate_simulation::shared, std::uint64_t(run) * 31337u + 5u);
        alarms += run_gate(world, same_build(), same_build(), options).verdict == Verdict::slower;
    }
    std::printf("no tolerance: %d alarms in %d runs of equal builds\n", alarms, runs);
    EXPECT_LE(double(alarms) / runs, 0.015);
}

// Not a false alarm but a true change that nobody made: what remains of it is a limit of the gate.
TEST(GateSimulation, ARebuildThatMovesPassesByOnePercentSeldomAlarms) {
    const Rates rates = simulate(gate_simulation::shared, tests::by_size(150, 1000), 1.0, 0.01);
    print("shared", "rebuild", rates);
    EXPECT_LE(rates.share(rates.slower), 0.06);
}

TEST(GateSimulation, AUniformSlowDownIsCaughtAndSaid) {
    const int runs = tests::by_size(30, 200);
    int caught = 0, alike = 0;
    for (int run = 0; run < runs; ++run) {
        World world(gate_simulation::shared, std::uint64_t(run) + 1000u);
        Build head;
        head.fill(1.05);
        const GateReport report = run_gate(world, same_build(), head);
        caught += report.verdict == Verdict::slower;
        alike += report.all_alike;
    }
    std::printf("uniform 5 %%: caught %d, said as such %d of %d\n", caught, alike, runs);
    EXPECT_GE(caught, 0.95 * runs);
    EXPECT_GE(alike, 0.8 * runs);
}

// The simulated machine is as unkind as the ones that the usual ways fail on: percentages of false alarms, and the
// middle of the range that they must lie in.
TEST(GateSimulation, TheUsualWaysAlarmFalsely) {
    struct Way {
        const char* name;
        bool (*alarms)(World&);
        double expected_low, expected_high;
    };
    const Way ways[] = {
        {"base then head, Mann-Whitney over frames", base_then_head_mann_whitney, 0.55, 0.65},
        {"base then head, bootstrap over frames", base_then_head_bootstrap, 0.55, 0.65},
        {"interleaved, one process each", interleaved_signed_rank, 0.60, 0.70},
        {"16 pairs, interval per pass", pairs_uncorrected, 0.46, 0.46},
        {"16 pairs, bootstrap with Bonferroni", pairs_bootstrap, 0.16, 0.16},
    };
    const int runs = tests::by_size(120, 500);
    for (const Way& way : ways) {
        int alarms = 0;
        for (int run = 0; run < runs; ++run) {
            World world(gate_simulation::shared, std::uint64_t(run) * 104729u + 77u);
            alarms += way.alarms(world);
        }
        const double rate = double(alarms) / double(runs);
        std::printf("%-42s alarms in %4.1f %% of %d runs of equal builds\n", way.name, 100.0 * rate, runs);
        EXPECT_GE(rate, way.expected_low - 0.1) << way.name;
        EXPECT_LE(rate, way.expected_high + 0.1) << way.name;
    }
}

} // namespace
} // namespace sunfleck::statistics
