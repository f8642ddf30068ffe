// The checkpoints of a level on disk: the newest, and the one before it. Writes are atomic, so that whatever interrupts
// one leaves the last good checkpoint.
#pragma once

#include "game_demo/game/saved_game.h"

#include <filesystem>

namespace sunfleck::demo {

// What tells a level from all others: the name of a built-in scene, or the whole path of a file, however it was given.
std::string identity_of_level(const std::string& scene);

class CheckpointFiles {
public:
    // `scene`: the level, as the user named it. The folder is made when something is written.
    CheckpointFiles(std::filesystem::path folder, const std::string& scene);

    Status save(const GameWorld& world) const { return write(save_game(world, level_)); }
    // The same for a game that was made into text before (save_game); for any thread, one at a time.
    Status write(const std::string& text) const;
    // Loads the newest that is good; false if there is none. What is not good is renamed to end in ".damaged", and
    // `message` says so, in one line.
    bool load(GameWorld& world, std::string& message) const;
    bool any() const;
    // Removes them: the game has ended, and there is nothing to go on with.
    Status clear() const;
    // Its identity, by which saved games name it.
    const std::string& level() const { return level_; }

    std::filesystem::path newest() const { return newest_; }
    std::filesystem::path older() const { return older_; }

private:
    std::filesystem::path folder_;
    std::string level_;
    std::filesystem::path newest_, older_;
};

} // namespace sunfleck::demo
