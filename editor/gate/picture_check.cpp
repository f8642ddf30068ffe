#include "editor/gate/picture_check.h"

#include "editor/command_line/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sunfleck::gate {
namespace {

// Pixels belong together when they are at most this far apart: a line need not be closed.
constexpr int reach = 2;
// A mean of less than this is compared as if it were this: in black tiles a relative change says nothing.
constexpr double least_mean = 0.02;

float largest_difference(const vec4& a, const vec4& b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

class Clusters {
public:
    Clusters(std::vector<std::uint8_t> marked, int width, int height)
        : marked_(std::move(marked)), width_(width), height_(height) {}

    std::uint32_t largest() {
        std::uint32_t result = 0;
        for (std::size_t i = 0; i < marked_.size(); ++i)
            if (marked_[i])
                result = std::max(result, take(int(i)));
        return result;
    }

private:
    // Counts a cluster and unmarks it.
    std::uint32_t take(int start) {
        std::vector<int> open = {start};
        marked_[std::size_t(start)] = 0;
        std::uint32_t count = 0;
        while (!open.empty()) {
            const int pixel = open.back();
            open.pop_back();
            ++count;
            const int x = pixel % width_, y = pixel / width_;
            for (int v = std::max(y - reach, 0); v <= std::min(y + reach, height_ - 1); ++v)
                for (int u = std::max(x - reach, 0); u <= std::min(x + reach, width_ - 1); ++u)
                    if (std::uint8_t& mark = marked_[std::size_t(v * width_ + u)]; mark) {
                        mark = 0;
                        open.push_back(v * width_ + u);
                    }
        }
        return count;
    }

    std::vector<std::uint8_t> marked_;
    int width_, height_;
};

struct Area {
    std::uint32_t left, top, right, bottom;
};

void compare_means(const io::Picture& stored, const io::Picture& picture, const Area& area, const std::string& where,
                   PictureDifference& result) {
    double before[3] = {}, after[3] = {};
    for (std::uint32_t y = area.top; y < area.bottom; ++y)
        for (std::uint32_t x = area.left; x < area.right; ++x) {
            const std::size_t i = std::size_t(y) * stored.width + x;
            for (int c = 0; c < 3; ++c) {
                before[c] += double(stored.pixels[i][c]);
                after[c] += double(picture.pixels[i][c]);
            }
        }
    const double pixels = double(area.right - area.left) * double(area.bottom - area.top);
    static const char* const channels[] = {"red", "green", "blue"};
    for (int c = 0; c < 3 && pixels > 0.0; ++c) {
        const double change = (after[c] - before[c]) / std::max(before[c], least_mean * pixels);
        if (std::abs(change) > std::abs(result.mean)) {
            result.mean = change;
            result.mean_where = std::string(channels[c]) + " in " + where;
        }
    }
}

void compare_tiles(const io::Picture& stored, const io::Picture& picture, std::uint32_t tiles,
                   PictureDifference& result) {
    for (std::uint32_t row = 0; row < tiles; ++row)
        for (std::uint32_t column = 0; column < tiles; ++column) {
            const Area area{column * stored.width / tiles, row * stored.height / tiles,
                            (column + 1) * stored.width / tiles, (row + 1) * stored.height / tiles};
            compare_means(stored, picture, area,
                          "the tile in row " + std::to_string(row + 1) + ", column " + std::to_string(column + 1),
                          result);
        }
}

} // namespace

PictureDifference picture_difference(const io::Picture& stored, const io::Picture& picture,
                                     const PictureLimits& limits) {
    PictureDifference result;
    result.same_size = stored.width == picture.width && stored.height == picture.height;
    result.equal = result.same_size && stored.pixels == picture.pixels;
    result.pixels = stored.pixels.size();
    if (!result.same_size || result.equal)
        return result;
    std::vector<std::uint8_t> beyond(stored.pixels.size());
    // Display values are multiples of 1/255, which floats hold with an error.
    const float limit = float(limits.difference) + 1e-4f;
    for (std::size_t i = 0; i < beyond.size(); ++i)
        beyond[i] = largest_difference(stored.pixels[i], picture.pixels[i]) > limit;
    result.beyond = std::uint64_t(std::count(beyond.begin(), beyond.end(), 1));
    result.cluster = Clusters(std::move(beyond), int(stored.width), int(stored.height)).largest();
    compare_means(stored, picture, {0, 0, stored.width, stored.height}, "the whole picture", result);
    compare_tiles(stored, picture, limits.tiles, result);
    result.flip = command_line::flip(stored, picture, std::vector<std::uint8_t>(stored.pixels.size(), 1));
    return result;
}

std::string picture_fault(const PictureDifference& difference, bool to_the_bit, const PictureLimits& limits) {
    char text[256];
    if (!difference.same_size)
        return "it has another size";
    if (difference.equal)
        return "";
    if (double(difference.beyond) > limits.share * double(difference.pixels))
        std::snprintf(text, sizeof text, "%llu of %llu pixels differ by more than %.0f/255 (at most %.1f %% may)",
                      static_cast<unsigned long long>(difference.beyond),
                      static_cast<unsigned long long>(difference.pixels), limits.difference * 255.0,
                      limits.share * 100.0);
    else if (difference.cluster >= limits.cluster)
        std::snprintf(text, sizeof text,
                      "%u pixels in one patch or line differ by more than %.0f/255 (%u are too many)",
                      difference.cluster, limits.difference * 255.0, limits.cluster);
    else if (std::abs(difference.mean) > limits.mean)
        std::snprintf(text, sizeof text, "the mean of %s changed by %+.2f %% (at most %.1f %% may)",
                      difference.mean_where.c_str(), difference.mean * 100.0, limits.mean * 100.0);
    else if (to_the_bit)
        std::snprintf(text, sizeof text, "it differs, if by little (FLIP %.5f), where it was equal to the bit",
                      difference.flip);
    else
        return "";
    return text;
}

} // namespace sunfleck::gate
