// What each pass and stage of a frame took, of two commits side by side.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sunfleck::bench {

class PassTimes { // of one commit
public:
    // The `each_frame` of a run's statistics: a list for each pass and stage, of the frames in which it ran. In others
    // it took no time, and counts so.
    void add(const nlohmann::json& each_frame);
    bool empty() const { return frames_ == 0; }
    std::size_t frames() const { return frames_; }
    // ms by the name that the program gives; stages have "(CPU)" behind it.
    const std::map<std::string, std::vector<double>>& by_name() const { return by_name_; }

private:
    void add_all(const nlohmann::json& times, const char* mark, std::size_t frames);
    std::size_t frames_ = 0;
    std::map<std::string, std::vector<double>> by_name_;
};

// A line for each pass: median and 5th to 95th percentile before and after; the longest after comes first. What one
// side lacks is a dash there.
std::string pass_table(const PassTimes& before, const PassTimes& after);

} // namespace sunfleck::bench
