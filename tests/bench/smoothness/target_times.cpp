#include "tests/bench/smoothness/target_times.h"

#include "engine/statistics/summary.h"
#include "tests/bench/smoothness/judge.h"

#include <nlohmann/json.hpp>

namespace sunfleck::bench {
namespace {

constexpr double reaching = 5000.0; // ms

} // namespace

void TargetTimes::add(const std::string& room, const nlohmann::json& file) {
    Room& times = rooms_[room];
    times.said = file.value("said_out_of_reach", false);
    double time = 0.0; // ms
    for (const double frame : file.value("frames_ms", std::vector<double>()))
        if ((time += frame) > reaching)
            times.frames.push_back(frame);
}

std::vector<double> TargetTimes::all() const {
    std::vector<double> frames;
    for (const auto& [room, times] : rooms_)
        frames.insert(frames.end(), times.frames.begin(), times.frames.end());
    return frames;
}

double TargetTimes::high() const {
    return statistics::percentile(all(), 0.95);
}

bool TargetTimes::report_out_of_reach(double least) const {
    std::printf("    out of reach: with the least settings, 95 %% of frames take up to %.1f ms\n", least);
    bool all_said = true;
    for (const auto& [room, times] : rooms_) {
        all_said = all_said && times.said;
        std::printf("    %-10s %s\n", room.c_str(),
                    times.said ? "the game says so" : "the game does not say so  MISSED");
    }
    return all_said;
}

bool TargetTimes::report(double target, double least) const {
    if (least > most_time * target)
        return report_out_of_reach(least);
    const bool short_enough = at_most("95th percentile / target", high() / target, most_time);
    return at_least("median / target", statistics::median(all()) / target, least_median) && short_enough;
}

} // namespace sunfleck::bench
