#include "engine/statistics/pair_summary.h"

#include "engine/statistics/summary.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::statistics {
namespace {

std::string number_text(std::size_t number) {
    return std::to_string(number);
}

Status check_process(const ProcessTimes& times, std::size_t passes, const std::string& which) {
    if (times.frame_ms.empty())
        return Error{which + " has no frames"};
    if (times.pass_ms.size() != times.frame_ms.size() * passes)
        return Error{which + " has " + number_text(times.pass_ms.size()) + " times of passes where " +
                     number_text(times.frame_ms.size()) + " frames of " + number_text(passes) + " passes are expected"};
    for (std::size_t frame = 0; frame < times.frame_ms.size(); ++frame) {
        if (!std::isfinite(times.frame_ms[frame]) || times.frame_ms[frame] <= 0.0)
            return Error{which + ": the time of frame " + number_text(frame) + " is not a positive number"};
        for (std::size_t pass = 0; pass < passes; ++pass)
            if (const double ms = times.pass_ms[frame * passes + pass]; !std::isfinite(ms) || ms < 0.0)
                return Error{which + ": the time of pass " + number_text(pass) + " in frame " + number_text(frame) +
                             " is negative or not a number"};
    }
    return {};
}

// One row's times in every frame. What is unaccounted may come out at zero or below, where clocks differ or passes
// overlap: then there is nothing to compare in that frame.
std::vector<double> row_times(const ProcessTimes& times, std::size_t passes, std::size_t row) {
    if (row == whole_frame_row(passes))
        return times.frame_ms;
    std::vector<double> result(times.frame_ms.size());
    for (std::size_t frame = 0; frame < result.size(); ++frame) {
        const double* ms = times.pass_ms.data() + frame * passes;
        if (row < passes) {
            result[frame] = ms[row];
            continue;
        }
        double rest = times.frame_ms[frame];
        for (std::size_t pass = 0; pass < passes; ++pass)
            rest -= ms[pass];
        result[frame] = std::max(rest, 0.0);
    }
    return result;
}

double typical_ms(const std::vector<double>& times) {
    std::vector<double> present;
    for (const double ms : times)
        if (ms > 0.0)
            present.push_back(ms);
    const double share = double(present.size()) / double(times.size());
    return share * median(std::move(present));
}

PairRow compare(const std::vector<double>& base, const std::vector<double>& head) {
    PairRow row;
    std::vector<double> logs;
    logs.reserve(base.size());
    for (std::size_t frame = 0; frame < base.size(); ++frame)
        if (base[frame] > 0.0 && head[frame] > 0.0)
            logs.push_back(std::log(head[frame] / base[frame]));
    row.compared = !logs.empty();
    row.log_ratio = median(std::move(logs));
    row.base_ms = typical_ms(base);
    row.head_ms = typical_ms(head);
    return row;
}

} // namespace

Result<PairSummary> summarise_pair(const PairTimes& times, std::size_t passes) {
    SUNFLECK_TRY(check_process(times.base, passes, "base"));
    SUNFLECK_TRY(check_process(times.head, passes, "head"));
    if (times.base.frame_ms.size() != times.head.frame_ms.size())
        return Error{"base drew " + number_text(times.base.frame_ms.size()) + " frames, head " +
                     number_text(times.head.frame_ms.size()) + "; the same frames are needed"};
    PairSummary summary;
    for (std::size_t row = 0; row < row_count(passes); ++row)
        summary.rows.push_back(compare(row_times(times.base, passes, row), row_times(times.head, passes, row)));
    return summary;
}

} // namespace sunfleck::statistics
