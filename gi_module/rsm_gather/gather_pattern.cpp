#include "gi_module/rsm_gather/gather_pattern.h"

#include "engine/core/random.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

// Distances from the middle are this power of evenly spread numbers. The paper has 1, whose density falls with the
// distance.
constexpr float distance_power = 1.0f;

std::vector<shared::GatherSample> every_texel(std::uint32_t side) {
    std::vector<shared::GatherSample> samples;
    samples.reserve(std::size_t(side) * side);
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x)
            samples.push_back({vec2(float(x), float(y)), 1.0f, 1.0f});
    return samples;
}

} // namespace

std::vector<shared::GatherSample> gather_pattern(std::uint32_t count, std::uint32_t side, float radius,
                                                 std::uint32_t seed, bool softening) {
    const std::uint32_t texels = side * side;
    if (count >= texels)
        return every_texel(side);
    std::vector<shared::GatherSample> samples;
    samples.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const RandomSequence random(SequenceKind::sobol, seed, i);
        const float number = random.at(0), angle = 2.0f * pi * random.at(1);
        const float distance = radius * std::pow(number, distance_power);
        const vec2 offset = distance * vec2(std::cos(angle), std::sin(angle));
        if (std::max(std::abs(offset.x), std::abs(offset.y)) >= 0.5f)
            continue; // beyond it, the map wraps around
        // Area of the ring that the number stands for, over that of the map.
        const float share =
            2.0f * pi * radius * radius * distance_power * std::pow(number, 2.0f * distance_power - 1.0f);
        const float weight = share * float(texels) / float(count);
        samples.push_back({float(side) * offset, weight, softening ? std::sqrt(std::max(weight, 1.0f)) : 1.0f});
    }
    return samples;
}

} // namespace sunfleck::gi
