#include "engine/scene/environment_map.h"

#include <algorithm>

namespace sunfleck::scene {
namespace {

constexpr float circle = 6.28318530718f, half_circle = 3.14159265359f;
constexpr std::uint32_t max_columns = 1024;

// 2x2 box filter, until the image is small enough.
void make_smaller(std::uint32_t& width, std::uint32_t& height, std::vector<vec3>& texels) {
    while (width > max_columns && width % 2 == 0 && height % 2 == 0) {
        std::vector<vec3> half(std::size_t(width / 2) * (height / 2));
        for (std::uint32_t y = 0; y < height / 2; ++y)
            for (std::uint32_t x = 0; x < width / 2; ++x) {
                const std::size_t first = std::size_t(2 * y) * width + 2 * x;
                half[std::size_t(y) * (width / 2) + x] =
                    0.25f * (texels[first] + texels[first + 1] + texels[first + width] + texels[first + width + 1]);
            }
        texels = std::move(half);
        width /= 2;
        height /= 2;
    }
}

} // namespace

EnvironmentImage::EnvironmentImage(std::uint32_t width, std::uint32_t height, std::vector<vec3> texels,
                                   std::shared_ptr<const PictureFile> file)
    : width_(width), height_(height), texels_(std::move(texels)), file_(std::move(file)) {
    for (vec3& texel : texels_)
        texel = is_finite(texel) ? glm::max(texel, vec3(0.0f)) : vec3(0.0f);
    make_smaller(width_, height_, texels_);
    double sum = 0.0;
    glm::dvec3 total(0.0);
    cumulative_.reserve(texels_.size());
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        const double angle = double(texel_solid_angle(std::uint32_t(i / width_)));
        total += glm::dvec3(texels_[i]) * angle;
        cumulative_.push_back(sum += double(luminance(texels_[i])) * angle);
    }
    mean_ = vec3(total / (2.0 * double(circle)));
}

float EnvironmentImage::texel_solid_angle(std::uint32_t row) const {
    const float top = std::cos(half_circle * float(row) / float(height_));
    const float bottom = std::cos(half_circle * float(row + 1) / float(height_));
    return circle / float(width_) * (top - bottom);
}

std::size_t EnvironmentImage::texel_at(vec3 d) const {
    const float u = 0.5f + std::atan2(d.x, -d.z) / circle;
    const float v = std::acos(std::clamp(d.y, -1.0f, 1.0f)) / half_circle;
    const std::uint32_t column = std::min(std::uint32_t(std::max(u, 0.0f) * float(width_)), width_ - 1);
    const std::uint32_t row = std::min(std::uint32_t(v * float(height_)), height_ - 1);
    return std::size_t(row) * width_ + column;
}

vec3 EnvironmentImage::radiance(vec3 direction) const {
    return texels_[texel_at(direction)];
}

EnvironmentImage::Draw EnvironmentImage::draw(float u, float v) const {
    Draw result;
    const double total = cumulative_.back(), target = double(u) * total;
    if (!(total > 0.0))
        return result;
    const std::size_t texel = std::min<std::size_t>(
        std::size_t(std::upper_bound(cumulative_.begin(), cumulative_.end(), target) - cumulative_.begin()),
        cumulative_.size() - 1);
    const double before = texel > 0 ? cumulative_[texel - 1] : 0.0, share = cumulative_[texel] - before;
    // The remainder of the first random number is reused.
    const float rest = share > 0.0 ? std::clamp(float((target - before) / share), 0.0f, 0.999999f) : 0.5f;
    const std::uint32_t row = std::uint32_t(texel / width_), column = std::uint32_t(texel % width_);
    const float top = std::cos(half_circle * float(row) / float(height_));
    const float bottom = std::cos(half_circle * float(row + 1) / float(height_));
    const float y = top + (bottom - top) * v; // uniform over the texel's solid angle
    const float angle = circle * ((float(column) + rest) / float(width_) - 0.5f);
    const float r = std::sqrt(std::max(0.0f, 1.0f - y * y));
    result.direction = vec3(r * std::sin(angle), y, -r * std::cos(angle));
    result.radiance = texels_[texel];
    result.density = float(share / total) / texel_solid_angle(row);
    return result;
}

float EnvironmentImage::density(vec3 direction) const {
    const double total = cumulative_.back();
    return total > 0.0 ? float(double(luminance(texels_[texel_at(direction)])) / total) : 0.0f;
}

} // namespace sunfleck::scene
