// The control of frame times against made-up machines: what a frame takes is a model's, and time goes by in the model
// alone.
#include "engine/statistics/summary.h"
#include "game_demo/frame_time_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace sunfleck::demo {
namespace {

constexpr FrameQuality usual{0.5f, 24, 16};

// A room on a machine: ms for what does not depend on the size, for all pixels of the window, and for a shadow map.
struct Room {
    double fixed, pixels, map;
    double time(const FrameQuality& quality) const {
        return fixed + pixels * double(quality.render_scale * quality.render_scale) + map * double(quality.maps);
    }
    double least() const { return time({FrameTimeControl::least_scale, FrameTimeControl::least_maps, 4}); }
};

// Frames vary by a tenth (standard deviation) and one in a hundred takes twice as long.
double noise(std::mt19937& random) {
    const double factor = std::exp(std::normal_distribution<double>(0.0, 0.08)(random));
    return std::uniform_real_distribution<double>(0.0, 1.0)(random) < 0.01 ? 2.0 * factor : factor;
}

struct Played {
    std::vector<double> frames;  // ms, from 5 s after the room was entered
    std::vector<double> changes; // of the size, s
};

// A minute in each room.
class Machine {
public:
    Machine(double target, std::uint32_t seed) : random_(seed) { control_.set(target, usual); }

    Played play(const Room& room, bool moves = true) {
        Played played;
        const double entered = now_;
        while (now_ - entered < 60.0) {
            const FrameQuality quality = control_.next(work_, now_, moves);
            if (quality.render_scale != scale_)
                played.changes.push_back(now_);
            scale_ = quality.render_scale;
            // What is in view changes as the person turns.
            work_ = room.time(quality) * noise(random_) * (1.0 + 0.12 * std::sin(2.0 * now_));
            const double frame = std::max(work_, control_.shortest_frame());
            now_ += 1e-3 * frame;
            if (now_ - entered > 5.0)
                played.frames.push_back(frame);
        }
        return played;
    }
    const FrameTimeControl& control() const { return control_; }
    float scale() const { return scale_; }

private:
    std::mt19937 random_;
    FrameTimeControl control_;
    double now_ = 100.0, work_ = 80.0;
    float scale_ = usual.render_scale;
};

const Room rooms[] = {{12.0, 150.0, 0.5}, {20.0, 240.0, 0.8}, {9.0, 90.0, 0.3}, {25.0, 130.0, 1.0}};

TEST(FrameTimeControl, HoldsTheTargetFiveSecondsAfterARoomWasEntered) {
    for (const double target : {33.0, 50.0, 66.0, 100.0})
        for (const std::uint32_t seed : {1u, 2u, 3u}) {
            Machine machine(target, seed);
            for (const Room& room : rooms) {
                if (1.2 * room.least() > target)
                    continue;
                const Played played = machine.play(room);
                const double high = statistics::percentile(played.frames, 0.95),
                             median = statistics::median(played.frames);
                EXPECT_LE(high, 1.15 * target) << target << " ms, fixed " << room.fixed << ", seed " << seed;
                EXPECT_GE(median, 0.8 * target) << target << " ms, fixed " << room.fixed << ", seed " << seed;
                EXPECT_FALSE(machine.control().out_of_reach());
            }
        }
}

TEST(FrameTimeControl, ChangesTheSizeOnceInTwoSecondsAndNotAtRest) {
    for (const std::uint32_t seed : {4u, 5u}) {
        Machine machine(50.0, seed);
        std::vector<double> changes;
        for (int round = 0; round < 3; ++round)
            for (const Room& room : rooms) {
                const std::vector<double> more = machine.play(room).changes;
                changes.insert(changes.end(), more.begin(), more.end());
            }
        for (std::size_t i = 1; i < changes.size(); ++i)
            EXPECT_GE(changes[i] - changes[i - 1], FrameTimeControl::scale_interval - 1e-6);
        EXPECT_GT(changes.size(), 3u) << "rooms differ, or this test would show nothing";
        EXPECT_LT(changes.size(), 12u * 8u) << "within a room it comes to rest";
        EXPECT_TRUE(machine.play(rooms[1], false).changes.empty()) << "nothing moves";
    }
}

TEST(FrameTimeControl, SaysWhatIsOutOfReach) {
    Machine machine(20.0, 6);
    machine.play(rooms[3]);
    EXPECT_TRUE(machine.control().out_of_reach());
    EXPECT_EQ(machine.scale(), FrameTimeControl::least_scale);
    machine.play(Room{2.0, 20.0, 0.1});
    EXPECT_FALSE(machine.control().out_of_reach()) << "another room is within it";
}

TEST(FrameTimeControl, IsOffWithoutATarget) {
    FrameTimeControl control;
    control.set(0.0, usual);
    for (int i = 0; i < 100; ++i)
        EXPECT_EQ(control.next(500.0, 0.1 * i, true), usual);
    EXPECT_EQ(control.shortest_frame(), 0.0);
    EXPECT_FALSE(control.out_of_reach());
}

// Never more than the player's settings ask for, but for the size of the picture.
TEST(FrameTimeControl, KeepsToTheSettings) {
    Machine machine(100.0, 7);
    machine.play(Room{5.0, 20.0, 0.1});
    EXPECT_GT(machine.scale(), 0.9f) << "there is time for a larger picture";
    FrameTimeControl control;
    control.set(50.0, {0.5f, 3, 2});
    for (int i = 0; i < 200; ++i) {
        const FrameQuality quality = control.next(i % 2 == 0 ? 500.0 : 5.0, 0.05 * i, true);
        EXPECT_EQ(quality.maps, 3u);
        EXPECT_EQ(quality.strength_budget, 2u);
    }
}

} // namespace
} // namespace sunfleck::demo
