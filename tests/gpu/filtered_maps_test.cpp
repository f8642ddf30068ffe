// Filtered look-ups of hemisphere maps on the CPU, where what the light sees is known: two walls that meet, and a sheet
// before a wall.
#include "engine/core/random.h"
#include "gi_module/shadows/octahedral_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace sunfleck::tests {
namespace {

using namespace shared;

constexpr float map_side = 128.0f; // texels

// n.p = -distance in light space, with n towards the light at the origin.
struct Plane {
    vec3 normal{0.0f};
    float distance = 1.0f;
    float value(vec3 direction) const { return value_on_plane(normal, distance, direction); }
};

struct Answer {
    float votes = 0.0f;  // of the texels one by one
    float result = 0.0f; // as shaders have it
};

// Of a receiver on `plane` in this direction (with w = 1); `stored`: what the map has for a texel centre's direction.
template <typename Stored>
Answer look(const Plane& plane, vec3 direction, const Stored& stored) {
    const float inverse_w = plane.value(direction) / shadow_near;
    const float receiver = shadow_near * inverse_w, reach = hemisphere_texel_reach(map_side);
    const float bias = perspective_bias(reach, plane.distance, inverse_w), step = depth_step(16);
    const HemisphereTolerance tolerance{shadow_filter_window * bias, shadow_filter_slack * reach * receiver, step,
                                        receiver * (1.0f + shadow_head_on_slack * reach) + step, 0.0f};
    const vec2 uv(direction.x + direction.y, direction.x - direction.y);
    const vec2 position = (uv * 0.5f + 0.5f) * map_side - 0.5f,
               corner = glm::clamp(glm::floor(position), 0.0f, map_side - 2.0f);
    vec4 lit(0.0f), votes(0.0f), values(0.0f);
    for (int i = 0; i < 4; ++i) {
        const vec2 texel = corner + vec2(float(i & 1), float(i >> 1));
        const vec3 centre = hemisphere_direction((texel + 0.5f) * (2.0f / map_side) - 1.0f);
        values[i] = std::round(std::min(stored(centre), 1.0f) * 65535.0f) / 65535.0f;
        const vec2 said = hemisphere_texel_vote(plane.value(centre), receiver, tolerance, values[i]);
        lit[i] = said.x;
        votes[i] = said.x + said.y;
    }
    const vec2 place = glm::clamp(position - corner, 0.0f, 1.0f);
    Answer answer;
    answer.votes = count_votes(lit, votes, place);
    answer.result = surface_votes(values, place, receiver, reach * receiver, step, answer.votes);
    return answer;
}

struct Numbers {
    RandomSequence random{SequenceKind::pseudo_random, 20, 7};
    float operator()(float low, float high) { return low + (high - low) * random.next(); }
    vec3 direction() { return glm::normalize(vec3((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1))); }
};

vec3 on_map(vec3 d) {
    return d / (std::abs(d.x) + std::abs(d.y) + d.z);
}

// Two walls that meet at a right angle at 0.5 to 4 m, and a receiver on one, up to three texels from the edge. From
// inside of a room, the light sees of each direction the nearer of the two, and nothing blocks any of it.
TEST(FilteredMaps, WallsThatMeetDoNotShadowEachOther) {
    Numbers number;
    double lost = 0.0, lost_before = 0.0, dark = 0.0, dark_before = 0.0;
    int count = 0;
    while (count < 20000) {
        const vec3 n = number.direction(), along = glm::normalize(glm::cross(n, number.direction()));
        const Plane wall{n, 0.5f + 3.5f * number(0, 1)}, other{glm::cross(n, along), number(0.05f, 4.0f)};
        // On the edge, then away from the other wall.
        const vec3 edge = -wall.distance * wall.normal - other.distance * other.normal + number(-1.0f, 1.0f) * along;
        const float texel = 2.0f * hemisphere_texel_reach(map_side) * glm::length(edge);
        const vec3 point = edge + other.normal * number(0.0f, 3.0f * texel);
        if (point.z < 0.05f * glm::length(point))
            continue;
        ++count;
        const Answer answer =
            look(wall, on_map(point), [&](vec3 d) { return std::max(wall.value(d), other.value(d)); });
        EXPECT_GE(answer.result, answer.votes);
        lost += 1.0 - answer.result;
        lost_before += 1.0 - answer.votes;
        dark += answer.result < 0.5f ? 1.0 : 0.0;
        dark_before += answer.votes < 0.5f ? 1.0 : 0.0;
    }
    std::printf("lost %.4f, by votes alone %.4f; dark %.4f, %.4f\n", lost / count, lost_before / count, dark / count,
                dark_before / count);
    EXPECT_LT(lost, 0.5 * lost_before);
    EXPECT_LT(dark, 0.5 * dark_before);
}

// A sheet before all of a wall that is farther behind it than what is documented to be missed, and one with an edge: a
// texel and more inside of the edge the wall is dark.
TEST(FilteredMaps, WhatIsBehindASheetIsDark) {
    Numbers number;
    const float reach = hemisphere_texel_reach(map_side);
    for (int i = 0; i < 20000; ++i) {
        const vec3 q = hemisphere_direction(vec2(number(-0.9f, 0.9f), number(-0.9f, 0.9f)));
        vec3 n = number.direction();
        n = glm::dot(n, q) < 0.0f ? n : -n;
        if (-glm::dot(n, q) < 0.5f * glm::length(q))
            continue;
        const Plane wall{n, 1.0f};
        // Parallel to the wall, and nearer by more than a surface's slope takes up within the four texels.
        const float gap = (shadow_filter_window / 0.5f + 2.0f) * reach * (1.0f + number(0.0f, 3.0f));
        const Plane sheet{n, 1.0f / (1.0f + gap)};
        EXPECT_EQ(look(wall, q, [&](vec3 d) { return sheet.value(d); }).result, 0.0f);
        const vec2 edge = glm::normalize(vec2(number(-1, 1), number(-1, 1)));
        const float place = glm::dot(edge, vec2(q.x + q.y, q.x - q.y));
        const auto cut = [&](float texels) {
            return look(wall, q,
                        [&](vec3 d) {
                            const bool covered =
                                glm::dot(edge, vec2(d.x + d.y, d.x - d.y)) < place + texels * 2.0f / map_side;
                            return covered ? sheet.value(d) : wall.value(d);
                        })
                .result;
        };
        EXPECT_NEAR(cut(1.5f), 0.0f, 1e-5f); // rounding of weights
        EXPECT_NEAR(cut(-1.5f), 1.0f, 1e-5f);
    }
}

} // namespace
} // namespace sunfleck::tests
