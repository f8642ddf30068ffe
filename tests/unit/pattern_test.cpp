// Patterns over a pixel against the mean of many points in it.
#include "engine/core/maths.h"
#include "engine/scene/pattern_shared.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace sunfleck {
namespace {

using namespace shared;

constexpr float pattern_scale = 0.25f; // m

// On a floor.
float mean_of_points(std::uint32_t kind, vec3 centre, vec3 footprint) {
    constexpr int side = 24;
    float sum = 0.0f;
    for (int i = 0; i < side * side; ++i) {
        const vec3 beside(float(i % side) + 0.5f, 0.0f, float(i / side) + 0.5f);
        sum += pattern_share(kind, pattern_scale, centre + footprint * (beside / float(side) - vec3(0.5f, 0.0f, 0.5f)),
                             vec3(0.0f, 1.0f, 0.0f));
    }
    return sum / float(side * side);
}

// Root mean square over places, of the filtered pattern and of the pattern at the pixel's middle.
struct PatternErrors {
    double filtered = 0.0, point = 0.0;
};
PatternErrors errors_of(std::uint32_t kind, vec3 footprint) {
    constexpr int places = 400;
    PatternErrors errors;
    for (int i = 0; i < places; ++i) {
        const vec3 centre(3.0f * std::fmod(0.618034f * float(i), 1.0f), 0.01f, 3.0f * (float(i) + 0.5f) / places);
        const vec3 up(0.0f, 1.0f, 0.0f);
        const float truth = mean_of_points(kind, centre, footprint);
        const float filtered = filtered_pattern_share(kind, pattern_scale, centre, up, footprint);
        const float point = pattern_share(kind, pattern_scale, centre, up);
        EXPECT_GE(filtered, -1e-3f);
        EXPECT_LE(filtered, 1.001f);
        errors.filtered += double(filtered - truth) * double(filtered - truth) / places;
        errors.point += double(point - truth) * double(point - truth) / places;
    }
    return {std::sqrt(errors.filtered), std::sqrt(errors.point)};
}

constexpr std::uint32_t all_patterns[] = {pattern_checker, pattern_planks, pattern_bricks, pattern_marble};

TEST(Pattern, OverNoAreaIsThePatternItself) {
    const vec3 up(0.0f, 1.0f, 0.0f);
    for (const std::uint32_t kind : all_patterns) {
        double difference = 0.0; // in the mean: a place may be on the very edge of a line
        for (int i = 0; i < 1000; ++i) {
            const vec3 place(0.0137f * float(i), 0.013f, 0.00731f * float(i));
            difference += std::abs(double(filtered_pattern_share(kind, pattern_scale, place, up, vec3(0.0f)) -
                                          pattern_share(kind, pattern_scale, place, up)));
        }
        EXPECT_LT(difference / 1000.0, 2e-3) << kind;
    }
}

// Checkers are exact but for the sampled mean's own error. Planks and bricks take the tones of all that a pixel shows,
// if it shows more than two, for the mean of all tones, marble's veins are straight within a pixel: approximations, far
// better than one point.
TEST(Pattern, OverAPixelIsTheMeanOfItsPoints) {
    for (const std::uint32_t kind : all_patterns)
        for (const vec3 footprint : {vec3(0.02f, 0.0f, 0.02f), vec3(0.1f, 0.0f, 0.05f), vec3(0.3f, 0.0f, 0.4f)}) {
            const PatternErrors errors = errors_of(kind, footprint);
            EXPECT_LT(errors.filtered, kind == pattern_checker ? 0.03 : 0.8 * errors.point)
                << kind << " " << footprint.x << " " << footprint.z << " point " << errors.point;
        }
}

// A plank's tone gives way to the next one's as a pixel reaches over the joint between them. With the tone of the
// pixel's middle alone, the errors were 0.14 and 0.25 of the point's.
TEST(Pattern, PlanksThatAPixelReachesIntoLendItTheirTones) {
    for (const auto& [footprint, share] :
         {std::pair(vec3(0.1f, 0.0f, 0.05f), 0.09), std::pair(vec3(0.02f, 0.0f, 0.15f), 0.19)}) {
        const PatternErrors errors = errors_of(pattern_planks, footprint);
        EXPECT_LT(errors.filtered, share * errors.point) << footprint.z;
    }
}

} // namespace
} // namespace sunfleck
