#include "tests/bench/smoothness/report.h"

#include "engine/core/file.h"
#include "engine/simulation/path_movers.h"
#include "engine/statistics/summary.h"
#include "tests/bench/smoothness/judge.h"
#include "tests/bench/smoothness/pass_times.h"
#include "tests/bench/smoothness/picture_errors.h"
#include "tests/bench/smoothness/target_times.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

namespace sunfleck::bench {
namespace {

namespace fs = std::filesystem;

using statistics::median, statistics::percentile;

constexpr const char* least_settings = "least"; // with a target so short that they are all that is left

struct Side { // of one commit, or of one target
    std::vector<double> frames, looking, walking, latency_frames;
    std::map<std::string, std::vector<double>> by_room;
    std::vector<std::string> ends, long_frames;
    TargetTimes target; // where frames are held to one
    unsigned lost = 0;
    double state_ms = 0.0; // the most that telling its state took of a run's frames
    PassTimes passes;
};

struct Results {
    std::map<std::string, Side> sides;
    PictureErrors pictures;
};

void append(std::vector<double>& to, const nlohmann::json& from, const char* name) {
    for (const auto& value : from.value(name, nlohmann::json::array()))
        to.push_back(value.get<double>());
}

void add_frames(Side& side, const nlohmann::json& file) {
    const std::string room = file.value("room", std::string());
    if (file.value("measured", std::string()) == "latency") {
        append(side.looking, file, "looking_ms");
        append(side.walking, file, "walking_ms");
        append(side.latency_frames, file, "frames_ms");
        side.lost += file.value("lost", 0u);
        return;
    }
    append(side.frames, file, "frames_ms");
    append(side.by_room[room], file, "frames_ms");
    side.state_ms = std::max(side.state_ms, file.value("state_ms", 0.0));
    side.target.add(room, file);
    side.ends.push_back(room + ": " + file.value("ended", std::string()));
    for (const auto& line : file.value("long_frames", nlohmann::json::array()))
        side.long_frames.push_back(room + ": " + line.get<std::string>());
}

void add_file(Results& results, const std::string& side, const nlohmann::json& file) {
    if (file.value("measured", std::string()) == "picture")
        results.pictures.add(side, file);
    else if (file.contains("each_frame")) // as the program writes it
        results.sides[side].passes.add(file["each_frame"]);
    else
        add_frames(results.sides[side], file);
}

Result<Results> read_all(const fs::path& folder) {
    Results results;
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(folder, code)) {
        const std::string name = entry.path().filename().string();
        if (entry.path().extension() != ".json")
            continue;
        SUNFLECK_ASSIGN(const std::string text, read_file(entry.path()));
        const auto file = nlohmann::json::parse(text, nullptr, false);
        if (!file.is_object())
            return Error{"'" + entry.path().string() + "' is damaged: remove it and run the bench once more"};
        add_file(results, name.substr(0, name.find('-')), file);
    }
    return results;
}

void print_frames(const std::string& name, const Side& side) {
    std::printf("%s: %zu frames, ms: median %.1f, 95 %% %.1f, 99 %% %.1f, longest %.1f\n", name.c_str(),
                side.frames.size(), median(side.frames), percentile(side.frames, 0.95), percentile(side.frames, 0.99),
                percentile(side.frames, 1.0));
    for (const auto& [room, frames] : side.by_room)
        std::printf("    %-10s %5zu frames  median %6.1f  95 %% %6.1f  99 %% %6.1f  longest %6.1f\n", room.c_str(),
                    frames.size(), median(frames), percentile(frames, 0.95), percentile(frames, 0.99),
                    percentile(frames, 1.0));
    if (side.state_ms > 0.0)
        std::printf("    of which the bench takes %.2f ms at most: the game tells its state\n", side.state_ms);
    else
        std::printf("    and what of them the bench takes, the game does not say: it writes its state within frames\n");
}

// Runs that ended before their time, such as by a game that was lost or a solution that went nowhere, show less than
// they should.
bool all_ran_to_their_end(const Side& side) {
    bool all = true;
    for (const std::string& end : side.ends)
        if (end.find("time is over") == std::string::npos && end.find("the game is over") == std::string::npos) {
            std::printf("    %s  MISSED\n", end.c_str());
            all = false;
        }
    return all;
}

bool report_pacing(const Side& side) {
    const double usual = median(side.frames);
    const auto above = double(
        std::count_if(side.frames.begin(), side.frames.end(), [&](double frame) { return frame > 3.0 * usual; }));
    bool held = at_most("95th percentile / median", percentile(side.frames, 0.95) / usual, 1.5);
    held = at_most("99th percentile / median", percentile(side.frames, 0.99) / usual, 2.0) && held;
    held = at_most("frames above 3 x the median, in 1,000", 1e3 * above / double(side.frames.size()), 1.0) && held;
    for (const std::string& line : side.long_frames)
        std::printf("      %s\n", line.c_str());
    return held;
}

// Of a side's name, such as "target50", ms; 0: it has none.
double target_of(const std::string& name) {
    const std::string prefix = "target";
    return name.rfind(prefix, 0) == 0 ? std::atof(name.c_str() + prefix.size()) : 0.0;
}

bool report_times(const std::string& name, const Side& side, const Results& results) {
    const double target = target_of(name);
    const auto least = results.sides.find(least_settings);
    if (target > 0.0 && least != results.sides.end())
        return side.target.report(target, least->second.target.high());
    return target > 0.0 || name == least_settings || report_pacing(side);
}

bool report_latency(const Side& side) {
    const double frame = median(side.latency_frames), step = 1e3 * simulation::step_seconds / frame;
    std::printf("    latency: %zu looks, %zu walks, %u lost; in frames of %.1f ms\n", side.looking.size(),
                side.walking.size(), side.lost, frame);
    bool held = at_most("looking, median", median(side.looking) / frame, 1.7);
    held = at_most("looking, 95th percentile", percentile(side.looking, 0.95) / frame, 2.5) && held;
    held = at_most("walking, median", median(side.walking) / frame, 1.7 + step) && held;
    const double events = double(side.looking.size() + side.walking.size()) + side.lost;
    held = at_most("events that never showed, share", side.lost / events, 0.05) && held;
    return at_most("walking, 95th percentile", percentile(side.walking, 0.95) / frame, 2.5 + step) && held;
}

// What was not measured has met no bound.
bool all_measured(const Results& results) {
    const auto& sides = results.sides;
    bool all = true;
    const auto need = [&](bool there, const char* what) {
        if (!there)
            std::printf("%s: not measured  MISSED\n", what);
        all = all && there;
    };
    const auto has = [&](const char* name, std::vector<double> Side::*part) {
        const auto side = sides.find(name);
        return side != sides.end() && !(side->second.*part).empty();
    };
    need(has("before", &Side::frames), "frames of the commit before");
    need(has("after", &Side::frames), "frames");
    need(has("after", &Side::looking) && has("after", &Side::walking), "latency");
    for (const char* target : {least_settings, "target100", "target66", "target50"})
        need(has(target, &Side::frames), target);
    const auto has_passes = [&](const char* name) { return sides.count(name) && !sides.at(name).passes.empty(); };
    need(has_passes("before") && has_passes("after"), "passes");
    need(results.pictures.has("before") && results.pictures.has("after"), "pictures");
    return all;
}

// The rays of the game's light sensors, at as many steps a frame as the runs without a window take.
bool report_sensors(const PassTimes& passes) {
    const auto rays = passes.by_name().find("light sensors (CPU)"), frame = passes.by_name().find("whole frame");
    if (rays == passes.by_name().end() || frame == passes.by_name().end()) {
        std::printf("rays of light sensors: not measured  MISSED\n");
        return false;
    }
    return at_most("rays of light sensors, share of a frame", median(rays->second) / median(frame->second), 0.05);
}

bool compare_sides(const Side& before, const Side& after) {
    if (before.frames.empty() || after.frames.empty())
        return false;
    std::printf("after / before\n");
    const bool held = at_most("median", median(after.frames) / median(before.frames), 0.41);
    const double long_frames = percentile(after.frames, 0.95) / percentile(before.frames, 0.95);
    return at_most("95th percentile", long_frames, 0.35) && held;
}

} // namespace

Result<bool> report(const fs::path& folder) {
    SUNFLECK_ASSIGN(const Results results, read_all(folder));
    const auto& sides = results.sides;
    bool held = all_measured(results);
    for (const auto& [name, side] : sides) {
        if (!side.frames.empty())
            print_frames(name, side);
        const bool ended = all_ran_to_their_end(side);
        const bool paced = side.frames.empty() || report_times(name, side, results);
        const bool quick = side.looking.empty() || report_latency(side);
        held = held && (name == "before" || (ended && paced && quick)); // targets are for what is measured now
    }
    const auto before = sides.find("before"), after = sides.find("after");
    const bool both = before != sides.end() && after != sides.end();
    held = both && compare_sides(before->second, after->second) && held;
    if (both && !(before->second.passes.empty() && after->second.passes.empty()))
        std::fputs(pass_table(before->second.passes, after->second.passes).c_str(), stdout);
    held = after != sides.end() && report_sensors(after->second.passes) && held;
    std::fputs(results.pictures.table().c_str(), stdout);
    return results.pictures.held() && held;
}

} // namespace sunfleck::bench
