#include "engine/scene/summer_sky.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"

#include <cmath>

namespace sunfleck::scene {
namespace {

constexpr std::uint32_t columns = 1024, rows = 512;
// Of the radiance that lights the rooms: at an exposure for a room, a sky as bright as that is white all over.
constexpr float shown_share = 0.45f;
constexpr float full_turn = 6.28318531f, half_turn = 3.14159265f;

float between(float low, float high, float value) {
    return glm::smoothstep(low, high, value);
}

// Between random values, 0 to 1, at the points of a grid of unit cells, which repeats in x after `period` cells.
float noise(vec2 place, std::uint32_t period, std::uint32_t seed) {
    const vec2 cell = glm::floor(place), inside = place - cell;
    const auto value = [&](int x, int y) {
        const std::uint32_t column = std::uint32_t(int(cell.x) + x) % period, row = std::uint32_t(int(cell.y) + y);
        return to_unit_float(pcg_hash(column ^ pcg_hash(row ^ seed)));
    };
    const vec2 t = inside * inside * (3.0f - 2.0f * inside);
    return glm::mix(glm::mix(value(0, 0), value(1, 0), t.x), glm::mix(value(0, 1), value(1, 1), t.x), t.y);
}

constexpr std::uint32_t no_period = 1u << 20; // octaves double it

// Octaves of noise, each half as large and half as strong as the one before: 0 to 1. `place` is positive.
float octaves(vec2 place, std::uint32_t period, int count, std::uint32_t seed) {
    float sum = 0.0f, strength = 0.5f;
    for (int i = 0; i < count; ++i) {
        sum += strength * noise(place, period, seed + std::uint32_t(i));
        strength *= 0.5f;
        place *= 2.0f;
        period *= 2;
    }
    return sum / (1.0f - 2.0f * strength);
}

// Clouds lie in one layer, and so get smaller towards the horizon. A cloud is brighter where less of it lies towards
// the sun.
vec3 above_hills(vec3 d) {
    const vec3 clear = glm::mix(vec3(1.0f, 0.97f, 0.9f), vec3(0.14f, 0.31f, 0.62f), std::pow(d.y, 0.45f));
    const vec2 layer = vec2(d.x, d.z) * (2.2f / (d.y + 0.16f)) + 64.0f;
    const float cloud = octaves(layer, no_period, 5, 20);
    const float cover = between(0.48f, 0.64f, cloud) * between(0.0f, 0.16f, d.y);
    if (cover == 0.0f)
        return clear;
    const float shade = cloud - octaves(layer + vec2(0.16f, 0.1f), no_period, 3, 20);
    const float lit = glm::clamp(0.95f + 1.6f * shade - 0.5f * (cloud - 0.48f), 0.4f, 1.0f);
    return glm::mix(clear, vec3(1.6f, 1.4f, 1.12f) * lit, cover);
}

// Sine of the elevation up to which a range of hills reaches, the farthest first. `turn`: about the vertical, 0 to 1.
float hill_top(std::uint32_t range, float turn) {
    const std::uint32_t hills = 17 - 4 * range; // all around
    return (0.13f - 0.04f * float(range)) * octaves(vec2(turn * float(hills), 8.0f), hills, 4, 60 + range);
}

vec3 radiance_at(vec3 d, float turn) {
    const vec3 haze(0.75f, 0.76f, 0.72f), forest(0.10f, 0.14f, 0.045f), meadow(0.22f, 0.26f, 0.07f);
    constexpr std::uint32_t ranges = 3;
    if (d.y < 0.0f) {
        const vec2 ground = vec2(d.x, d.z) / (0.03f - d.y) + 64.0f;
        const vec3 grass = meadow * (0.7f + 0.6f * octaves(ground, no_period, 4, 90));
        return glm::mix(grass, haze, 0.3f * between(-0.12f, 0.0f, d.y));
    }
    for (std::uint32_t range = ranges; range-- > 0;)
        if (d.y < hill_top(range, turn))
            return glm::mix(forest, haze, 0.72f - 0.25f * float(range));
    return above_hills(d);
}

} // namespace

std::shared_ptr<const EnvironmentImage> summer_sky() {
    static const std::shared_ptr<const EnvironmentImage> made = [] {
        std::vector<vec3> texels(std::size_t(columns) * rows);
        parallel_for_chunks(rows, 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin * columns; i < end * columns; ++i) {
                const float polar = half_turn * (float(i / columns) + 0.5f) / float(rows);
                const float turn = (float(i % columns) + 0.5f) / float(columns), angle = full_turn * (turn - 0.5f);
                const vec3 d(std::sin(polar) * std::sin(angle), std::cos(polar), -std::sin(polar) * std::cos(angle));
                texels[i] = shown_share * radiance_at(d, turn);
            }
        });
        return std::make_shared<const EnvironmentImage>(columns, rows, std::move(texels));
    }();
    return made;
}

} // namespace sunfleck::scene
