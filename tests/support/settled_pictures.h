// Pictures that two ways must agree on to the bit, and what a frame counted.
#pragma once

#include "tests/support/gpu_world.h"

namespace sunfleck::tests {

inline std::uint64_t counter_of(GpuWorld& world, const char* name) {
    return std::uint64_t(world.renderer->statistics().counters[name]);
}

inline void expect_same_picture(const io::Picture& a, const io::Picture& b) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        different += a.pixels[i] != b.pixels[i] ? 1 : 0;
    EXPECT_EQ(different, 0u) << "of " << a.pixels.size() << " pixels";
}

} // namespace sunfleck::tests
