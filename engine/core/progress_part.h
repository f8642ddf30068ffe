// How far long work is, told by a function of the caller: called with the share that is done, 0 to 1; if it returns
// false, the work stops. An empty one wants to hear nothing.
#pragma once

#include <functional>

namespace sunfleck {

// For a part of the work, whose own 0 to 1 is `begin` to `end` of the whole. Refers to `whole`, which must outlive it.
inline std::function<bool(float)> progress_part(const std::function<bool(float)>& whole, float begin, float end) {
    if (!whole)
        return {};
    return [&whole, begin, end](float share) { return whole(begin + (end - begin) * share); };
}

std::function<bool(float)> progress_part(std::function<bool(float)>&&, float, float) = delete;

} // namespace sunfleck
