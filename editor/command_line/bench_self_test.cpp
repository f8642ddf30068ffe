// sunfleck bench compare --self-test: how often the gate errs on this machine and this program.
#include "editor/command_line/bench_compare.h"

#include "editor/gate/revision_build.h"
#include "editor/gate/self_test.h"
#include "editor/gate/self_test_builds.h"
#include "engine/core/file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
namespace {

namespace fs = std::filesystem;

constexpr double slow_down = 0.05;
constexpr std::uint32_t searches = 4; // triples that find an amount of work that doubles its target's time
constexpr std::uint32_t first_calibration = 1000000; // number of such a triple; they are not used for the rates

// What is made slower: three passes and a stage, in turn.
struct SlowTarget {
    const char* name;
    bool on_cpu;
    double first_amount;
    std::string row() const { return std::string(name) + (on_cpu ? " (CPU)" : ""); }
};
constexpr SlowTarget targets[] = {{"shadow maps", false, 500},
                                  {"low-resolution light", false, 500},
                                  {"g-buffer", false, 500},
                                  {"visibility", true, 2000}};
using Amounts = std::map<std::string, double>;

// The slowed build reads this; the others know nothing of it, but have the same environment.
void slow_down_children(const Amounts& amounts) {
    std::string text;
    for (const auto& [name, amount] : amounts)
        text += (text.empty() ? "" : ";") + name + "=" + std::to_string(std::lround(amount));
    ::setenv("SUNFLECK_SLOW", text.c_str(), 1);
}

// How much slower the target is in the slowed build, as a share of its time: the median over frames.
Result<double> measured_share(const gate::Triple& triple, const SlowTarget& target) {
    const auto group = target.on_cpu ? &gate::Frame::stages : &gate::Frame::passes;
    std::vector<double> shares;
    for (std::size_t i = 0; i < triple.base.size(); ++i) {
        const auto base = (triple.base[i].*group).find(target.name), slow = (triple.slow[i].*group).find(target.name);
        if (base != (triple.base[i].*group).end() && slow != (triple.slow[i].*group).end() && base->second > 0.0)
            shares.push_back(slow->second / base->second - 1.0);
    }
    if (shares.empty())
        return Error{"'" + target.row() + "' does not run in this level: it can't be made slower"};
    return statistics::median(shares);
}

class SelfTest {
public:
    SelfTest(const SelfTestCommandOptions& options, fs::path folder, gate::SelfTestPrograms programs)
        : options_(options), folder_(std::move(folder)), programs_(std::move(programs)) {}

    Status measure() {
        SUNFLECK_TRY(read_amounts());
        SUNFLECK_ASSIGN(triples_, gate::read_triples(file()));
        Progress progress("triples");
        while (triples_.size() < options_.triples) {
            progress.show(double(triples_.size()) / options_.triples,
                          std::to_string(triples_.size()) + " of " + std::to_string(options_.triples));
            const std::uint32_t number = std::uint32_t(triples_.size());
            SUNFLECK_ASSIGN(gate::Triple triple, run(number, targets[number % std::size(targets)]));
            SUNFLECK_TRY(gate::append_triple(file(), triple));
            triples_.push_back(std::move(triple));
        }
        return {};
    }

    const std::vector<gate::Triple>& triples() const { return triples_; }

private:
    fs::path file() const { return folder_ / "triples.jsonl"; }

    Result<gate::Triple> run(std::uint32_t number, const SlowTarget& target) {
        if (amounts_.size() < std::size(targets))
            SUNFLECK_TRY(calibrate());
        slow_down_children({{target.name, amounts_[target.name]}});
        const fs::path& rebuild = programs_.rebuilds[number % programs_.rebuilds.size()];
        SUNFLECK_ASSIGN(gate::Triple triple, run_programs(rebuild, number));
        triple.rebuild = rebuild.filename().string();
        triple.slowed = target.row();
        return triple;
    }

    Result<gate::Triple> run_programs(const fs::path& same, std::uint32_t number) const {
        gate::TriplePrograms programs;
        SUNFLECK_ASSIGN(programs.base, command_of(programs_.base.string(), options_.level));
        SUNFLECK_ASSIGN(programs.same, command_of(same.string(), options_.level));
        SUNFLECK_ASSIGN(programs.slow, command_of(programs_.slow.string(), options_.level));
        return gate::run_triple(programs, options_.pair, number, {options_.time_limit, [] { return interrupted(); }});
    }

    // By how much a triple with these amounts slows each target.
    Result<Amounts> measure_shares(const Amounts& amounts) {
        slow_down_children(amounts);
        SUNFLECK_ASSIGN(const gate::Triple triple, run_programs(programs_.base, first_calibration + calibrations_++));
        Amounts shares;
        for (const SlowTarget& target : targets) {
            SUNFLECK_ASSIGN(shares[target.name], measured_share(triple, target));
        }
        return shares;
    }

    // The amounts of work that take 5 % of their targets' times. A triple knows a share to a few per cent at best, so
    // amounts are sought that double the time, and a twentieth of those is taken. The report says what they made of it.
    Status calibrate() {
        std::fprintf(stderr, "calibrating the slowed build\n");
        Amounts shares;
        for (const SlowTarget& target : targets)
            amounts_[target.name] = target.first_amount;
        for (std::uint32_t round = 0; round < searches; ++round) {
            SUNFLECK_ASSIGN(shares, measure_shares(amounts_));
            if (round + 1 < searches)
                for (auto& [name, amount] : amounts_)
                    amount =
                        std::clamp(amount * std::clamp(1.0 / std::max(shares[name], 1e-3), 0.02, 16.0), 20.0, 65535.0);
        }
        for (const SlowTarget& target : targets) {
            const std::string name = target.name;
            if (shares[name] < 0.5)
                return Error{"'" + target.row() + "' does not get slower with more work"};
            std::fprintf(stderr, "%s: an amount of %.0f takes %.0f %%\n", target.row().c_str(), amounts_[name],
                         shares[name] * 100.0);
            amounts_[name] = std::max(1.0, amounts_[name] * slow_down / shares[name]);
        }
        return write_amounts();
    }

    Status read_amounts() {
        std::error_code code;
        if (!fs::exists(folder_ / "amounts.json", code))
            return {};
        SUNFLECK_ASSIGN(const std::string text, read_file(folder_ / "amounts.json"));
        const Json json = Json::parse(text, nullptr, false);
        for (const SlowTarget& target : targets)
            if (json.is_object() && json.contains(target.name) && json[target.name].is_number())
                amounts_[target.name] = json[target.name];
        return {};
    }
    Status write_amounts() const { return write_file(folder_ / "amounts.json", Json(amounts_).dump(1) + "\n"); }

    const SelfTestCommandOptions& options_;
    fs::path folder_;
    gate::SelfTestPrograms programs_;
    Amounts amounts_; // by target; empty until calibrated
    std::uint32_t calibrations_ = 0;
    std::vector<gate::Triple> triples_;
};

// 1 where a rate is not what the gate promises, 3 where a slow-down came out too small to hold it to that.
gate::Outcome outcome_of(const gate::SelfTestReport& report) {
    const double runs = report.equal.runs;
    bool good = report.equal.alarms <= 0.01 * runs && report.equal.fine >= 0.8 * runs;
    bool proven = true;
    for (const gate::SlowedRates& rates : report.slowed) {
        proven = proven && !rates.below_harm;
        good = good && (rates.below_harm || (rates.fine <= 0.05 * rates.runs && rates.named >= 0.95 * rates.runs));
    }
    if (!good)
        return gate::Outcome::slower;
    return proven ? gate::Outcome::fine : gate::Outcome::cannot_tell;
}

} // namespace

Result<gate::Outcome> bench_self_test(const SelfTestCommandOptions& options) {
    constexpr double build_seconds = 7200.0;
    const gate::Patience patience{build_seconds, [] { return interrupted(); }};
    SUNFLECK_ASSIGN(const fs::path root, gate::project_root(patience));
    const fs::path folder = options.folder.empty() ? root / "build" / "gate" / "self-test" : fs::path(options.folder);
    SUNFLECK_ASSIGN(
        gate::SelfTestPrograms programs,
        gate::build_self_test_programs(root, fs::absolute(folder), options.rebuilds, patience,
                                       [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); }));
    SelfTest test(options, fs::absolute(folder), std::move(programs));
    SUNFLECK_TRY(test.measure());
    gate::SelfTestOptions judge;
    judge.runs = options.runs;
    judge.gate.looks = options.looks;
    Progress progress("runs drawn");
    judge.progress = [&](double share) {
        progress.show(share, "");
        return !interrupted();
    };
    SUNFLECK_ASSIGN(const gate::SelfTestReport report, gate::judge_triples(test.triples(), judge));
    std::fputs(gate::self_test_text(report).c_str(), stdout);
    return outcome_of(report);
}

} // namespace sunfleck::command_line
