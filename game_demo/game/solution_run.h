// A game without pictures: steps, by the built-in solution or by a recording, and what came of them.
#pragma once

#include "gi_module/light_sensors/light_sensors.h"

#include <filesystem>
#include <string>

namespace sunfleck::demo {

struct SolutionRun {
    std::filesystem::path scene; // file
    std::string level;           // as saved games name it (identity_of_level)
    std::string input;           // recording; empty: the solution
    std::string record;          // file to write the inputs to, every second while it runs; or empty
    std::string output;          // folder for stats.json
    bool allow_outside = false;
    gi::SensorSettings sensors;
};

// Prints when a sensor opens and what it then reads. An error: the scene or a file cannot be read or written. That the
// goal was not reached is in stats.json, and is an error, too.
Status run_solution(const SolutionRun& run);

} // namespace sunfleck::demo
