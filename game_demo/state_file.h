// What the window's game does, in a file that is replaced at every frame that changed it: for tests, and other programs
// that press its keys and wait for what comes of them.
#pragma once

#include "game_demo/game_session.h"

namespace sunfleck::demo {

struct GameState {
    std::string screen;   // see screen_name()
    std::string selected; // button of the menu; empty: none
    GameProgress progress;
    std::string device; // of sound; empty: none
    std::vector<std::string> subtitles;
    std::string message;
    std::string saved; // the game as a checkpoint would keep it (game/saved_game.h)
};

class StateFile {
public:
    // No file if the path is empty.
    explicit StateFile(std::string path) : path_(std::move(path)) {}
    Status write(const GameState& state);

private:
    std::string path_, written_;
};

} // namespace sunfleck::demo
