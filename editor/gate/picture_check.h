// Whether a picture may stand for a stored one that another machine drew: where processor and driver round otherwise,
// single pixels move by a little; leaks, lost shadows and colour casts move many by a little or a few in one place.
#pragma once

#include "engine/io/image.h"

#include <cstdint>
#include <string>

namespace sunfleck::gate {

struct PictureLimits {
    double difference = 3.0 / 255.0; // of a channel; pixels beyond it are counted
    double share = 0.001;            // of pixels beyond it, at most
    std::uint32_t cluster = 20;      // so many of them in one patch or line are too many
    double mean = 0.005;             // of each channel's mean, over the picture and each of its tiles
    std::uint32_t tiles = 8;         // the picture is cut into 8 x 8
};

struct PictureDifference {
    bool same_size = true, equal = true;
    std::uint64_t beyond = 0, pixels = 0; // pixels beyond the difference, of all
    std::uint32_t cluster = 0;            // the largest patch or line of them
    double mean = 0.0;                    // the largest relative change of a channel's mean, and where
    std::string mean_where;
    double flip = 0.0;
};

PictureDifference picture_difference(const io::Picture& stored, const io::Picture& picture,
                                     const PictureLimits& limits = {});

// What is wrong with it, in one sentence; empty: nothing. `to_the_bit`: drawn where the stored one was.
std::string picture_fault(const PictureDifference& difference, bool to_the_bit, const PictureLimits& limits = {});

} // namespace sunfleck::gate
