// A machine that lies about times as shared machines do: it drifts, is slow for a while, now and then takes much longer
// for one pass, and gives each new process a speed of its own. Two programs draw frames on it.
#pragma once

#include "engine/statistics/gate.h"

#include <array>
#include <cstdint>

namespace sunfleck::gate_simulation {

constexpr std::size_t passes = 20;

struct Machine {
    double drift;      // standard deviation of the slow change of speed
    double slow_share; // of the time spent in slow spells
    double wild_share; // of the rows of a pair in which one process is off by some 20 %
    double noise;      // of one pass in one frame, as a scale of its distribution
};
// `bursts` has what was measured on a machine with restless neighbours: the ratio of two frames scatters by a quarter.
constexpr Machine quiet = {0.05, 0.0, 0.0, 0.05}, shared = {0.15, 0.08, 0.0, 0.05}, crowded = {0.25, 0.20, 0.0, 0.05},
                  wild = {0.15, 0.08, 0.10, 0.05}, bursts = {0.15, 0.08, 0.0, 0.12};

// How much slower each pass of a build is than base's, as a factor of its time.
using Build = std::array<double, passes>;
Build same_build();

// Shares of the frame of the passes; 4 % more are unaccounted.
const std::array<double, passes>& pass_shares();

class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits(); // SplitMix64
    double uniform() { return double(bits() >> 11) * 0x1p-53; }
    double normal();

private:
    std::uint64_t state_;
};

// A program that runs: its build times the luck of its process (where its memory lies, say).
struct Process {
    std::array<double, passes + 1> factors; // of passes and what is unaccounted
};

class World {
public:
    World(const Machine& machine, std::uint64_t seed);
    Random& random() { return random_; }
    Process start(const Build& build);
    void load(); // time passes while a program loads
    // Draws consecutive frames of the recording and appends their times.
    void draw(const Process& process, std::size_t first_frame, std::size_t count, statistics::ProcessTimes& times);
    // One pair as the gate measures it: both processes alive, in random order, in turns, A B B A.
    statistics::PairTimes measure_pair(const Build& base, const Build& head);

private:
    void step(double frames);

    Machine machine_;
    Random random_;
    double drift_ = 0.0;
    bool slow_ = false;
    std::array<double, passes + 1> sensitivity_, slowness_, pass_ms_;
    std::vector<double> frame_work_; // of each frame of the recording
};

// The gate over pairs of this world, measured up to each look as the tool does it.
statistics::GateReport run_gate(World& world, const Build& base, const Build& head,
                                statistics::GateOptions options = {});

} // namespace sunfleck::gate_simulation
