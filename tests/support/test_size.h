// Tests have two sizes: short ones take 20 seconds at most and run on every change; what is exhaustive, statistical or
// a soak has a short relative among them and its full size with SUNFLECK_TEST_SIZE=long (./run test --long).
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace sunfleck::tests {

inline bool long_size() {
    const char* size = std::getenv("SUNFLECK_TEST_SIZE");
    return size != nullptr && std::string_view(size) == "long";
}

// Whether this build has a sanitizer, and so runs what only a sanitizer can judge.
inline bool sanitized() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return true;
#else
    return false;
#endif
}

// A parameter of a test: seeds, steps, rays, pixels.
template <typename T>
T by_size(T in_short, T in_long) {
    return long_size() ? in_long : in_short;
}

// Of a test that goes through many independent items: whether this run does the item. SUNFLECK_TEST_PART=K/N does those
// whose number is K modulo N, so that a long test is run piece by piece (tests/bench/game.sh).
inline bool in_part(unsigned item) {
    const char* part = std::getenv("SUNFLECK_TEST_PART");
    unsigned which = 0, of = 1;
    return part == nullptr || std::sscanf(part, "%u/%u", &which, &of) != 2 || of == 0 || item % of == which;
}

} // namespace sunfleck::tests
