// Textures, by index. Textures are added and never change, so a consumer that has seen the first N need not look again.
#pragma once

#include "engine/core/srgb.h"

#include <string>
#include <vector>

namespace sunfleck::scene {

enum class TextureWrap : std::uint8_t { repeat, mirrored_repeat, clamp_to_edge };

using shared::linear_from_srgb;

// One image as a sampler reads it.
struct Texture {
    std::string name;
    std::uint32_t width = 0, height = 0;
    bool srgb = false; // red, green and blue are sRGB encoded; alpha never is
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    bool nearest = false;             // nearest-neighbour filtering
    std::vector<std::uint8_t> pixels; // RGBA, rows from the top

    // Linear values at `coordinates` (u to the right, v downwards, 0 to 1 over the image), filtered bilinearly.
    vec4 sample(vec2 coordinates) const;
    vec4 texel(std::int64_t x, std::int64_t y) const; // wrapped
    // Mean linear value.
    vec4 average() const;
};

// The next mip level of an image: each texel is the mean of (up to) four, in linear space.
std::vector<std::uint8_t> half_size(const std::vector<std::uint8_t>& pixels, std::uint32_t width, std::uint32_t height,
                                    bool srgb);

class TextureStore {
public:
    std::uint32_t add(Texture texture) {
        textures_.push_back(std::move(texture));
        return std::uint32_t(textures_.size() - 1);
    }
    const Texture& operator[](std::uint32_t index) const { return textures_[index]; }
    std::uint32_t size() const { return std::uint32_t(textures_.size()); }

private:
    std::vector<Texture> textures_;
};

} // namespace sunfleck::scene
