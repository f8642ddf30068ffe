// The demo in a window of its own display, with the layer that writes when it presents: started at a room's checkpoint,
// with all of its light.
#pragma once

#include "tests/bench/smoothness/x_display.h"
#include "tests/support/driven_display.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

namespace sunfleck::bench {

using Clock = std::chrono::steady_clock; // CLOCK_MONOTONIC, as the layer's

// In order, from the first room to the last.
const std::vector<std::string>& rooms();
// Plays the solution without pictures and keeps a checkpoint at the entry of each room in FOLDER/ROOM/sunfleck.
Status write_rooms(const std::filesystem::path& folder);

struct GameStart {
    std::filesystem::path demo;   // the program
    std::filesystem::path rooms;  // see write_rooms
    std::filesystem::path folder; // for what this run writes; emptied
    std::string room;
    std::vector<std::string> arguments; // further ones for the program
};

class DrivenGame {
public:
    // Returns when the game is played and has had all of its light.
    static Result<std::unique_ptr<DrivenGame>> start(const GameStart& start);
    ~DrivenGame();
    DrivenGame(const DrivenGame&) = delete;
    DrivenGame& operator=(const DrivenGame&) = delete;

    XDisplay& display() { return *x_; }
    // What the game says of itself, if that is new since the last call.
    std::optional<nlohmann::json> new_state();
    // The time between presents from one moment to another, ms. The program must have ended, or go on presenting.
    std::vector<double> frame_times(Clock::time_point from, Clock::time_point to) const;
    std::string log() const;
    // False: it ended by itself.
    bool runs() const;

private:
    explicit DrivenGame(std::filesystem::path folder) : folder_(std::move(folder)), display_(folder_ / "display") {}
    Status launch(const GameStart& start);
    Status begin_playing();
    bool wait_for_screen(const std::string& screen, double seconds);

    std::filesystem::path folder_, state_file_;
    tests::DrivenDisplay display_;
    std::unique_ptr<XDisplay> x_;
    pid_t process_ = -1;
    std::uint64_t seen_ = 0; // time of the state's file, ns
    std::string screen_;
};

} // namespace sunfleck::bench
