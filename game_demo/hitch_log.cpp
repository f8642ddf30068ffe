#include "game_demo/hitch_log.h"

#include "engine/core/log.h"
#include "engine/statistics/summary.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::demo {

std::string HitchLog::add(double milliseconds, const viewer::FrameStatistics& statistics) {
    ++frames_;
    Parts parts = statistics.gpu_ms;
    for (const auto& [name, time] : statistics.cpu_ms)
        parts[name] += time;
    std::string line;
    if (before_.size() == window) {
        std::vector<double> times;
        times.reserve(window);
        for (const auto& [time, ignored] : before_)
            times.push_back(time);
        const double usual = statistics::median(times);
        const double ratio = milliseconds / usual;
        ratios_.add(ratio);
        longest_ = std::max(longest_, ratio);
        noticed_ += ratio > noticed;
        if (ratio > noticed)
            line = explain(milliseconds, usual, parts);
        before_.pop_front();
    }
    before_.emplace_back(milliseconds, std::move(parts));
    return line;
}

std::string HitchLog::explain(double milliseconds, double usual, const Parts& parts) const {
    std::vector<std::pair<double, std::string>> growth;
    growth.reserve(parts.size());
    for (const auto& [name, time] : parts) {
        std::vector<double> times;
        times.reserve(window);
        for (const auto& [ignored, others] : before_) {
            const auto found = others.find(name);
            times.push_back(found == others.end() ? 0.0 : found->second);
        }
        growth.emplace_back(time - statistics::median(times), name);
    }
    std::sort(growth.rbegin(), growth.rend());
    char text[120];
    std::snprintf(text, sizeof text, "frame %zu took %.0f ms, %.1f times the median of the %zu before:", frames_,
                  milliseconds, milliseconds / usual, window);
    std::string line = text;
    double explained = 0.0;
    for (std::size_t i = 0; i < growth.size() && i < 4 && growth[i].first > 0.05 * (milliseconds - usual); ++i) {
        std::snprintf(text, sizeof text, "%s %s +%.0f ms", i > 0 ? "," : "", growth[i].second.c_str(), growth[i].first);
        line += text;
        explained += growth[i].first;
    }
    std::snprintf(text, sizeof text, "%s elsewhere +%.0f ms", explained > 0.0 ? "," : "",
                  std::max(milliseconds - usual - explained, 0.0));
    return line + text;
}

std::string HitchLog::summary() const {
    char text[160];
    std::snprintf(text, sizeof text,
                  "%zu frames: 99 %% below %.1f times the median of the %zu before, the longest %.1f, %zu above %.0f",
                  frames_, ratios_.count() == 0 ? 0.0 : statistics::percentile(ratios_.values(), 0.99), window,
                  longest_, noticed_, noticed);
    return text;
}

void WindowHitches::log(const char* what, double seconds) const {
    char text[80];
    std::snprintf(text, sizeof text, "%s after %.2f s", what, seconds);
    if (on_)
        log_information(text);
}

void WindowHitches::log(double seconds, const viewer::FrameStatistics& statistics) {
    if (!on_)
        return;
    if (const std::string line = log_.add(1e3 * seconds, statistics); !line.empty())
        log_information(line);
}

void WindowHitches::log_summary() const {
    if (on_)
        log_information(log_.summary());
}

} // namespace sunfleck::demo
