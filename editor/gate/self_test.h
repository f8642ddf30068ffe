// How often the gate errs on this machine: drawn from real triples, run by run, as it would have seen them.
#pragma once

#include "editor/gate/triples.h"

#include <map>

namespace sunfleck::gate {

// How often each row was named as the culprit; "whole frame" where only that was slower.
using Culprits = std::map<std::string, std::uint32_t>;

struct SelfTestRates {
    std::uint32_t runs = 0;
    Culprits culprits;                  // of the alarms
    std::uint32_t alarms = 0, fine = 0; // of equal builds; the rest could not tell
    double pairs_for_equal = 0.0;       // in the mean
};
struct SlowedRates {
    std::string row;
    std::uint32_t triples = 0, runs = 0;
    std::uint32_t caught = 0, named = 0, fine = 0;
    Culprits others; // that were named instead
    double pairs = 0.0;
    double share = 0.0, slow_down = 0.0; // of the frame; as measured over all triples
    bool below_harm = false;             // slower by less than the gate promises to see: the rates prove nothing
};
// What another build of the same source does to a row.
struct RebuildShift {
    std::string rebuild, row;
    std::uint32_t triples = 0;
    double ratio = 1.0;
};
struct SelfTestReport {
    SelfTestRates equal;
    std::vector<SlowedRates> slowed;
    std::vector<RebuildShift> shifts; // of rows of 2 % of the frame and more; the largest first
};

struct SelfTestOptions {
    std::uint32_t runs = 1000, seed = 1;
    statistics::GateOptions gate;
    std::function<bool(double share)> progress = [](double) { return true; }; // false: stop
};
// Each run draws triples with replacement; those of one slowed row for that row's runs. Fails where there are too few.
Result<SelfTestReport> judge_triples(const std::vector<Triple>& triples, const SelfTestOptions& options);

std::string self_test_text(const SelfTestReport& report);

} // namespace sunfleck::gate
