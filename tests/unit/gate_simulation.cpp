#include "tests/unit/gate_simulation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace sunfleck::gate_simulation {
namespace {

constexpr double frame_ms = 80.0;
constexpr std::size_t recording = 600;  // frames
constexpr double drift_frames = 2000.0; // over which the drift forgets
constexpr double spell_frames = 6.0;    // mean length of a slow spell
constexpr double loading_frames = 150.0;
constexpr std::size_t turn = 6, turns = 16;                    // as gate::PairOptions
constexpr double process_common = 0.003, process_own = 0.0095; // together 1 %

// Noise of one pass in one frame, as a factor: Student's t with four degrees of freedom (its quantiles have a closed
// form), and one time in a hundred a hiccup.
std::vector<float> make_noise_factors(double noise) {
    std::vector<float> factors(65536);
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const double u = (double(i) + 0.5) / double(factors.size());
        const double alpha = 4.0 * u * (1.0 - u);
        const double q = std::cos(std::acos(std::sqrt(alpha)) / 3.0) / std::sqrt(alpha);
        const double t = std::copysign(2.0 * std::sqrt(std::max(q - 1.0, 0.0)), u - 0.5);
        const double hiccup = i % 100 == 37 ? -0.5 * std::log((double(i % 997) + 0.5) / 997.0) : 0.0;
        factors[i] = float(std::exp(std::clamp(noise * t, -1.0, 2.0) + hiccup));
    }
    return factors;
}

// Made once for each machine's noise.
const std::vector<float>& noise_factors(double noise) {
    static std::map<double, std::vector<float>> tables;
    std::vector<float>& table = tables[noise];
    if (table.empty())
        table = make_noise_factors(noise);
    return table;
}

std::vector<std::string> pass_names() {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < passes; ++i)
        names.push_back("pass " + std::to_string(i));
    return names;
}

} // namespace

Build same_build() {
    Build build;
    build.fill(1.0);
    return build;
}

const std::array<double, passes>& pass_shares() {
    static const std::array<double, passes> shares = {0.20,  0.14,  0.10,  0.08,  0.07,  0.06, 0.055,
                                                      0.05,  0.04,  0.035, 0.03,  0.025, 0.02, 0.015,
                                                      0.010, 0.008, 0.007, 0.006, 0.005, 0.004};
    return shares;
}

std::uint64_t Random::bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double Random::normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

World::World(const Machine& machine, std::uint64_t seed) : machine_(machine), random_(seed) {
    double rest = 1.0;
    for (std::size_t i = 0; i < passes; ++i) {
        pass_ms_[i] = frame_ms * pass_shares()[i];
        rest -= pass_shares()[i];
    }
    pass_ms_[passes] = frame_ms * rest;
    for (double& sensitivity : sensitivity_)
        sensitivity = 0.7 + 0.6 * random_.uniform();
    drift_ = machine_.drift * random_.normal();
    const double phase = random_.uniform();
    for (std::size_t i = 0; i < recording; ++i)
        frame_work_.push_back(1.0 + 0.05 * std::sin(2.0 * std::numbers::pi * (double(i) / double(recording) + phase)));
    step(1e9);
}

// The drift is a random walk that is drawn back to zero; spells begin and end at random.
void World::step(double frames) {
    const double kept = std::exp(-frames / drift_frames);
    drift_ = drift_ * kept + machine_.drift * std::sqrt(1.0 - kept * kept) * random_.normal();
    if (machine_.slow_share <= 0.0)
        return;
    // Rate at which either state is left, towards the share of time in each.
    const double forget = std::exp(-frames / (spell_frames * (1.0 - machine_.slow_share)));
    const double slow = machine_.slow_share + ((slow_ ? 1.0 : 0.0) - machine_.slow_share) * forget;
    const bool was_slow = slow_;
    slow_ = random_.uniform() < slow;
    if (slow_ && !was_slow) {
        const double depth = 0.5 + 1.0 * random_.uniform();
        for (double& slowness : slowness_)
            slowness = depth * (0.5 + random_.uniform());
    }
}

Process World::start(const Build& build) {
    Process process;
    const double common = process_common * random_.normal();
    for (std::size_t i = 0; i <= passes; ++i) {
        double luck = common + process_own * random_.normal();
        if (machine_.wild_share > 0.0 && random_.uniform() < 0.5 * machine_.wild_share)
            luck += 0.2 * random_.normal();
        process.factors[i] = std::exp(luck) * (i < passes ? build[i] : 1.0);
    }
    return process;
}

void World::load() {
    step(loading_frames);
}

void World::draw(const Process& process, std::size_t first_frame, std::size_t count, statistics::ProcessTimes& times) {
    const std::vector<float>& noises = noise_factors(machine_.noise);
    for (std::size_t frame = first_frame; frame < first_frame + count; ++frame) {
        step(1.0);
        const double work = frame_work_[frame % recording] * std::exp(0.01 * random_.normal());
        std::uint64_t word = 0;
        double whole = 0.0;
        for (std::size_t i = 0; i <= passes; ++i) {
            word = i % 4 == 0 ? random_.bits() : word >> 16;
            const double machine =
                std::exp(drift_ * sensitivity_[i] + (slow_ ? 2.0 * random_.uniform() * slowness_[i] : 0.0));
            const double ms = pass_ms_[i] * work * process.factors[i] * machine * double(noises[word & 0xffffu]);
            whole += ms;
            if (i < passes)
                times.pass_ms.push_back(ms);
        }
        times.frame_ms.push_back(whole);
    }
}

statistics::PairTimes World::measure_pair(const Build& base, const Build& head) {
    statistics::PairTimes times;
    const Process base_process = start(base), head_process = start(head);
    load();
    const bool head_first = random_.bits() & 1u;
    const std::size_t offset = random_.bits() % recording;
    for (std::size_t i = 0; i < turns; ++i) {
        const std::size_t frame = offset + i * recording / turns;
        const bool swapped = head_first != (i % 2 == 1); // A B, B A, A B, ...
        draw(swapped ? head_process : base_process, frame, turn, swapped ? times.head : times.base);
        draw(swapped ? base_process : head_process, frame, turn, swapped ? times.base : times.head);
    }
    return times;
}

statistics::GateReport run_gate(World& world, const Build& base, const Build& head, statistics::GateOptions options) {
    static const std::vector<std::string> names = pass_names();
    options.seed = std::uint32_t(world.random().bits());
    std::vector<statistics::PairSummary> pairs;
    statistics::GateReport report;
    report.next_look = options.looks.front();
    while (report.next_look) {
        while (pairs.size() < report.next_look)
            pairs.push_back(statistics::summarise_pair(world.measure_pair(base, head), passes).value());
        report = statistics::judge(names, pairs, options).value();
    }
    return report;
}

} // namespace sunfleck::gate_simulation
