#include "editor/gate/verdict_text.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace sunfleck::gate {
namespace {

using statistics::GateReport;
using statistics::GateRow;
using statistics::RowKind;
using statistics::Verdict;

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
    char buffer[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(buffer, sizeof buffer, format, arguments);
    va_end(arguments);
    return buffer;
}

std::string interval(const GateRow& row) {
    if (!(row.low > 0.0) || !std::isfinite(row.high))
        return print("%.3f times base", row.ratio);
    return print("%.3f times base (%.3f to %.3f)", row.ratio, row.low, row.high);
}

const GateRow* whole_frame(const GateReport& report) {
    return report.rows.size() < 2 ? nullptr : &report.rows[report.rows.size() - 2];
}

std::string slower_headline(const GateReport& report) {
    if (report.all_alike)
        return "slower: all passes alike, the whole frame " + interval(*whole_frame(report)) +
               "; look at compiler options or at the machine";
    if (!report.culprit)
        return "slower: the whole frame takes " + interval(*whole_frame(report)) + ", and no pass by itself";
    const GateRow& row = report.rows[*report.culprit];
    return "slower: '" + row.name + "' takes " + interval(row) + print(", %+.3f ms", row.change_ms);
}

std::string number(double value) {
    return value == std::floor(value) && std::abs(value) < 1e15 ? print("%.0f", value) : print("%.9g", value);
}

std::string counter_remark(const CounterChange& change) {
    return "counter '" + change.name + "' " + (change.accepted ? "changed as accepted" : "changed") + ": " +
           number(change.base) + " -> " + number(change.head) + print(" in frame %u, ", change.frame) +
           print("and in %u of %u frames in all", change.frames, change.compared);
}

} // namespace

std::string headline(const GateRun& run) {
    const GateReport& report = run.report;
    if (report.verdict == Verdict::slower)
        return slower_headline(report);
    std::string result;
    if (run.comparison.work_changed())
        result = "the work changed: " + counter_remark([&] {
                     const auto changes = run.comparison.counter_changes();
                     return *std::find_if(changes.begin(), changes.end(),
                                          [](const CounterChange& change) { return !change.accepted; });
                 }());
    if (run.pictures_changed())
        result += (result.empty() ? "" : "; ") + std::string("pictures changed");
    if (!result.empty())
        return result;
    if (report.verdict == Verdict::fine)
        return "fine: no pass of 2 % of the frame or more is slower by 5 %";
    if (std::isfinite(report.smallest_seen) && report.smallest_seen > 0.0)
        return print("cannot tell: a slow-down of %.1f %% would have been seen in every pass of 2 %% of the frame or "
                     "more",
                     report.smallest_seen * 100.0);
    return "cannot tell: too few pairs, or too much noise";
}

std::vector<std::string> remarks(const GateRun& run) {
    std::vector<std::string> result;
    if (!run.weaker.empty())
        result.push_back(run.weaker);
    for (const CounterChange& change : run.comparison.counter_changes())
        result.push_back(counter_remark(change));
    for (const PictureResult& picture : run.pictures)
        if (!picture.fault.empty())
            result.push_back("picture '" + picture.frame.name + "', head against base: " + picture.fault);
    for (const PictureResult& picture : run.stored)
        if (!picture.fault.empty())
            result.push_back("picture '" + picture.frame.name + "', head against the stored one: " + picture.fault);
    for (const GateRow& row : run.report.rows) {
        if (row.kind == RowKind::added)
            result.push_back("'" + row.name + print("' is new in head: %.3f ms", row.head_ms));
        if (row.kind == RowKind::removed)
            result.push_back("'" + row.name + print("' is gone in head: %.3f ms", row.base_ms));
    }
    for (const std::string& note : run.comparison.notes())
        result.push_back(note);
    return result;
}

std::vector<GateRow> sorted_rows(const GateReport& report) {
    std::vector<GateRow> rows = report.rows;
    std::stable_sort(rows.begin(), rows.end(), [](const GateRow& a, const GateRow& b) { return a.share > b.share; });
    return rows;
}

const char* kind_text(const GateRow& row) {
    if (row.slower)
        return "slower";
    switch (row.kind) {
    case RowKind::judged:
        return "";
    case RowKind::small:
        return "small";
    case RowKind::listed:
        return "not tested";
    case RowKind::added:
        return "new";
    case RowKind::removed:
        return "gone";
    }
    return "";
}

std::string verdict_text(const GateRun& run) {
    std::string text = headline(run) + "\n";
    for (const std::string& remark : remarks(run))
        text += "  " + remark + "\n";
    text += print("%-34s %9s %9s %7s  %-15s %7s  %s\n", "pass or stage", "base ms", "head ms", "ratio", "95 % interval",
                  "seen", "");
    for (const GateRow& row : sorted_rows(run.report)) {
        if (row.kind == RowKind::listed)
            continue;
        const bool known = row.low > 0.0 && std::isfinite(row.high);
        text += print("%-34s %9.3f %9.3f %7.3f  %-15s %7s  %s\n", row.name.c_str(), row.base_ms, row.head_ms, row.ratio,
                      known ? print("%.3f to %.3f", row.low, row.high).c_str() : "-",
                      std::isfinite(row.smallest_seen) ? print("%.1f %%", row.smallest_seen * 100.0).c_str() : "-",
                      kind_text(row));
    }
    text += print("%u pairs used of %u, %.1f minutes; 'seen': the least slow-down that would have been noticed\n",
                  run.report.pairs, run.comparison.pairs(), run.minutes);
    return text;
}

} // namespace sunfleck::gate
