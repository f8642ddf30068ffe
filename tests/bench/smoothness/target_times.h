// How frames of runs with a target (frame_milliseconds) held it: those of the seconds in which it is reached do not
// count. What the least settings take shows which targets can be held at all; of the others, the game is to say so.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sunfleck::bench {

class TargetTimes {
public:
    static constexpr double most_time = 1.15; // of the target, that nineteen frames of twenty are held below
    static constexpr double least_median = 0.8;

    // Frames of a room, as measure_pacing writes them.
    void add(const std::string& room, const nlohmann::json& file);
    // Of all rooms, ms.
    double high() const;
    // Prints a line for each bound; true if all are held. `target`: ms; `least`: high() of the least settings.
    bool report(double target, double least) const;

private:
    std::vector<double> all() const;
    bool report_out_of_reach(double least) const;

    struct Room {
        std::vector<double> frames; // ms
        bool said = false;          // that the target is out of reach
    };
    std::map<std::string, Room> rooms_;
};

} // namespace sunfleck::bench
