// Sizes of a picture that a compute kernel enlarges.
#pragma once

#include "engine/core/maths.h"
#include "engine/gpu/frame_graph.h"

namespace sunfleck::render {

// What the kernels take as constants.
struct EnlargementSizes {
    glm::ivec2 source, target;

    EnlargementSizes(const gpu::ImageDescription& from, const gpu::ImageDescription& to)
        : source(int(from.width), int(from.height)), target(int(to.width), int(to.height)) {}

    // The usual case: pixels of the target share what they read.
    bool doubles() const { return target == 2 * source; }
    // Invocations. Doubling has one for each gap between pixels of the source, those outside the border included.
    glm::uvec2 invocations() const { return glm::uvec2(doubles() ? source + 1 : target); }
};

} // namespace sunfleck::render
