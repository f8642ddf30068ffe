// sunfleck bench compare --self-test: how often the gate errs on this machine and this program.
#include "editor/command_line/bench_compare.h"

#include "editor/gate/revision_build.h"
#include "editor/gate/self_test.h"
#include "editor/gate/self_test_builds.h"
#include "engine/core/file.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
namespace {

namespace fs = std::filesystem;

constexpr double slow_down = 0.05;
constexpr std::uint32_t calibrations = 2; // triples that find out what an amount of work costs; not used for the rates

// What is made slower: three passes and a stage, in turn.
struct SlowTarget {
    const char* name;
    bool on_cpu;
    int first_amount;
    std::string row() const { return std::string(name) + (on_cpu ? " (CPU)" : ""); }
};
constexpr SlowTarget targets[] = {{"shadow maps", false, 500},
                                  {"low-resolution light", false, 500},
                                  {"g-buffer", false, 500},
                                  {"visibility", true, 2000}};

// The slowed build reads these; the others know nothing of them, but have the same environment.
void slow_down_children(const SlowTarget& target, int amount) {
    ::setenv("SUNFLECK_SLOW", target.name, 1);
    ::setenv("SUNFLECK_SLOW_AMOUNT", std::to_string(amount).c_str(), 1);
}

std::vector<double> times_of(const std::vector<gate::Frame>& frames, const SlowTarget& target) {
    std::vector<double> times;
    for (const gate::Frame& frame : frames) {
        const auto& group = target.on_cpu ? frame.stages : frame.passes;
        if (const auto found = group.find(target.name); found != group.end())
            times.push_back(found->second);
    }
    return times;
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
        int& amount = amounts_[target.name];
        if (amount == 0)
            SUNFLECK_TRY(calibrate(target, amount));
        slow_down_children(target, amount);
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

    // The amount of work that takes 5 % of the target's time. Each step begins from what the one before found.
    Status calibrate(const SlowTarget& target, int& amount) {
        double guess = target.first_amount;
        for (std::uint32_t i = 0; i < calibrations; ++i) {
            slow_down_children(target, int(guess));
            SUNFLECK_ASSIGN(const gate::Triple triple, run_programs(programs_.base, 1000000 + i));
            const double base = statistics::median(times_of(triple.base, target));
            const double added = statistics::median(times_of(triple.slow, target)) - base;
            if (!(base > 0.0))
                return Error{"'" + target.row() + "' does not run in this level: it can't be made slower"};
            const double factor = added > 0.0 ? slow_down * base / added : 4.0;
            guess = std::max(1.0, guess * std::clamp(factor, 0.02, 50.0));
        }
        amount = int(guess);
        return write_amounts();
    }

    Status read_amounts() {
        std::error_code code;
        if (!fs::exists(folder_ / "amounts.json", code))
            return {};
        SUNFLECK_ASSIGN(const std::string text, read_file(folder_ / "amounts.json"));
        const Json json = Json::parse(text, nullptr, false);
        for (const SlowTarget& target : targets)
            if (json.is_object() && json.contains(target.name) && json[target.name].is_number_integer())
                amounts_[target.name] = json[target.name];
        return {};
    }
    Status write_amounts() const { return write_file(folder_ / "amounts.json", Json(amounts_).dump(1) + "\n"); }

    const SelfTestCommandOptions& options_;
    fs::path folder_;
    gate::SelfTestPrograms programs_;
    std::map<std::string, int> amounts_;
    std::vector<gate::Triple> triples_;
};

// 1 where a rate is not what the gate promises.
gate::Outcome outcome_of(const gate::SelfTestReport& report) {
    const double runs = report.equal.runs;
    bool good = report.equal.alarms <= 0.01 * runs && report.equal.fine >= 0.8 * runs;
    for (const gate::SlowedRates& rates : report.slowed)
        good = good && rates.fine <= 0.05 * rates.runs && rates.named >= 0.95 * rates.runs;
    return good ? gate::Outcome::fine : gate::Outcome::slower;
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
