// How frames of runs with a target (frame_milliseconds) held it: those of the seconds in which it is reached do not
// count, nor those of which the game said that its least settings take longer. They stand in the table beside it.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sunfleck::bench {

class TargetTimes {
public:
    // Frames of a room, as measure_pacing writes them.
    void add(const std::string& room, const nlohmann::json& file);
    // Prints a line for each bound and room out of reach; true if the bounds are held. `target`: ms.
    bool report(double target) const;

private:
    struct Room {
        std::vector<double> judged, beyond; // ms
    };
    std::map<std::string, Room> rooms_;
};

} // namespace sunfleck::bench
