#include "editor/gate/comparison.h"

#include <algorithm>

namespace sunfleck::gate {

void Comparison::take(const Frame& frame, Times& times) {
    times.frame_ms.push_back(frame.frame_ms);
    std::map<std::string, double>& row = times.rows.emplace_back(frame.passes);
    for (const auto& [name, milliseconds] : frame.stages)
        row[name + " (CPU)"] = milliseconds;
}

void Comparison::compare_counters(const Frame& base, const Frame& head) {
    for (const auto& [name, value] : head.counters)
        if (!base.counters.count(name))
            notes_.insert("counter '" + name + "' is in head only");
    for (const auto& [name, value] : base.counters) {
        const auto other = head.counters.find(name);
        if (other == head.counters.end()) {
            notes_.insert("counter '" + name + "' is in base only");
            continue;
        }
        CounterChange& change = counters_[name];
        ++change.compared;
        if (value == other->second)
            continue;
        if (change.frames++ == 0) {
            change.name = name;
            change.frame = base.number;
            change.base = value;
            change.head = other->second;
            change.accepted = accepted_.count(name) > 0;
        }
    }
}

// All runs must draw the same, not only the two programs of each.
Status Comparison::take_hello(const Hello& base, const Hello& head) {
    if (base_.frames > 0)
        SUNFLECK_TRY(check_alike(base_, base));
    base_ = base;
    head_ = head;
    for (const auto& [name, value] : base_.settings)
        if (!head_.settings.count(name))
            notes_.insert("setting '" + name + "' is in base only");
    for (const auto& [name, value] : head_.settings)
        if (!base_.settings.count(name))
            notes_.insert("setting '" + name + "' is in head only");
    return {};
}

Status Comparison::add(const WorkCheck& check) {
    SUNFLECK_TRY(take_hello(check.base, check.head));
    for (const WorkFrame& frame : check.frames)
        compare_counters(frame.base, frame.head);
    return {};
}

Status Comparison::add(const PairRun& run) {
    SUNFLECK_TRY(take_hello(run.base, run.head));
    Run& times = runs_.emplace_back();
    for (const DrawnFrame& frame : run.frames) {
        compare_counters(frame.base, frame.head);
        if (!frame.counts)
            continue;
        take(frame.base, times.base);
        take(frame.head, times.head);
        frame_times_.push_back(
            {std::uint32_t(runs_.size() - 1), frame.base.number, frame.base.frame_ms, frame.head.frame_ms});
    }
    return {};
}

std::vector<std::string> Comparison::row_names() const {
    std::set<std::string> names;
    for (const Run& run : runs_)
        for (const Times* times : {&run.base, &run.head})
            for (const auto& row : times->rows)
                for (const auto& [name, milliseconds] : row)
                    names.insert(name);
    return {names.begin(), names.end()};
}

Result<std::vector<statistics::PairSummary>> Comparison::summaries() const {
    const std::vector<std::string> names = row_names();
    const auto table = [&](const Times& times) {
        statistics::ProcessTimes result{times.frame_ms, {}};
        for (const auto& row : times.rows)
            for (const std::string& name : names) {
                const auto found = row.find(name);
                result.pass_ms.push_back(found == row.end() ? 0.0 : found->second);
            }
        return result;
    };
    std::vector<statistics::PairSummary> result;
    for (const Run& run : runs_) {
        SUNFLECK_ASSIGN(statistics::PairSummary summary,
                        statistics::summarise_pair({table(run.base), table(run.head)}, names.size()));
        result.push_back(std::move(summary));
    }
    return result;
}

Result<statistics::GateReport> Comparison::judge(const statistics::GateOptions& options) const {
    SUNFLECK_ASSIGN(const auto pairs, summaries());
    return statistics::judge(row_names(), pairs, options);
}

std::vector<std::vector<double>> Comparison::log_ratios() const {
    std::vector<std::vector<double>> result;
    const auto pairs = summaries();
    if (!pairs)
        return result;
    for (const statistics::PairSummary& pair : *pairs) {
        std::vector<double>& row = result.emplace_back();
        for (const statistics::PairRow& sample : pair.rows)
            row.push_back(sample.log_ratio);
    }
    return result;
}

std::vector<CounterChange> Comparison::counter_changes() const {
    std::vector<CounterChange> result;
    for (const auto& [name, change] : counters_)
        if (change.frames > 0)
            result.push_back(change);
    return result;
}

bool Comparison::work_changed() const {
    return std::any_of(counters_.begin(), counters_.end(),
                       [](const auto& entry) { return entry.second.frames > 0 && !entry.second.accepted; });
}

std::vector<std::string> Comparison::notes() const {
    return {notes_.begin(), notes_.end()};
}

} // namespace sunfleck::gate
