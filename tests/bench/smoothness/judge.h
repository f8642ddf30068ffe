// Lines of the report that hold a value to a bound.
#pragma once

#include <cstdio>

namespace sunfleck::bench {

// True if the bound is held.
inline bool judge(const char* what, double value, const char* words, double bound, bool held) {
    std::printf("    %-44s %7.2f  (%s %.2f)%s\n", what, value, words, bound, held ? "" : "  MISSED");
    return held;
}
inline bool at_most(const char* what, double value, double bound) {
    return judge(what, value, "at most", bound, value <= bound);
}
inline bool at_least(const char* what, double value, double bound) {
    return judge(what, value, "at least", bound, value >= bound);
}

} // namespace sunfleck::bench
