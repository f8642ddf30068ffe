#include "engine/scene/texture_store.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sunfleck::scene {
namespace {

// For all 256 codes.
const std::array<float, 256>& linear_values() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (int i = 0; i < 256; ++i)
            values[std::size_t(i)] = linear_from_srgb(float(i) / 255.0f);
        return values;
    }();
    return table;
}

std::uint8_t srgb_from_linear(float value) {
    const float s = value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1.0f / 2.4f) - 0.055f;
    return std::uint8_t(std::lround(std::clamp(s, 0.0f, 1.0f) * 255.0f));
}

std::int64_t wrapped(std::int64_t at, std::int64_t size, TextureWrap wrap) {
    if (wrap == TextureWrap::clamp_to_edge)
        return std::clamp<std::int64_t>(at, 0, size - 1);
    const std::int64_t period = wrap == TextureWrap::repeat ? size : 2 * size;
    const std::int64_t within = ((at % period) + period) % period;
    return within < size ? within : period - 1 - within;
}

vec4 decode(const std::uint8_t* p, bool srgb) {
    const auto& table = linear_values();
    const auto colour = [&](std::uint8_t code) { return srgb ? table[code] : float(code) / 255.0f; };
    return {colour(p[0]), colour(p[1]), colour(p[2]), float(p[3]) / 255.0f};
}

} // namespace

vec4 Texture::texel(std::int64_t x, std::int64_t y) const {
    const std::int64_t column = wrapped(x, width, wrap_u), row = wrapped(y, height, wrap_v);
    return decode(&pixels[std::size_t(row * width + column) * 4], srgb);
}

vec4 Texture::sample(vec2 coordinates) const {
    // Far outside, floats no longer resolve texels, and an integer would overflow.
    const vec2 at = glm::clamp(coordinates, vec2(-1e6f), vec2(1e6f)) * vec2(float(width), float(height));
    if (nearest)
        return texel(std::int64_t(std::floor(at.x)), std::int64_t(std::floor(at.y)));
    const vec2 low = glm::floor(at - 0.5f), t = at - 0.5f - low;
    const std::int64_t x = std::int64_t(low.x), y = std::int64_t(low.y);
    return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), t.x), glm::mix(texel(x, y + 1), texel(x + 1, y + 1), t.x),
                    t.y);
}

vec4 Texture::average() const {
    glm::dvec4 sum(0.0);
    for (std::size_t i = 0; i + 3 < pixels.size(); i += 4)
        sum += glm::dvec4(decode(&pixels[i], srgb));
    return pixels.empty() ? vec4(1.0f) : vec4(sum / double(pixels.size() / 4));
}

std::vector<std::uint8_t> half_size(const std::vector<std::uint8_t>& pixels, std::uint32_t width, std::uint32_t height,
                                    bool srgb) {
    const std::uint32_t half_width = std::max(width / 2, 1u), half_height = std::max(height / 2, 1u);
    std::vector<std::uint8_t> result(std::size_t(half_width) * half_height * 4);
    for (std::uint32_t y = 0; y < half_height; ++y)
        for (std::uint32_t x = 0; x < half_width; ++x) {
            vec4 sum(0.0f);
            for (std::uint32_t i = 0; i < 4; ++i) {
                const std::size_t column = std::min(2 * x + (i & 1), width - 1),
                                  row = std::min(2 * y + (i >> 1), height - 1);
                sum += decode(&pixels[(row * width + column) * 4], srgb);
            }
            sum *= 0.25f;
            std::uint8_t* target = &result[(std::size_t(y) * half_width + x) * 4];
            for (int c = 0; c < 4; ++c)
                target[c] = srgb && c < 3 ? srgb_from_linear(sum[c]) : std::uint8_t(std::lround(sum[c] * 255.0f));
        }
    return result;
}

} // namespace sunfleck::scene
