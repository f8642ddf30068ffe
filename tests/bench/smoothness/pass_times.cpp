#include "tests/bench/smoothness/pass_times.h"

#include "engine/statistics/summary.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::bench {
namespace {

using statistics::median, statistics::percentile;

constexpr const char* whole_frame = "whole frame";

struct Row {
    std::string name;
    const std::vector<double>*before = nullptr, *after = nullptr;
};

double median_or(const std::vector<double>* times, double otherwise) {
    return times == nullptr ? otherwise : median(*times);
}

// Of no account: what runs only where something is loaded, such as uploads.
bool takes_time(const Row& row) {
    constexpr double least = 0.005; // ms, what the table shows as 0.00
    const auto long_enough = [](const std::vector<double>* times) {
        return times != nullptr && percentile(*times, 0.95) >= least;
    };
    return long_enough(row.before) || long_enough(row.after);
}

// The whole frame; then by what it takes now, and what is gone by what it took.
bool comes_first(const Row& a, const Row& b) {
    const auto rank = [](const Row& row) {
        return std::make_tuple(row.name == whole_frame, median_or(row.after, -1.0), median_or(row.before, -1.0),
                               row.after == nullptr ? 0.0 : percentile(*row.after, 0.95));
    };
    return rank(a) > rank(b);
}

std::string columns(const std::vector<double>* times) {
    if (times == nullptr)
        return "         -               ";
    char text[64];
    std::snprintf(text, sizeof text, "%10.2f %6.2f ..%6.2f", median(*times), percentile(*times, 0.05),
                  percentile(*times, 0.95));
    return text;
}

} // namespace

void PassTimes::add(const nlohmann::json& each_frame) {
    const nlohmann::json none = nlohmann::json::object();
    const nlohmann::json whole = each_frame.value("frame_ms", nlohmann::json::array());
    const std::size_t frames = whole.size();
    add_all({{whole_frame, whole}}, "", frames);
    add_all(each_frame.value("gpu_ms", none), "", frames);
    add_all(each_frame.value("cpu_ms", none), " (CPU)", frames);
    frames_ += frames;
    for (auto& [name, times] : by_name_)
        times.resize(std::max(times.size(), frames_), 0.0);
}

void PassTimes::add_all(const nlohmann::json& times, const char* mark, std::size_t frames) {
    for (const auto& [name, list] : times.items()) {
        std::vector<double>& all = by_name_[name + mark];
        all.resize(frames_, 0.0); // of runs before, in which it was not there
        for (std::size_t i = 0; i < std::min(list.size(), frames); ++i)
            all.push_back(list[i].get<double>());
    }
}

std::string pass_table(const PassTimes& before, const PassTimes& after) {
    std::map<std::string, Row> by_name;
    for (const auto& [name, times] : before.by_name())
        by_name[name].before = &times;
    for (const auto& [name, times] : after.by_name())
        by_name[name].after = &times;
    std::vector<Row> rows;
    for (auto& [name, row] : by_name) {
        row.name = name;
        if (takes_time(row))
            rows.push_back(row);
    }
    std::stable_sort(rows.begin(), rows.end(), comes_first);
    char line[160];
    std::snprintf(line, sizeof line, "passes and stages of %zu frames before, %zu after, ms: median, 5 %% .. 95 %%\n",
                  before.frames(), after.frames());
    std::string table = line;
    std::snprintf(line, sizeof line, "    %-34s %25s %25s\n", "", "before          ", "after          ");
    table += line;
    for (const Row& row : rows) {
        std::snprintf(line, sizeof line, "    %-34s %s %s\n", row.name.c_str(), columns(row.before).c_str(),
                      columns(row.after).c_str());
        table += line;
    }
    std::snprintf(line, sizeof line, "    and %zu that take less than 0.005 ms in 95 %% of the frames\n",
                  by_name.size() - rows.size());
    return table + line;
}

} // namespace sunfleck::bench
