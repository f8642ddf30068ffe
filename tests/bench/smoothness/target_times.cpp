#include "tests/bench/smoothness/target_times.h"

#include "engine/statistics/summary.h"
#include "tests/bench/smoothness/judge.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sunfleck::bench {
namespace {

using statistics::median, statistics::percentile;

constexpr double reaching = 5000.0; // ms

} // namespace

void TargetTimes::add(const std::string& room, const nlohmann::json& file) {
    const auto reach = file.value("reach", std::vector<double>()); // s: out of it, in it, and so on
    Room& times = rooms_[room];
    double time = 0.0; // ms
    for (const double frame : file.value("frames_ms", std::vector<double>())) {
        const auto changes = std::upper_bound(reach.begin(), reach.end(), 1e-3 * time) - reach.begin();
        if ((time += frame) > reaching)
            (changes % 2 == 1 ? times.beyond : times.judged).push_back(frame);
    }
}

bool TargetTimes::report(double target) const {
    std::vector<double> judged;
    for (const auto& [room, times] : rooms_) {
        judged.insert(judged.end(), times.judged.begin(), times.judged.end());
        if (!times.beyond.empty())
            std::printf("    %s: %zu of %zu frames out of reach, as the game said: with its least settings, median "
                        "%.1f ms, 95 %% %.1f ms\n",
                        room.c_str(), times.beyond.size(), times.beyond.size() + times.judged.size(),
                        median(times.beyond), percentile(times.beyond, 0.95));
    }
    if (judged.empty())
        return !rooms_.empty();
    const bool short_enough = at_most("95th percentile / target", percentile(judged, 0.95) / target, 1.15);
    return at_least("median / target", median(judged) / target, 0.8) && short_enough;
}

} // namespace sunfleck::bench
