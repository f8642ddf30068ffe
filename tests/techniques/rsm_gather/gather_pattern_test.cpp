// The pattern by which maps are sampled stands for each texel alike, and points of the scene lie in a map where the ray
// that meets them has its texel.
#include "gi_module/rsm_gather/gather_maps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sunfleck::tests {
namespace {

// In the mean over seeds, each texel counts once, wherever in its own texel the pixel lies. Of a disc that does not
// reach the corners of the map, the texels there count less.
TEST(GatherPattern, StandsForEachTexelOnce) {
    constexpr std::uint32_t side = 8, seeds = 20000;
    const auto mean_weights = [&](float radius, vec2 within) {
        std::vector<double> sums(side * side, 0.0);
        for (std::uint32_t seed = 1; seed <= seeds; ++seed)
            for (const shared::GatherSample& sample : gi::gather_pattern(24, side, radius, seed, false)) {
                const ivec2 at = ivec2(glm::floor(within + sample.offset)) & int(side - 1);
                sums[std::size_t(at.y) * side + std::size_t(at.x)] += double(sample.weight) / seeds;
            }
        return sums;
    };
    for (const vec2 within : {vec2(0.5f), vec2(0.1f, 0.9f)})
        for (const double weight : mean_weights(0.7072f, within))
            EXPECT_NEAR(weight, 1.0, 0.08);
    const std::vector<double> narrow = mean_weights(0.25f, vec2(0.5f));
    EXPECT_NEAR(narrow[0], 1.0, 0.05);
    EXPECT_EQ(narrow[4 * side + 4], 0.0);
}

TEST(GatherPattern, WithAsManySamplesAsTexelsIsTheWholeMap) {
    constexpr std::uint32_t side = 16;
    std::vector<int> times(side * side, 0);
    for (const shared::GatherSample& sample : gi::gather_pattern(side * side, side, 0.1f, 3, true)) {
        ++times[std::size_t(sample.offset.y) * side + std::size_t(sample.offset.x)];
        EXPECT_EQ(sample.weight, 1.0f);
        EXPECT_EQ(sample.softness, 1.0f);
    }
    for (const int count : times)
        EXPECT_EQ(count, 1);
}

gi::Emitter emitter_of(gi::EmitterKind kind) {
    gi::Emitter emitter;
    emitter.kind = kind;
    const mat4 turned = glm::rotate(mat4(1.0f), 0.7f, glm::normalize(vec3(1.0f, 2.0f, -0.5f)));
    emitter.matrix = glm::translate(mat4(1.0f), vec3(0.3f, 1.2f, -0.4f)) * turned;
    emitter.flux = vec3(1.0f);
    emitter.inner_cosine = 0.9f;
    emitter.outer_cosine = 0.6f;
    emitter.scene_radius = 4.0f;
    emitter.scene_centre = vec3(0.1f, 0.2f, 0.3f);
    emitter.width = emitter.height = emitter.radius = 1e-4f; // its places are one
    return emitter;
}

// Rays of a place of the map, somewhere along them, lie at that place.
TEST(GatherProjection, InvertsTheRaysOfEmitters) {
    for (const gi::EmitterKind kind : {gi::EmitterKind::point, gi::EmitterKind::spot, gi::EmitterKind::rectangle,
                                       gi::EmitterKind::disc, gi::EmitterKind::directional}) {
        const gi::Emitter emitter = emitter_of(kind);
        const shared::GatherMapRow row = gi::projection_of(emitter);
        const bool parallel = kind == gi::EmitterKind::directional;
        for (float u = 0.05f; u < 0.96f; u += 0.1f)
            for (float v = 0.03f; v < 1.0f; v += 0.13f) {
                const float numbers[4] = {parallel ? u : 0.4f, parallel ? v : 0.6f, parallel ? 0.4f : u,
                                          parallel ? 0.6f : v};
                const gi::EmittedRay ray = gi::sample_emitter_ray(emitter, numbers);
                const vec2 place = shared::place_in_map(row, ray.origin + 2.5f * ray.direction);
                EXPECT_NEAR(place.x, u, 2e-3f) << int(kind) << " at " << u << ", " << v;
                EXPECT_NEAR(place.y, v, 2e-3f) << int(kind) << " at " << u << ", " << v;
            }
    }
    // Where neighbours in the map are none in the scene, all pixels share one place.
    const shared::GatherMapRow row = gi::projection_of(emitter_of(gi::EmitterKind::environment));
    EXPECT_EQ(shared::place_in_map(row, vec3(1.0f)), shared::place_in_map(row, vec3(-3.0f, 1.0f, 0.0f)));
}

} // namespace
} // namespace sunfleck::tests
