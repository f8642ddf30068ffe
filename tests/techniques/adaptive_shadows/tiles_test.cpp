// Tiles of adaptive shadow maps: which are needed, and which lie in memory.
#include "gi_module/adaptive_shadows/tile_store.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/transport/light_row.h"

#include "engine/core/random.h"

#include <gtest/gtest.h>

namespace sunfleck::gi {
namespace {

vec3 random_vector(std::uint32_t seed, std::uint32_t index) {
    const RandomSequence random(SequenceKind::pseudo_random, seed, index);
    return 2.0f * vec3(random.at(0), random.at(1), random.at(2)) - 1.0f;
}

// Map coordinates of a point, as shaders compute them.
vec2 place_on_map(const shared::LightRow& row, std::uint32_t light_class, vec3 point) {
    const vec3 v = point - vec3(row.position_bound);
    const vec3 d(glm::dot(vec3(row.tangent_scale), v), glm::dot(vec3(row.bitangent), v),
                 glm::dot(vec3(row.normal_offset), v));
    if (light_class == shared::light_class_directional)
        return vec2(d) * row.tangent_scale.w;
    return vec2(row.position_bound.w > 0.0f ? shared::cone_map(d, row.position_bound.w) : shared::sphere_map(d));
}

LightSample light_of(SampleKind kind, std::uint32_t number) {
    LightSample sample;
    sample.kind = kind;
    sample.position = 3.0f * random_vector(11, number);
    sample.normal = glm::normalize(random_vector(12, number));
    sample.flux = vec3(1.0f);
    if (kind == SampleKind::spot) { // half angle of 30 degrees
        sample.cone_scale = 10.0f;
        sample.cone_offset = -10.0f * 0.8660254f;
    }
    return sample;
}

mat4 view_of(std::uint32_t number) {
    const vec3 eye = 4.0f * random_vector(21, number);
    const mat4 camera = glm::lookAt(eye, random_vector(22, number), vec3(0.0f, 1.0f, 0.0f));
    return glm::perspective(1.0f, 16.0f / 9.0f, 0.01f, 100.0f) * camera;
}

// Of random lights, cameras and receivers: each point that the camera sees lies in a needed tile whose texels are no
// larger than the pixel there.
TEST(ShadowTiles, EveryVisiblePointHasATexelAPixel) {
    const Bounds scene{vec3(-5.0f), vec3(5.0f)};
    int checked = 0;
    for (const SampleKind kind : {SampleKind::point, SampleKind::spot, SampleKind::directional})
        for (std::uint32_t number = 0; number < 40; ++number) {
            const shared::LightRow row = make_light_row(light_of(kind, number), 0, 0.0f, scene);
            const mat4 view_projection = view_of(number);
            const TileView view(view_projection, 720);
            std::vector<Bounds> boxes;
            std::vector<ReceiverPlace> places;
            std::vector<std::optional<float>> pixels;
            for (std::uint32_t i = 0; i < 20; ++i) {
                const vec3 centre = 4.0f * random_vector(31 + number, i);
                const vec3 half = glm::abs(0.2f * random_vector(91 + number, i));
                boxes.push_back({centre - half, centre + half});
                add_places(row, light_class(kind), i, boxes.back(), places);
                pixels.push_back(view.pixel_side(boxes.back()));
            }
            const std::vector<TileKey> tiles = needed_tiles(0, {{places, {}}, pixels}, 0.0f);
            EXPECT_EQ(tiles.front().level, 0u);
            for (std::uint32_t i = 0; i < boxes.size(); ++i)
                for (std::uint32_t k = 0; k < 20; ++k) {
                    const vec3 point =
                        boxes[i].centre() + 0.5f * boxes[i].extent() * random_vector(200 + number * 20 + i, k);
                    const vec4 clip = view_projection * vec4(point, 1.0f);
                    const bool seen = clip.w > 0.0f && std::abs(clip.x) < clip.w && std::abs(clip.y) < clip.w;
                    const vec2 place = place_on_map(row, light_class(kind), point);
                    const float distance = glm::length(point - vec3(row.position_bound));
                    const bool in_cone =
                        kind != SampleKind::spot ||
                        glm::dot(point - vec3(row.position_bound), vec3(row.normal_offset)) > 0.87f * distance;
                    if (!seen || !in_cone || clip.w < 0.2f)
                        continue;
                    std::uint32_t finest = 0;
                    for (const TileKey& tile : tiles) {
                        const vec2 at = (place * 0.5f + 0.5f) * float(1u << tile.level);
                        if (std::uint32_t(at.x) == tile.x && std::uint32_t(at.y) == tile.y)
                            finest = std::max(finest, tile.level);
                    }
                    // Head-on, half a map is a right angle, or the cone, or the radius.
                    const float side = 2.0f / float(shared::tile_inner << finest);
                    const float texel = kind == SampleKind::directional
                                            ? side / row.tangent_scale.w
                                            : side * distance / std::max(row.position_bound.w, 1.0f);
                    const float pixel = clip.w * 2.0f * std::tan(0.5f) / 720.0f;
                    if (finest + 1 < shared::tile_levels) {
                        EXPECT_LE(texel, 1.001f * pixel) << "light " << number << " point " << i;
                    }
                    ++checked;
                }
        }
    EXPECT_GT(checked, 1000);
}

// A tile as it is drawn covers its own texels and two of each neighbour.
TEST(ShadowTiles, TilesRepeatTheTexelsOfTheirNeighbours) {
    const MapTile whole = tile_on_map({0, 0, 0, 0});
    EXPECT_NEAR(1.0f / whole.scale, 256.0 / 252.0, 1e-6);
    const MapTile tile = tile_on_map({0, 2, 3, 1});
    EXPECT_NEAR(tile.centre.x, 0.75, 1e-6);
    EXPECT_NEAR(tile.centre.y, -0.25, 1e-6);
    const float texel = 2.0f / (4.0f * 252.0f);
    EXPECT_NEAR(tile.centre.x + 1.0f / tile.scale, 1.0f + 2.0f * texel, 1e-6);
}

std::vector<TileKey> keys(std::initializer_list<std::uint32_t> numbers) {
    std::vector<TileKey> result;
    for (const std::uint32_t number : numbers)
        result.push_back({0, 3, number, 0});
    return result;
}

bool rests(std::uint32_t) {
    return false;
}
bool moves(std::uint32_t) {
    return true;
}

TEST(ShadowTiles, AreDrawnOnceAndStay) {
    TileStore store;
    store.reset(3);
    const auto first = store.draw(keys({0, 1}), {}, rests);
    ASSERT_EQ(first.size(), 2u);
    EXPECT_TRUE(first[0].redraw_static);
    EXPECT_NE(first[0].slot, first[1].slot);
    EXPECT_TRUE(store.draw(keys({0, 1}), {}, rests).empty());
    // A mover: its tile is drawn again, over the static part.
    store.mark([](const TileKey& key) { return key.x == 1; });
    const auto again = store.draw(keys({0, 1}), {}, rests);
    ASSERT_EQ(again.size(), 1u);
    EXPECT_EQ(again[0].key.x, 1u);
    EXPECT_FALSE(again[0].redraw_static);
    // What is not needed stays while there is room, and the slot that was not needed for longest goes first.
    EXPECT_EQ(store.draw(keys({2}), {}, rests).size(), 1u);
    EXPECT_TRUE(store.draw(keys({0}), {}, rests).empty());
    EXPECT_EQ(store.draw(keys({3}), {}, rests).size(), 1u);
    EXPECT_FALSE(store.slot_of({0, 3, 1, 0}));
    EXPECT_TRUE(store.slot_of({0, 3, 0, 0}));
}

TEST(ShadowTiles, WhatTheBudgetLeavesComesLater) {
    TileStore store;
    store.reset(8);
    EXPECT_EQ(store.draw(keys({0, 1, 2}), {2}, rests).size(), 2u);
    EXPECT_EQ(store.stale(), 1u);
    EXPECT_FALSE(store.slot_of({0, 3, 2, 0})) << "nothing is in it";
    EXPECT_EQ(store.draw(keys({0, 1, 2}), {2}, rests).size(), 1u);
    EXPECT_EQ(store.stale(), 0u);
    // Movers have a budget of their own; what is missing comes before.
    store.mark([](const TileKey&) { return true; });
    const auto drawn = store.draw(keys({0, 1, 2, 3}), {10, 1}, rests);
    ASSERT_EQ(drawn.size(), 2u);
    EXPECT_EQ(drawn[1].key.x, 3u);
    EXPECT_EQ(store.stale(), 2u);
}

TEST(ShadowTiles, AreListedAndRedrawnOnRequest) {
    TileStore store;
    store.reset(8);
    store.draw(keys({0, 1, 2}), {}, rests);
    store.draw(keys({0, 2}), {}, rests);
    store.mark([](const TileKey& key) { return key.x == 2; });
    const auto held = store.held();
    ASSERT_EQ(held.size(), 3u);
    for (std::uint32_t i = 0; i < 3; ++i) {
        EXPECT_EQ(held[i].key.x, i);
        EXPECT_EQ(held[i].needed, i != 1);
        EXPECT_EQ(held[i].fresh, i != 2);
        EXPECT_EQ(store.slot_of(held[i].key), held[i].slot);
    }
    store.redraw(held[0].key);
    const auto drawn = store.draw(keys({0, 1}), {}, rests);
    ASSERT_EQ(drawn.size(), 1u);
    EXPECT_EQ(drawn[0].key.x, 0u);
    EXPECT_TRUE(drawn[0].redraw_static);
}

TEST(ShadowTiles, LostFramesAndMovedLightsAreDrawnAgain) {
    TileStore store;
    store.reset(8);
    store.draw(keys({0, 1}), {1}, rests);
    store.draw(keys({0, 1}), {1}, rests);
    store.lose_last();
    const auto lost = store.draw(keys({0, 1}), {}, rests);
    ASSERT_EQ(lost.size(), 1u);
    EXPECT_EQ(lost[0].key.x, 1u);
    EXPECT_TRUE(lost[0].redraw_static);
    store.outdate(0);
    EXPECT_TRUE(store.slot_of({0, 3, 0, 0})) << "an old shadow is better than none";
    const auto moved = store.draw(keys({0, 1}), {}, moves);
    ASSERT_EQ(moved.size(), 2u);
    EXPECT_TRUE(moved[0].whole);
    EXPECT_TRUE(store.draw(keys({0, 1}), {}, moves).empty()) << "nothing changed since";
    // At rest, each is drawn once more, now with a static part for movers to come.
    const auto rested = store.draw(keys({0, 1}), {}, rests);
    ASSERT_EQ(rested.size(), 2u);
    EXPECT_TRUE(rested[0].redraw_static);
    EXPECT_FALSE(rested[0].whole);
    EXPECT_TRUE(store.draw(keys({0, 1}), {}, rests).empty());
}

} // namespace
} // namespace sunfleck::gi
