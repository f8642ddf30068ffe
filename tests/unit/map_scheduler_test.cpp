// The order in which shadow maps are redrawn.
#include "gi_module/shadows/map_budget.h"
#include "gi_module/shadows/map_scheduler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <numeric>
#include <random>

namespace sunfleck::gi {
namespace {

std::vector<LightSample> samples_of(std::size_t count, std::mt19937& random) {
    std::vector<LightSample> samples(count);
    for (LightSample& sample : samples) {
        sample.flux = vec3(std::pow(10.0f, float(random() % 1000) / 100.0f - 5.0f)); // ten orders of magnitude
        sample.bounce = random() % 4;
    }
    return samples;
}

// A machine that takes 0.1 ms a map, and then, under load, 0.4 ms; times arrive three frames late.
TEST(MapBudget, KeepsToTheTimeThatItIsGiven) {
    MapBudget budget;
    EXPECT_EQ(budget.maps_in(5.0, 77), 77u);
    std::deque<std::pair<std::uint64_t, double>> late;
    double a_map = 0.1;
    std::uint32_t maps = 0;
    for (std::uint64_t serial = 1; serial <= 80; ++serial) {
        if (late.size() == 3) {
            budget.add_time(late.front().first, late.front().second);
            late.pop_front();
        }
        maps = budget.maps_in(5.0, 77);
        budget.add_frame(serial, maps);
        late.emplace_back(serial, a_map * double(maps));
        if (serial == 30) {
            EXPECT_NEAR(maps, 50, 1);
            a_map = 0.4;
        }
    }
    EXPECT_NEAR(maps, 12, 1);
    EXPECT_EQ(budget.maps_in(0.001, 77), 1u) << "some progress is always made";
    MapBudget other;
    other.add_frame(5, 10);
    other.add_time(4, 100.0); // not known
    other.add_time(6, 100.0);
    EXPECT_EQ(other.maps_in(5.0, 77), 77u);
    other.add_frame(7, 0); // nothing was drawn
    other.add_time(7, 3.0);
    EXPECT_EQ(other.maps_in(5.0, 77), 77u);
}

// With the time, a map that shows waits 100 ms or two frames at most, whatever the budget; one that does not show waits
// for its turn.
TEST(MapScheduler, MapsThatShowAreNotLate) {
    std::mt19937 random(23);
    const auto samples = samples_of(100, random);
    for (const double frame_ms : {10.0, 40.0, 250.0}) {
        MapScheduler scheduler;
        scheduler.reset(samples.size());
        std::vector<std::uint32_t> all(samples.size());
        std::iota(all.begin(), all.end(), 0u);
        scheduler.done(all);
        std::vector<float> shows(samples.size(), 0.0f);
        for (std::size_t i = 0; i < samples.size(); i += 3)
            shows[i] = 1.0f;
        std::vector<double> stale_since(samples.size(), -1.0);
        std::size_t hidden = 0;
        for (int frame = 0; frame < 200; ++frame) {
            const double now = frame * frame_ms;
            scheduler.begin_frame(false);
            scheduler.advance(now);
            for (std::uint32_t i = 0; i < samples.size(); ++i) {
                scheduler.mark(i);
                if (stale_since[i] < 0.0)
                    stale_since[i] = now;
            }
            const auto within = scheduler.choose(samples, MapPriority::contribution, 3, shows);
            ASSERT_EQ(within.size(), 3u);
            const auto drawn = scheduler.with_late_ones(within, shows);
            EXPECT_TRUE(std::includes(drawn.begin(), drawn.end(), within.begin(), within.end()));
            for (const std::uint32_t i : drawn)
                stale_since[i] = -1.0;
            scheduler.done(drawn);
            for (std::uint32_t i = 0; i < samples.size(); ++i) {
                if (stale_since[i] < 0.0)
                    continue;
                const double waited = now + frame_ms - stale_since[i]; // when the next frame can draw it
                if (shows[i] > 0.0f) {
                    EXPECT_LE(waited, std::max(MapScheduler::longest_lag + frame_ms, 2.0 * frame_ms)) << frame_ms;
                } else
                    hidden += waited > 2.0 * std::max(MapScheduler::longest_lag, frame_ms) ? 1 : 0;
            }
        }
        EXPECT_GT(hidden, 0u) << "those that do not show have no such bound";
    }
}

// Every frame all maps become stale again; whatever its flux, none waits longer than 8 * ceil(stale / budget) frames.
TEST(MapScheduler, NoMapStarves) {
    std::mt19937 random(17);
    for (const MapPriority priority : {MapPriority::contribution, MapPriority::flux_and_age, MapPriority::age})
        for (const std::uint32_t budget : {1u, 7u, 100u, 300u, 1000u}) {
            const auto samples = samples_of(300, random);
            MapScheduler scheduler;
            scheduler.reset(samples.size());
            const std::uint32_t limit = 8 * ((300 + budget - 1) / budget);
            std::vector<std::uint32_t> waited(samples.size(), 0);
            const int frames = budget == 1 ? 6000 : 600;
            for (int frame = 0; frame < frames; ++frame) {
                scheduler.advance();
                for (std::uint32_t i = 0; i < samples.size(); ++i)
                    scheduler.mark(i);
                for (std::uint32_t& frames_waited : waited)
                    ASSERT_LE(++frames_waited, limit);
                const auto chosen = scheduler.choose(samples, priority, budget);
                ASSERT_EQ(chosen.size(), std::min<std::size_t>(budget, 300));
                ASSERT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
                scheduler.done(chosen);
                for (const std::uint32_t i : chosen)
                    waited[i] = 0;
            }
        }
}

TEST(MapScheduler, BrightMapsGoFirstAndFreshOnesNotAtAll) {
    std::mt19937 random(3);
    auto samples = samples_of(10, random);
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i].flux = vec3(float(i), 0.0f, 0.0f);
    MapScheduler scheduler;
    scheduler.reset(samples.size());
    const std::vector<std::uint32_t> all = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    EXPECT_TRUE(scheduler.is_static_stale(3));
    EXPECT_EQ(scheduler.unusable(), 10u);
    EXPECT_EQ(scheduler.choose(samples, MapPriority::flux_and_age, 2), (std::vector<std::uint32_t>{8, 9}));
    scheduler.done(all);
    for (const std::uint32_t i : all)
        scheduler.mark(i);
    EXPECT_EQ(scheduler.choose(samples, MapPriority::flux_and_age, 2), (std::vector<std::uint32_t>{8, 9}));
    scheduler.mark_static(1);
    EXPECT_EQ(scheduler.choose(samples, MapPriority::flux_and_age, 2), (std::vector<std::uint32_t>{1, 9}));
    scheduler.done(all);
    EXPECT_EQ(scheduler.stale(), 0u);
    EXPECT_FALSE(scheduler.is_static_stale(3));
    scheduler.mark(4);
    EXPECT_EQ(scheduler.choose(samples, MapPriority::flux_and_age, 5), (std::vector<std::uint32_t>{4}));
    EXPECT_FALSE(scheduler.is_static_stale(4));
    EXPECT_TRUE(scheduler.choose(samples, MapPriority::flux_and_age, 0).empty());
}

// What a map decides in the picture goes before flux; what decides nothing is redrawn in its turn, a few a frame.
TEST(MapScheduler, ContributionsGoFirstAndNothingComesInBursts) {
    std::mt19937 random(5);
    const auto samples = samples_of(100, random);
    MapScheduler scheduler;
    scheduler.reset(samples.size());
    std::vector<float> contributions(samples.size(), 0.0f);
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        contributions[i] = i < 20 ? 10.0f + float(i) : 0.0f;
        all.push_back(i);
    }
    scheduler.done(all);
    int unseen_at_most = 0, seen = 0;
    for (int frame = 0; frame < 100; ++frame) {
        scheduler.advance();
        for (const std::uint32_t i : all)
            scheduler.mark(i);
        const auto chosen = scheduler.choose(samples, MapPriority::contribution, 25, contributions);
        if (frame == 0) {
            EXPECT_EQ(std::count_if(chosen.begin(), chosen.end(), [](std::uint32_t i) { return i < 20; }), 20);
        }
        const int unseen = int(std::count_if(chosen.begin(), chosen.end(), [](std::uint32_t i) { return i >= 20; }));
        unseen_at_most = std::max(unseen_at_most, unseen);
        seen += int(chosen.size()) - unseen;
        scheduler.done(chosen);
    }
    EXPECT_GT(seen, 100 * 14) << "those in sight are redrawn in most frames";
    EXPECT_LT(unseen_at_most, 20) << "never all of the budget for those out of sight";
}

// A lost frame's maps are as stale as before it, a frame older; what was marked in between stays marked.
TEST(MapScheduler, MapsOfALostFrameAreStaleAgain) {
    MapScheduler scheduler;
    scheduler.reset(4);
    const std::vector<std::uint32_t> all = {0, 1, 2, 3}, some = {1, 2};
    scheduler.begin_frame(false);
    scheduler.done(all);
    scheduler.begin_frame(false); // those were drawn
    scheduler.advance();
    scheduler.mark(1, 0.5f);
    scheduler.mark_static(2);
    scheduler.done(some);
    scheduler.mark(3, 0.25f); // by an update that ended with an error
    scheduler.begin_frame(true);
    scheduler.advance();
    EXPECT_EQ(std::vector(scheduler.ages().begin(), scheduler.ages().end()), (std::vector<std::uint32_t>{0, 2, 2, 2}));
    EXPECT_FALSE(scheduler.is_static_stale(1));
    EXPECT_TRUE(scheduler.is_static_stale(2));
    EXPECT_EQ(scheduler.lag(1), 0.5f);
    scheduler.mark(1, 0.25f);
    EXPECT_EQ(scheduler.lag(1), 0.75f);
    scheduler.done(all);
    scheduler.begin_frame(false);
    EXPECT_EQ(scheduler.stale(), 0u);
    scheduler.done(all);
    scheduler.reset(2); // other samples: maps that were drawn for the old ones do not matter
    scheduler.begin_frame(true);
    EXPECT_EQ(scheduler.stale(), 2u);
}

TEST(MapScheduler, FluxDecidesWhereNothingContributes) {
    std::mt19937 random(5);
    const auto samples = samples_of(100, random);
    MapScheduler scheduler;
    scheduler.reset(samples.size());
    for (std::uint32_t i = 0; i < samples.size(); ++i)
        scheduler.mark(i);
    const auto by_flux = scheduler.choose(samples, MapPriority::flux_and_age, 25);
    EXPECT_EQ(scheduler.choose(samples, MapPriority::contribution, 25), by_flux);
    EXPECT_EQ(scheduler.choose(samples, MapPriority::contribution, 25, std::vector<float>(100, 0.0f)), by_flux);
}

} // namespace
} // namespace sunfleck::gi
