// What the Lighting panel says a setting costs: the interval that it shows contains what a four times longer
// measurement finds, and the pass that takes more is named.
#include "engine/statistics/clipped_sum.h"
#include "tests/editor/cost_fixture.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

namespace sunfleck::editor {
namespace {

struct Change {
    const char *setting, *value; // over the default
};

class EditorCost : public CostFixture {
protected:
    // Over the default, with all else as the document has it.
    Cost measure(const Change& change, CostEffort effort) const {
        return CostFixture::measure(scene_with({{change.setting, change.value}}), change.setting, document_->settings(),
                                    effort);
    }
};

// Ten settings, three of which need other samples (lights, bounces, direct_share), and some without effect here.
constexpr Change all_changes[] = {{"low_resolution", "2"},    {"lights", "500"},
                                  {"shadow_filter", "false"}, {"bounces", "1"},
                                  {"baked_light", "false"},   {"light_maps", "false"},
                                  {"visibility", "false"},    {"repair_angle", "2"},
                                  {"direct_share", "0.75"},   {"transfer_reflections", "0"}};

// What was found for one of them, as a line of JSON.
struct Found {
    std::string setting;
    double width = 0.0; // of the interval, as a share of the frame
    bool contained = false;
};

// What the sources are, which SUNFLECK_COST_SOURCES says: results of others do not count.
std::string sources() {
    const char* const text = std::getenv("SUNFLECK_COST_SOURCES");
    return text == nullptr ? "" : text;
}

// The file that SUNFLECK_COST_RESULTS names has a line for each setting that was measured; those are not measured
// again, so that what takes an hour can be done in pieces. SUNFLECK_COST_MOST: so many in this piece.
std::vector<Found> found_before(const char* path) {
    std::vector<Found> result;
    std::ifstream file(path == nullptr ? "" : path);
    for (std::string line; std::getline(file, line);)
        if (const auto json = nlohmann::json::parse(line, nullptr, false);
            json.is_object() && json.value("sources", "") == sources())
            result.push_back({json["setting"], json["width"], json["contained"]});
    return result;
}

// The time for each by SUNFLECK_COST_SECONDS, 60 in the long size; where the interval is narrow enough sooner, that is
// all that the panel would have taken, and a longer measurement takes four times that. They are held against each other
// as shares of the frame, since the machine may be faster now than it was then.
TEST_F(EditorCost, IntervalsContainWhatALongerMeasurementFinds) {
    const char* const seconds_text = std::getenv("SUNFLECK_COST_SECONDS");
    const char* const results = std::getenv("SUNFLECK_COST_RESULTS");
    const char* const most_text = std::getenv("SUNFLECK_COST_MOST");
    const double seconds = seconds_text != nullptr ? std::atof(seconds_text) : tests::by_size(1.0, 60.0);
    int left = most_text != nullptr ? std::atoi(most_text) : tests::by_size(1, int(std::size(all_changes)));
    std::vector<Found> found = found_before(results);
    for (const Change& change : all_changes) {
        if (std::any_of(found.begin(), found.end(), [&](const Found& one) { return one.setting == change.setting; }) ||
            left-- <= 0)
            continue;
        const Cost shown = measure(change, {0.0, seconds});
        const Cost longer = measure(change, {4.0 * shown.seconds, 4.0 * shown.seconds});
        const double estimate = longer.frame.estimate / longer.frame_ms;
        found.push_back(
            {change.setting, width(shown) / shown.frame_ms,
             estimate >= shown.frame.low / shown.frame_ms && estimate <= shown.frame.high / shown.frame_ms});
        std::printf("%-20s %s; after %.0f s, %zu rounds and %zu pairs the interval is %.1f %% of the frame; four times "
                    "longer: %+.2f ms (%.2f to %.2f) of %.1f ms\n",
                    change.setting, cost_text(shown).c_str(), shown.seconds, shown.rounds, shown.pairs,
                    100.0 * found.back().width, longer.frame.estimate, longer.frame.low, longer.frame.high,
                    longer.frame_ms);
        std::fflush(stdout);
        if (results != nullptr)
            std::ofstream(results, std::ios::app) << nlohmann::json{{"sources", sources()},
                                                                    {"setting", change.setting},
                                                                    {"width", found.back().width},
                                                                    {"contained", found.back().contained}}
                                                         .dump()
                                                  << "\n";
    }
    const auto is_narrow = [](const Found& one) { return one.width <= 0.05; };
    const auto contained = std::count_if(found.begin(), found.end(), [](const Found& one) { return one.contained; });
    const auto right =
        std::count_if(found.begin(), found.end(), [&](const Found& one) { return one.contained && is_narrow(one); });
    std::printf("%zu of %zu settings: %d intervals contain what was found later, %d are 5 %% of the frame or less, %d "
                "both\n",
                found.size(), std::size(all_changes), int(contained),
                int(std::count_if(found.begin(), found.end(), is_narrow)), int(right));
    // Of ten at full size. In the short one an interval of a second says little, but that all is in order.
    if (found.size() == std::size(all_changes)) {
        EXPECT_GE(right, 8);
    }
}

// Five times as many light samples: that costs, and the pass is named.
TEST_F(EditorCost, TheDearerPassIsNamed) {
    const Cost dear = measure({"lights", "1500"}, {0.0, tests::by_size(4.0, 60.0)});
    EXPECT_GT(dear.frame.low, 0.0) << cost_text(dear);
    EXPECT_GE(dear.pairs, 2u) << "where a copy lies in memory must not count";
    EXPECT_TRUE(std::any_of(dear.passes.begin(), dear.passes.end(), [](const auto& pass) {
        return pass.first.find("light") != std::string::npos && pass.second.estimate > 0.0;
    })) << cost_text(dear);
    std::printf("%s\n", cost_text(dear).c_str());
}

// A setting of a technique that lights nothing here. An interval of 95 % is beside the truth once in twenty: two of
// three say that there is no effect. The few seconds of the short size may be too few for that; that nothing can be
// measured is an answer then.
TEST_F(EditorCost, ASettingWithoutEffectIsShownAsSuch) {
    int without = 0;
    for (int time = 1; time <= 3 && without < 2; ++time) {
        const Cost none = measure({"transfer_reflections", "0"}, {0.0, tests::by_size(3.0, 60.0)});
        std::printf("%s\n", cost_text(none).c_str());
        EXPECT_TRUE(none.finished);
        const std::string text = cost_text(none);
        const bool nothing = text.starts_with("no measurable effect over ");
        const bool small = std::abs(none.frame.estimate) < 0.1 * none.frame_ms;
        without += nothing || (!tests::long_size() && small && text.starts_with("not measurable over ")) ? 1 : 0;
    }
    EXPECT_EQ(without, 2);
}

// What is shown for each kind of finding.
TEST(EditorCostText, SaysWhetherThereIsAnEffect) {
    Cost cost;
    cost.from = "300";
    cost.rounds = 9;
    cost.finished = true;
    cost.frame_ms = 20.0;
    cost.frame = {0.1, -0.2, 0.4};
    EXPECT_EQ(cost_text(cost), "no measurable effect over 300 (less than 0.40 ms)");
    cost.frame = {0.1, -2.0, 2.2};
    EXPECT_EQ(cost_text(cost), "not measurable over 300 (-2.00 to 2.20 ms)");
    cost.frame = {0.3, 0.1, 0.5};
    EXPECT_EQ(cost_text(cost), "+0.30 ms (0.10 to 0.50) of 20.0 ms over 300");
    cost.frame = {-0.3, -0.5, -0.1};
    EXPECT_EQ(cost_text(cost), "-0.30 ms (-0.50 to -0.10) of 20.0 ms over 300");
    cost.finished = false;
    EXPECT_TRUE(cost_text(cost).ends_with(" ..."));
    cost.rounds = 1;
    EXPECT_EQ(cost_text(cost), "measuring ...");
    cost.error = "The device was lost";
    EXPECT_EQ(cost_text(cost), "The device was lost");
}

// A machine that is slow by up to half for a while, with noise and some wild samples: 95 % of intervals contain the
// truth (of 400, within four standard deviations), and they are narrower than those of differences in milliseconds.
TEST(EditorCostInterval, ContainsTheTruthOnAMachineThatDrifts) {
    std::mt19937 random(11);
    std::normal_distribution<double> noise(0.0, 0.08);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    constexpr double usual = 40.0, factor = 1.15;
    constexpr int runs = 400, pairs = 30;
    int contained = 0;
    double ratios_width = 0.0, differences_width = 0.0;
    for (int run = 0; run < runs; ++run) {
        std::vector<double> log_ratios, differences;
        double speed = 1.0;
        for (int pair = 0; pair < pairs; ++pair) {
            speed = share(random) < 0.2 ? 1.0 + 0.5 * share(random) : speed;
            const auto block = [&](double milliseconds) {
                const double wild = share(random) < 0.05 ? 1.0 + share(random) : 1.0;
                return milliseconds * speed * wild * std::exp(noise(random));
            };
            const double first = block(usual), second = block(factor * usual);
            log_ratios.push_back(std::log(second / first));
            differences.push_back(second - first);
        }
        const CostInterval interval = cost_of_ratios(log_ratios, usual), other = cost_interval(differences);
        const double truth = (factor - 1.0) * usual;
        contained += truth >= interval.low && truth <= interval.high ? 1 : 0;
        ratios_width += interval.high - interval.low;
        differences_width += other.high - other.low;
    }
    EXPECT_NEAR(double(contained) / runs, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / runs));
    EXPECT_LT(ratios_width, differences_width);
}

// One copy of a pair is slower than the other for as long as both exist, by chance: intervals of one pair's rounds are
// beside the truth in more than a fifth of the runs. Of 400, within four standard deviations.
TEST(EditorCostInterval, ContainsTheTruthThoughCopiesDiffer) {
    std::mt19937 random(13);
    std::normal_distribution<double> noise(0.0, 0.02), place(0.0, 0.02);
    constexpr double usual = 40.0, factor = 1.1;
    constexpr int runs = 400, pairs = 8, rounds = 10;
    int by_pairs = 0, by_rounds = 0, by_one_pair = 0;
    for (int run = 0; run < runs; ++run) {
        std::vector<double> of_pairs, of_rounds;
        for (int pair = 0; pair < pairs; ++pair) {
            std::vector<double> own;
            own.reserve(rounds);
            const double difference = place(random);
            for (int round = 0; round < rounds; ++round)
                own.push_back(std::log(factor) + difference + noise(random));
            of_pairs.push_back(statistics::clipped_centre(own, 0.0));
            if (pair == 0)
                of_rounds = own;
        }
        const double truth = (factor - 1.0) * usual;
        const auto contains = [&](const CostInterval& one) { return truth >= one.low && truth <= one.high; };
        by_pairs += contains(cost_of_ratios(of_pairs, usual)) ? 1 : 0;
        const CostInterval one_pair = cost_of_ratios(of_rounds, usual);
        by_rounds += contains(one_pair) ? 1 : 0;
        by_one_pair += contains(with_few_pairs(one_pair, 1, usual)) ? 1 : 0;
    }
    EXPECT_NEAR(double(by_pairs) / runs, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / runs));
    EXPECT_LT(double(by_rounds) / runs, 0.8);
    EXPECT_GT(double(by_one_pair) / runs, 0.95 - 4.0 * std::sqrt(0.95 * 0.05 / runs));
}

// What disturbs a round disturbs the next ones, too (by four fifths each): intervals that took them for independent
// would contain the truth in less than half of the runs. Of 400, within four standard deviations of 93 %: sixteen parts
// of 25 rounds still know a little of each other.
TEST(EditorCostInterval, ContainsTheTruthWhereNeighboursAreDisturbedAlike) {
    std::mt19937 random(12);
    std::normal_distribution<double> noise(0.0, 0.03);
    constexpr double usual = 40.0, factor = 1.1;
    constexpr int runs = 400, rounds = 400;
    int contained = 0;
    for (int run = 0; run < runs; ++run) {
        std::vector<double> log_ratios;
        double disturbed = noise(random) / 0.6; // as strong as later on
        for (int round = 0; round < rounds; ++round) {
            disturbed = 0.8 * disturbed + noise(random);
            log_ratios.push_back(std::log(factor) + disturbed);
        }
        const CostInterval interval = cost_of_ratios(log_ratios, usual);
        const double truth = (factor - 1.0) * usual;
        contained += truth >= interval.low && truth <= interval.high ? 1 : 0;
    }
    EXPECT_NEAR(double(contained) / runs, 0.93, 4.0 * std::sqrt(0.93 * 0.07 / runs));
}

} // namespace
} // namespace sunfleck::editor
