// sunfleck bench compare and bench pictures: the gate for frame times, work and pictures.
#pragma once

#include "editor/command_line/level_run.h"
#include "editor/gate/gate_run.h"

namespace sunfleck::command_line {

struct CompareRunOptions {
    std::string base, head;
    std::string base_revision;
    LevelOptions level; // handed to programs that are given without arguments
    std::vector<std::string> accepted_counters;
    double time_limit = 300.0; // s
    std::vector<std::uint32_t> looks = {12, 20, 32, 48};
    gate::PairOptions pair;
    bool skip_work = false;
    std::string stored; // folder of stored pictures
    std::string report; // HTML file
};
Result<gate::Outcome> bench_compare(const CompareRunOptions& options);

// The command line of a program: one alone plays the level with the gate's options, more than a word is taken as it is.
Result<std::vector<std::string>> command_of(const std::string& side, const LevelOptions& level);

struct SelfTestCommandOptions {
    LevelOptions level;
    std::uint32_t triples = 150, rebuilds = 15, runs = 1000;
    std::string folder; // for builds and triples; empty: build/gate/self-test of the project
    std::vector<std::uint32_t> looks = {12, 20, 32, 48};
    double time_limit = 300.0;
    gate::PairOptions pair;
};
Result<gate::Outcome> bench_self_test(const SelfTestCommandOptions& options);

struct PicturesOptions {
    std::string program; // empty: this one
    LevelOptions level;
    std::string stored;
    std::vector<std::string> frames; // NAME=FRAME; empty: those of the store
    std::string differences;         // folder
    double time_limit = 300.0;
    bool accept = false;
};
Result<gate::Outcome> bench_pictures(const PicturesOptions& options);

} // namespace sunfleck::command_line
