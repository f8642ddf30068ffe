// What the window's game does, in a file that is replaced at every frame that changed it: for tests, and other programs
// that press its keys and wait for what comes of them. A thread makes the text and writes it, so that those who measure
// frames do not measure the file; what is left of it in a frame is told in it ("state_ms").
#pragma once

#include "game_demo/game_session.h"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace sunfleck::demo {

struct GameState {
    std::string screen;   // see screen_name()
    std::string selected; // button of the menu; empty: none
    GameProgress progress;
    std::string device; // of sound; empty: none
    std::vector<std::string> subtitles;
    std::string message;
    std::function<std::string()> saved; // makes the game as a checkpoint would keep it; null: there is none
    bool bounced_light = true;          // is shown
    bool reaches_frame_time = true;     // see FramePace::reaches_target
};

class StateFile {
public:
    // No file if the path is empty.
    explicit StateFile(std::string path);
    ~StateFile();
    StateFile(const StateFile&) = delete;
    StateFile& operator=(const StateFile&) = delete;

    // Hands over what `take` returns, which is not called without a file. States that the thread did not get to are
    // left out, but for the newest. An error is that of an earlier write.
    Status write(const std::function<GameState()>& take);
    // Waits until the newest state is written.
    Status finish();

private:
    void work();
    Status write_now(const GameState& state, double frame_ms);

    const std::string path_;
    std::string written_;     // the thread's
    double spent_ms_ = 0.0;   // in write()
    std::uint64_t taken_ = 0; // states
    std::mutex mutex_;        // of what follows
    std::condition_variable changed_;
    std::optional<GameState> waiting_;
    double frame_ms_ = 0.0; // that a frame spent in write(), in the mean
    bool writes_ = false, ends_ = false;
    Status status_;
    std::thread thread_;
};

} // namespace sunfleck::demo
