// SSIM and FLIP, implemented from their papers (see metrics.h).
#include "editor/command_line/metrics.h"
#include "engine/scene/texture_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace sunfleck::command_line {
namespace {

using Plane = std::vector<float>;
struct Extent {
    int width, height;
};

// Convolution with two one-dimensional kernels of odd size; border pixels are repeated.
Plane convolve(const Plane& source, Extent extent, const std::vector<float>& across, const std::vector<float>& down) {
    Plane half(source.size()), result(source.size());
    const auto pass = [&](const Plane& from, Plane& to, const std::vector<float>& kernel, bool horizontal) {
        const int radius = int(kernel.size() / 2);
        for (int y = 0; y < extent.height; ++y)
            for (int x = 0; x < extent.width; ++x) {
                float sum = 0;
                for (int k = -radius; k <= radius; ++k) {
                    const int sx = horizontal ? std::clamp(x + k, 0, extent.width - 1) : x;
                    const int sy = horizontal ? y : std::clamp(y + k, 0, extent.height - 1);
                    sum += kernel[std::size_t(k + radius)] * from[std::size_t(sy * extent.width + sx)];
                }
                to[std::size_t(y * extent.width + x)] = sum;
            }
    };
    pass(source, half, across, true);
    pass(half, result, down, false);
    return result;
}

std::vector<float> gaussian(float sigma, int radius) {
    std::vector<float> kernel;
    float sum = 0;
    for (int k = -radius; k <= radius; ++k) {
        kernel.push_back(std::exp(-float(k * k) / (2.0f * sigma * sigma)));
        sum += kernel.back();
    }
    for (float& value : kernel)
        value /= sum;
    return kernel;
}

float mean_of_counted(const Plane& plane, const std::vector<std::uint8_t>& counted) {
    double sum = 0;
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < plane.size(); ++i)
        if (counted[i]) {
            sum += double(plane[i]);
            ++pixels;
        }
    return pixels > 0 ? float(sum / double(pixels)) : 0.0f;
}

// --- Colour spaces of FLIP ------------------------------------------------------------------------------------------

const mat3 xyz_from_linear = glm::transpose(
    mat3(0.4124564f, 0.3575761f, 0.1804375f, 0.2126729f, 0.7151522f, 0.0721750f, 0.0193339f, 0.1191920f, 0.9503041f));
const vec3 white_point = xyz_from_linear * vec3(1.0f);

vec3 ycxcz_from_linear(vec3 rgb) {
    const vec3 t = xyz_from_linear * rgb / white_point;
    return {116.0f * t.y - 16.0f, 500.0f * (t.x - t.y), 200.0f * (t.y - t.z)};
}

vec3 linear_from_ycxcz(vec3 c) {
    const float y = (c.x + 16.0f) / 116.0f;
    const vec3 xyz = vec3(y + c.y / 500.0f, y, y - c.z / 200.0f) * white_point;
    return glm::inverse(xyz_from_linear) * xyz;
}

// CIELAB with the Hunt effect: chroma scaled by lightness.
vec3 hunt_lab_from_linear(vec3 rgb) {
    const vec3 t = xyz_from_linear * rgb / white_point;
    vec3 f;
    for (int c = 0; c < 3; ++c)
        f[c] = t[c] > 0.008856452f ? std::cbrt(t[c]) : t[c] / (3.0f * 0.04280618f) + 4.0f / 29.0f;
    const vec3 lab(116.0f * f.y - 16.0f, 500.0f * (f.x - f.y), 200.0f * (f.y - f.z));
    return {lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z};
}

float hyab(vec3 a, vec3 b) {
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

constexpr float pixels_per_degree = 67.0f;
constexpr float exponent_colour = 0.7f, exponent_feature = 0.5f, cutoff = 0.4f, cutoff_value = 0.95f;

// exp(-pi^2 x^2 / b), x in degrees.
std::vector<float> contrast_kernel(float b) {
    const int radius = int(std::ceil(3.0f * std::sqrt(0.04f / (2.0f * pi * pi)) * pixels_per_degree));
    std::vector<float> kernel;
    for (int k = -radius; k <= radius; ++k) {
        const float x = float(k) / pixels_per_degree;
        kernel.push_back(std::exp(-pi * pi * x * x / b));
    }
    return kernel;
}

// Contrast sensitivity of one opponent channel: a sum of Gaussians a_i sqrt(pi/b_i) exp(-pi^2 x^2 / b_i), x in degrees.
Plane filter_contrast(const Plane& plane, Extent extent, std::array<float, 4> p) {
    Plane result(plane.size(), 0.0f);
    float total = 0;
    std::vector<std::pair<float, std::vector<float>>> terms;
    for (int i = 0; i < 2; ++i) {
        const float a = p[std::size_t(2 * i)], b = p[std::size_t(2 * i + 1)];
        if (a == 0.0f)
            continue;
        std::vector<float> kernel = contrast_kernel(b);
        const float sum = std::accumulate(kernel.begin(), kernel.end(), 0.0f);
        const float weight = a * pi / b;
        total += weight * sum * sum;
        terms.emplace_back(weight, std::move(kernel));
    }
    for (const auto& [weight, kernel] : terms) {
        const Plane part = convolve(plane, extent, kernel, kernel);
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] += weight / total * part[i];
    }
    return result;
}

struct FlipPicture {
    std::vector<vec3> filtered_lab;
    Plane edges, points;
};

// First and second derivative of a Gaussian, positive and negative weights each normalised to one.
std::pair<std::vector<float>, std::vector<float>> derivative_kernels(float sigma, int radius) {
    std::vector<float> first, second;
    float positive1 = 0, positive2 = 0, negative2 = 0;
    for (int k = -radius; k <= radius; ++k) {
        const float x = float(k), g = std::exp(-x * x / (2.0f * sigma * sigma));
        first.push_back(-x * g);
        second.push_back((x * x / (sigma * sigma) - 1.0f) * g);
        positive1 += std::max(first.back(), 0.0f);
        positive2 += std::max(second.back(), 0.0f);
        negative2 += std::max(-second.back(), 0.0f);
    }
    for (float& value : first)
        value /= positive1;
    for (float& value : second)
        value /= value > 0.0f ? positive2 : negative2;
    return {first, second};
}

// First (edges) and second (points) derivatives of a Gaussian; sec. 5.3 of the paper.
void detect_features(const Plane& grey, Extent extent, FlipPicture& picture) {
    const float sigma = 0.5f * 0.082f * pixels_per_degree;
    const int radius = int(std::ceil(3.0f * sigma));
    const std::vector<float> smooth = gaussian(sigma, radius);
    const auto [first, second] = derivative_kernels(sigma, radius);
    const auto magnitude = [&](const std::vector<float>& kernel) {
        const Plane x = convolve(grey, extent, kernel, smooth), y = convolve(grey, extent, smooth, kernel);
        Plane result(grey.size());
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] = std::hypot(x[i], y[i]);
        return result;
    };
    picture.edges = magnitude(first);
    picture.points = magnitude(second);
}

FlipPicture prepare(const io::Picture& source) {
    const Extent extent{int(source.width), int(source.height)};
    std::array<Plane, 3> channels;
    for (const vec4& pixel : source.pixels) {
        const vec3 linear(scene::linear_from_srgb(std::clamp(pixel.x, 0.0f, 1.0f)),
                          scene::linear_from_srgb(std::clamp(pixel.y, 0.0f, 1.0f)),
                          scene::linear_from_srgb(std::clamp(pixel.z, 0.0f, 1.0f)));
        const vec3 c = ycxcz_from_linear(linear);
        for (int k = 0; k < 3; ++k)
            channels[std::size_t(k)].push_back(c[k]);
    }
    FlipPicture picture;
    Plane grey(source.pixels.size());
    for (std::size_t i = 0; i < grey.size(); ++i)
        grey[i] = (channels[0][i] + 16.0f) / 116.0f;
    detect_features(grey, extent, picture);
    const Plane y = filter_contrast(channels[0], extent, {1.0f, 0.0047f, 0.0f, 1e-5f});
    const Plane cx = filter_contrast(channels[1], extent, {1.0f, 0.0053f, 0.0f, 1e-5f});
    const Plane cz = filter_contrast(channels[2], extent, {34.1f, 0.04f, 13.5f, 0.025f});
    for (std::size_t i = 0; i < y.size(); ++i)
        picture.filtered_lab.push_back(
            hunt_lab_from_linear(glm::clamp(linear_from_ycxcz({y[i], cx[i], cz[i]}), vec3(0.0f), vec3(1.0f))));
    return picture;
}

} // namespace

double structural_similarity(const io::Picture& a, const io::Picture& b, const std::vector<std::uint8_t>& counted) {
    const Extent extent{int(a.width), int(a.height)};
    const std::size_t size = a.pixels.size();
    Plane x(size), y(size), xx(size), yy(size), xy(size);
    for (std::size_t i = 0; i < size; ++i) {
        x[i] = counted[i] ? luminance(vec3(a.pixels[i])) : 0.0f;
        y[i] = counted[i] ? luminance(vec3(b.pixels[i])) : 0.0f;
        xx[i] = x[i] * x[i], yy[i] = y[i] * y[i], xy[i] = x[i] * y[i];
    }
    const std::vector<float> window = gaussian(1.5f, 5);
    const auto smooth = [&](const Plane& plane) { return convolve(plane, extent, window, window); };
    const Plane mx = smooth(x), my = smooth(y), mxx = smooth(xx), myy = smooth(yy), mxy = smooth(xy);
    Plane result(size);
    const float c1 = 0.01f * 0.01f, c2 = 0.03f * 0.03f;
    for (std::size_t i = 0; i < size; ++i) {
        const float vx = mxx[i] - mx[i] * mx[i], vy = myy[i] - my[i] * my[i], cov = mxy[i] - mx[i] * my[i];
        result[i] = (2 * mx[i] * my[i] + c1) * (2 * cov + c2) / ((mx[i] * mx[i] + my[i] * my[i] + c1) * (vx + vy + c2));
    }
    return double(mean_of_counted(result, counted));
}

namespace {

// Colour difference redistributed to 0..1, with the largest possible one at 1.
float colour_difference(vec3 a, vec3 b, float largest) {
    const float difference = std::pow(hyab(a, b), exponent_colour);
    const float knee = cutoff * largest;
    return difference < knee ? cutoff_value / knee * difference
                             : cutoff_value + (difference - knee) / (largest - knee) * (1.0f - cutoff_value);
}

} // namespace

double flip(const io::Picture& a, const io::Picture& b, const std::vector<std::uint8_t>& counted) {
    const FlipPicture fa = prepare(a), fb = prepare(b);
    const float largest =
        std::pow(hyab(hunt_lab_from_linear(vec3(0, 1, 0)), hunt_lab_from_linear(vec3(0, 0, 1))), exponent_colour);
    Plane result(a.pixels.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        const float colour = colour_difference(fa.filtered_lab[i], fb.filtered_lab[i], largest);
        const float feature = std::pow(
            std::max(std::abs(fa.edges[i] - fb.edges[i]), std::abs(fa.points[i] - fb.points[i])) / std::sqrt(2.0f),
            exponent_feature);
        result[i] = std::pow(std::clamp(colour, 0.0f, 1.0f), 1.0f - std::clamp(feature, 0.0f, 1.0f));
    }
    return double(mean_of_counted(result, counted));
}

} // namespace sunfleck::command_line
