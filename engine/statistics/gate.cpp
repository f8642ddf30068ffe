#include "engine/statistics/gate.h"

#include "engine/statistics/clipped_sum.h"
#include "engine/statistics/sign_flips.h"
#include "engine/statistics/summary.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace sunfleck::statistics {
namespace {

constexpr std::uint32_t most_pairs = 10000; // more is a mistake: the tables of sign_flips.cpp would grow large
constexpr double interval_deviate = 1.96;   // 95 %
constexpr double infinite = std::numeric_limits<double>::infinity();

struct Input {
    const std::vector<std::string>& passes;
    const std::vector<PairSummary>& pairs;
    const GateOptions& options;
};

Status check(const Input& input) {
    const GateOptions& options = input.options;
    const auto falls = std::adjacent_find(options.looks.begin(), options.looks.end(), std::greater_equal<>());
    if (options.looks.empty() || falls != options.looks.end() || options.looks.front() < 1 ||
        options.looks.back() > most_pairs)
        return Error{"the gate's looks must rise from at least 1 pair to at most " + std::to_string(most_pairs)};
    for (const double error : {options.slower_error, options.fine_error})
        if (!(error > 0.0 && error < 0.5))
            return Error{"the gate's errors must lie between 0 and 0.5"};
    if (!(options.tolerance >= 0.0 && options.tolerance < options.harm && options.harm < 10.0))
        return Error{"the gate's tolerance must be at least 0 and below its harm"};
    if (!(options.frame_tolerance >= 0.0 && options.frame_tolerance < options.harm * options.judged_share))
        return Error{
            "the gate's tolerance of the whole frame must be at least 0 and below the harm of the least judged row"};
    if (options.flips < 1)
        return Error{"the gate needs at least one change of signs"};
    for (const PairSummary& pair : input.pairs) {
        if (pair.rows.size() != row_count(input.passes.size()))
            return Error{"a pair has " + std::to_string(pair.rows.size()) + " rows where " +
                         std::to_string(row_count(input.passes.size())) + " are expected"};
        for (const PairRow& row : pair.rows)
            if (!std::isfinite(row.log_ratio) || !std::isfinite(row.base_ms) || !std::isfinite(row.head_ms))
                return Error{"a pair has a time that is not a number"};
    }
    return {};
}

double median_over_pairs(const Input& input, std::uint32_t pairs, std::size_t row, double PairRow::*member) {
    std::vector<double> values;
    for (std::uint32_t pair = 0; pair < pairs; ++pair)
        values.push_back(input.pairs[pair].rows[row].*member);
    return median(std::move(values));
}

std::vector<double> log_ratios(const Input& input, std::uint32_t pairs, std::size_t row) {
    std::vector<double> logs;
    for (std::uint32_t pair = 0; pair < pairs; ++pair)
        if (input.pairs[pair].rows[row].compared)
            logs.push_back(input.pairs[pair].rows[row].log_ratio);
    return logs;
}

RowKind kind_of(const GateRow& row, const GateOptions& options) {
    if (row.pairs == 0 && row.head_ms > 0.0 && row.base_ms <= 0.0)
        return RowKind::added;
    if (row.pairs == 0 && row.base_ms > 0.0 && row.head_ms <= 0.0)
        return RowKind::removed;
    if (row.pairs == 0 || row.share < options.tested_share)
        return RowKind::listed;
    return row.share < options.judged_share ? RowKind::small : RowKind::judged;
}

// Sizes and shares of all rows.
std::vector<GateRow> describe_rows(const Input& input, std::uint32_t pairs) {
    const std::size_t passes = input.passes.size();
    std::vector<GateRow> rows(row_count(passes));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].name = i < passes ? input.passes[i] : i == whole_frame_row(passes) ? "whole frame" : "unaccounted";
        rows[i].base_ms = median_over_pairs(input, pairs, i, &PairRow::base_ms);
        rows[i].head_ms = median_over_pairs(input, pairs, i, &PairRow::head_ms);
        rows[i].pairs = std::uint32_t(log_ratios(input, pairs, i).size());
    }
    const GateRow& frame = rows[whole_frame_row(passes)];
    for (GateRow& row : rows) {
        // Symmetric in base and head: which rows are tested must not depend on the outcome.
        if (frame.base_ms > 0.0 && frame.head_ms > 0.0)
            row.share = std::max(row.base_ms / frame.base_ms, row.head_ms / frame.head_ms);
        row.kind = kind_of(row, input.options);
        // A few more instructions in a row of half a per cent of the frame are measured well and harm nobody.
        row.tolerance = input.options.tolerance;
        if (row.share > 0.0)
            row.tolerance = std::max(row.tolerance, input.options.frame_tolerance / row.share);
    }
    return rows;
}

// One look: the tests that decide, and the estimates that the report shows.
class Look {
public:
    Look(const Input& input, std::uint32_t pairs) : input_(input), pairs_(pairs), rows_(describe_rows(input, pairs)) {
        for (std::size_t i = 0; i < rows_.size(); ++i)
            if (rows_[i].kind == RowKind::judged || rows_[i].kind == RowKind::small)
                tested_.push_back(i);
    }

    void test_slower() {
        const double error = input_.options.slower_error / looks();
        SampleTable samples(tested_.size(), pairs_);
        for (std::size_t i = 0; i < tested_.size(); ++i)
            shifted(tested_[i], -std::log1p(rows_[tested_[i]].tolerance), &samples.at(i, 0));
        const FlipTestResult result = flip_test(samples, input_.options.flips, input_.options.seed, error);
        critical_ = result.critical;
        for (std::size_t i = 0; i < tested_.size(); ++i) {
            rows_[tested_[i]].slower = result.p[i] < error;
            rows_[tested_[i]].p = std::min(1.0, result.p[i] * looks());
        }
    }

    bool any_slower() const {
        return std::any_of(rows_.begin(), rows_.end(), [](const GateRow& row) { return row.slower; });
    }
    bool all_fine() const {
        const double harm = std::log1p(input_.options.harm), deviate = -harm_deviate();
        for (std::size_t i = 0; i < rows_.size(); ++i)
            if (rows_[i].kind == RowKind::judged && clipped_statistic(log_ratios(input_, pairs_, i), harm) >= deviate)
                return false;
        return true;
    }

    std::vector<GateRow> report_rows() {
        for (std::size_t i = 0; i < rows_.size(); ++i)
            estimate(i);
        return rows_;
    }

private:
    double looks() const { return double(input_.options.looks.size()); }
    double harm_deviate() const { return normal_deviate(input_.options.fine_error / looks()); }

    void estimate(std::size_t index) {
        GateRow& row = rows_[index];
        const std::vector<double> logs = log_ratios(input_, pairs_, index);
        const double centre = clipped_centre(logs, 0.0);
        row.ratio = std::exp(centre);
        row.low = std::exp(clipped_centre(logs, interval_deviate));
        row.high = std::exp(clipped_centre(logs, -interval_deviate));
        row.harm_limit = std::exp(clipped_centre(logs, -harm_deviate()));
        row.change_ms = row.base_ms * (row.ratio - 1.0);
        row.smallest_seen = smallest_seen(row, logs, centre);
    }

    // One row's log ratios, moved; zero, which counts as missing, where a pair has none.
    void shifted(std::size_t row, double by, double* values) const {
        for (std::uint32_t pair = 0; pair < pairs_; ++pair) {
            const PairRow& sample = input_.pairs[pair].rows[row];
            values[pair] = sample.compared ? sample.log_ratio + by : 0.0;
        }
    }

    // Moves the row's own spread until its statistic is the critical one: seen in half of all cases. Nine of ten need
    // the estimate's own error on top.
    double smallest_seen(const GateRow& row, const std::vector<double>& logs, double centre) const {
        if (!(row.low > 0.0 && row.high < infinite && critical_ < infinite))
            return infinite;
        const double half = centre - clipped_centre(logs, critical_);
        const double standard_error = std::log(row.high / row.low) / (2.0 * interval_deviate);
        return std::expm1(std::log1p(row.tolerance) + half + 1.28 * standard_error);
    }

    const Input& input_;
    std::uint32_t pairs_;
    std::vector<GateRow> rows_;
    std::vector<std::size_t> tested_;
    double critical_ = infinite; // of the test for slow-downs
};

std::optional<std::size_t> find_culprit(const std::vector<GateRow>& rows, std::size_t whole) {
    std::optional<std::size_t> culprit;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (i != whole && rows[i].slower && (!culprit || rows[i].change_ms > rows[*culprit].change_ms))
            culprit = i;
    return culprit;
}

// Between half and twice the whole frame's slow-down in every judged pass, of which there are three at least. What is
// unaccounted may be waiting, which no build makes slower.
bool is_all_alike(const std::vector<GateRow>& rows, std::size_t passes) {
    const std::size_t whole = whole_frame_row(passes);
    if (!rows[whole].slower)
        return false;
    const double change = std::log(rows[whole].ratio);
    int judged = 0;
    for (std::size_t i = 0; i < passes; ++i) {
        if (rows[i].kind != RowKind::judged)
            continue;
        ++judged;
        if (const double own = std::log(rows[i].ratio); own < 0.5 * change || own > 2.0 * change)
            return false;
    }
    return judged >= 3;
}

void finish(GateReport& report, const Input& input, Look& look) {
    const std::size_t whole = whole_frame_row(input.passes.size());
    report.rows = look.report_rows();
    for (const GateRow& row : report.rows)
        if (row.kind == RowKind::judged)
            report.smallest_seen = std::max(report.smallest_seen, row.smallest_seen);
    if (report.verdict != Verdict::slower)
        return;
    report.culprit = find_culprit(report.rows, whole);
    report.all_alike = is_all_alike(report.rows, input.passes.size());
}

} // namespace

Result<GateReport> judge(const std::vector<std::string>& passes, const std::vector<PairSummary>& pairs,
                         const GateOptions& options) {
    const Input input{passes, pairs, options};
    SUNFLECK_TRY(check(input));
    GateReport report;
    for (const std::uint32_t needed : options.looks) {
        if (needed > pairs.size()) {
            report.next_look = needed;
            break;
        }
        Look look(input, needed);
        look.test_slower();
        ++report.look;
        report.pairs = needed;
        report.verdict = look.any_slower() ? Verdict::slower : look.all_fine() ? Verdict::fine : Verdict::cannot_tell;
        if (report.verdict == Verdict::cannot_tell && needed != options.looks.back())
            continue;
        finish(report, input, look);
        return report;
    }
    // Too few pairs for a verdict so far: what they say is shown all the same.
    const std::uint32_t used = report.look ? report.pairs : std::uint32_t(pairs.size());
    Look look(input, used);
    if (report.look)
        look.test_slower();
    report.pairs = used;
    finish(report, input, look);
    return report;
}

} // namespace sunfleck::statistics
