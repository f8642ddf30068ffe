#include "editor/gate/self_test.h"

#include "engine/core/random.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sunfleck::gate {
namespace {

using statistics::GateReport;
using statistics::PairSummary;
using statistics::Verdict;

constexpr std::uint32_t least_triples = 12; // of a kind: fewer say nothing of the rest

// All samples of one kind, under the names of one set of rows.
struct Samples {
    std::vector<std::string> rows;
    std::vector<PairSummary> pairs;
};

Result<Samples> samples_of(const std::vector<const Triple*>& triples, std::vector<Frame> Triple::*head) {
    Comparison comparison;
    for (const Triple* triple : triples)
        SUNFLECK_TRY(comparison.add(pair_of(*triple, triple->*head)));
    SUNFLECK_ASSIGN(auto pairs, comparison.summaries());
    return Samples{comparison.row_names(), std::move(pairs)};
}

// One run of the gate over pairs drawn at random, with replacement.
Result<GateReport> draw_run(const Samples& samples, const SelfTestOptions& options, std::uint32_t run) {
    statistics::GateOptions gate = options.gate;
    gate.seed = run + 1;
    std::vector<PairSummary> drawn;
    GateReport report;
    report.next_look = gate.looks.front();
    while (report.next_look > 0) {
        while (drawn.size() < report.next_look) {
            const std::uint32_t bits = hash_combine(hash_combine(options.seed, run), std::uint32_t(drawn.size()));
            drawn.push_back(samples.pairs[bits % samples.pairs.size()]);
        }
        SUNFLECK_ASSIGN(report, statistics::judge(samples.rows, drawn, gate));
    }
    return report;
}

// Empty where the gate raised no alarm.
std::string culprit_of(const GateReport& report) {
    if (report.verdict != Verdict::slower)
        return {};
    return report.culprit ? report.rows[*report.culprit].name : "whole frame";
}

Status judge_equal(const std::vector<const Triple*>& triples, const SelfTestOptions& options, SelfTestRates& rates) {
    SUNFLECK_ASSIGN(const Samples samples, samples_of(triples, &Triple::same));
    for (; rates.runs < options.runs; ++rates.runs) {
        SUNFLECK_ASSIGN(const GateReport report, draw_run(samples, options, rates.runs));
        if (const std::string culprit = culprit_of(report); !culprit.empty()) {
            ++rates.alarms;
            ++rates.culprits[culprit];
        }
        rates.fine += report.verdict == Verdict::fine;
        rates.pairs_for_equal += double(report.pairs) / options.runs;
        if (!options.progress(0.5 * rates.runs / options.runs))
            return Error{"interrupted"};
    }
    return {};
}

// How much slower the row was over all triples, and its share of the frame.
Status describe_slowed(const Samples& samples, const SelfTestOptions& options, SlowedRates& rates) {
    statistics::GateOptions all = options.gate;
    all.looks = {std::uint32_t(samples.pairs.size())};
    SUNFLECK_ASSIGN(const GateReport report, statistics::judge(samples.rows, samples.pairs, all));
    for (const statistics::GateRow& row : report.rows)
        if (row.name == rates.row) {
            rates.share = row.share;
            rates.slow_down = row.ratio - 1.0;
            rates.below_harm = rates.slow_down < options.gate.harm;
        }
    return {};
}

Result<SlowedRates> judge_slowed(const std::string& row, const std::vector<const Triple*>& triples,
                                 const SelfTestOptions& options) {
    SlowedRates rates;
    rates.row = row;
    rates.triples = std::uint32_t(triples.size());
    SUNFLECK_ASSIGN(const Samples samples, samples_of(triples, &Triple::slow));
    SUNFLECK_TRY(describe_slowed(samples, options, rates));
    for (; rates.runs < options.runs; ++rates.runs) {
        SUNFLECK_ASSIGN(const GateReport report, draw_run(samples, options, rates.runs));
        const std::string culprit = culprit_of(report);
        rates.caught += !culprit.empty();
        rates.fine += report.verdict == Verdict::fine;
        rates.named += culprit == row;
        if (!culprit.empty() && culprit != row)
            ++rates.others[culprit];
        rates.pairs += double(report.pairs) / options.runs;
        if (!options.progress(0.5 + 0.5 * rates.runs / options.runs))
            return Error{"interrupted"};
    }
    return rates;
}

Status describe_rebuild(const std::string& rebuild, const std::vector<const Triple*>& triples,
                        const SelfTestOptions& options, std::vector<RebuildShift>& shifts) {
    SUNFLECK_ASSIGN(const Samples samples, samples_of(triples, &Triple::same));
    statistics::GateOptions all = options.gate;
    all.looks = {std::uint32_t(samples.pairs.size())};
    SUNFLECK_ASSIGN(const GateReport report, statistics::judge(samples.rows, samples.pairs, all));
    for (const statistics::GateRow& row : report.rows)
        if (row.kind == statistics::RowKind::judged && std::isfinite(row.ratio))
            shifts.push_back({rebuild, row.name, row.pairs, row.ratio});
    return {};
}

std::map<std::string, std::vector<const Triple*>> group(const std::vector<Triple>& triples, std::string Triple::*by) {
    std::map<std::string, std::vector<const Triple*>> groups;
    for (const Triple& triple : triples)
        groups[triple.*by].push_back(&triple);
    return groups;
}

} // namespace

Result<SelfTestReport> judge_triples(const std::vector<Triple>& triples, const SelfTestOptions& options) {
    if (triples.size() < least_triples)
        return Error{"there are " + std::to_string(triples.size()) + " triples; at least " +
                     std::to_string(least_triples) + " are needed to draw runs from"};
    SelfTestReport report;
    std::vector<const Triple*> all;
    all.reserve(triples.size());
    for (const Triple& triple : triples)
        all.push_back(&triple);
    SUNFLECK_TRY(judge_equal(all, options, report.equal));
    for (const auto& [row, of_row] : group(triples, &Triple::slowed))
        if (of_row.size() >= least_triples) {
            SUNFLECK_ASSIGN(SlowedRates rates, judge_slowed(row, of_row, options));
            report.slowed.push_back(std::move(rates));
        }
    for (const auto& [rebuild, of_rebuild] : group(triples, &Triple::rebuild))
        SUNFLECK_TRY(describe_rebuild(rebuild, of_rebuild, options, report.shifts));
    std::sort(report.shifts.begin(), report.shifts.end(), [](const RebuildShift& a, const RebuildShift& b) {
        return std::abs(std::log(a.ratio)) > std::abs(std::log(b.ratio));
    });
    return report;
}

namespace {

// "; instead: 'recording (CPU)' 12, ..." with the number of runs of each.
std::string culprits_text(const char* what, const Culprits& culprits) {
    std::string text;
    for (const auto& [row, runs] : culprits)
        text += (text.empty() ? std::string(what) : ",") + " '" + row + "' " + std::to_string(runs);
    return text;
}

} // namespace

std::string self_test_text(const SelfTestReport& report) {
    char line[256];
    const SelfTestRates& equal = report.equal;
    const double runs = equal.runs;
    std::snprintf(line, sizeof line,
                  "equal builds: %u alarms, %.1f %% fine, %.1f %% cannot tell, of %u runs; %.1f pairs in the mean",
                  equal.alarms, 100.0 * equal.fine / runs, 100.0 * (equal.runs - equal.alarms - equal.fine) / runs,
                  equal.runs, equal.pairs_for_equal);
    std::string text = line + culprits_text("; alarms:", equal.culprits) + "\n";
    for (const SlowedRates& rates : report.slowed) {
        std::snprintf(line, sizeof line,
                      "'%s' (%.1f %% of the frame) slower by %.1f %%: caught %.1f %%, named %.1f %%, wrongly fine "
                      "%.1f %%; %.1f pairs in the mean, %u triples",
                      rates.row.c_str(), rates.share * 100.0, rates.slow_down * 100.0,
                      100.0 * rates.caught / rates.runs, 100.0 * rates.named / rates.runs,
                      100.0 * rates.fine / rates.runs, rates.pairs, rates.triples);
        text += line + culprits_text("; named instead:", rates.others) + "\n";
        if (rates.below_harm)
            text +=
                "  less than the gate promises to see: the amount of extra work is too small on this machine today\n";
    }
    text += "what other bytes of the same source do, the ten largest:\n";
    for (std::size_t i = 0; i < std::min<std::size_t>(report.shifts.size(), 10); ++i) {
        const RebuildShift& shift = report.shifts[i];
        std::snprintf(line, sizeof line, "  %-14s %-34s %+.2f %% (%u triples)\n", shift.rebuild.c_str(),
                      shift.row.c_str(), (shift.ratio - 1.0) * 100.0, shift.triples);
        text += line;
    }
    return text;
}

} // namespace sunfleck::gate
