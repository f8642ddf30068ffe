// A game in a window: what the player is told (titles, hints, what a sensor gets and needs, the end), and checkpoints.
#pragma once

#include "game_demo/demo_settings.h"
#include "game_demo/game/checkpoint_files.h"

#include <functional>
#include <future>
#include <utility>

namespace sunfleck::demo {

struct GameProgress {
    std::string area; // the title of where the person is
    vec3 place{0.0f}; // of their feet, m
    float yaw = 0.0f; // rad
    std::uint64_t steps = 0;
    bool hint = false, finished = false, carries_lantern = false, can_resume = false;
};

class GameSession {
public:
    // `scene`: the level, as the user named it. Checkpoints are kept nowhere if `folder` is empty.
    GameSession(const std::string& scene, const std::filesystem::path& folder);
    ~GameSession(); // when the last checkpoint is written
    GameSession(const GameSession&) = delete;
    GameSession& operator=(const GameSession&) = delete;

    // Of a level that was just loaded. `resume`: goes on at the last checkpoint; else the first one is made. False:
    // none is good, and the level must be loaded once more.
    bool begin(GameWorld& world, bool resume);
    bool can_resume() const { return has_folder_ && files_.any(); }
    // After a frame's steps: notices new areas, saves a checkpoint there, on a thread: no frame waits for the disk. At
    // the end of the game the checkpoints go.
    void update(double seconds);
    void show_hint();
    // Saves a checkpoint where the player stands, unless the game has ended: whoever quits goes on from there. Waits.
    Status keep();
    GameProgress progress() const;
    // The game as a checkpoint would keep it; empty before it began.
    std::string saved() const { return world_ != nullptr ? save_game(*world_, files_.level()) : std::string(); }
    // The same, to be made into text by any thread (keep_game); null before it began.
    std::function<std::string()> kept() const {
        return world_ != nullptr ? keep_game(*world_, files_.level()) : std::function<std::string()>();
    }
    bool is_game() const { return world_ != nullptr && world_->is_game(); }
    bool has_area() const { return world_ != nullptr && world_->area() != nullptr; }
    bool has_hint() const { return has_area() && !world_->area()->hint.empty(); }
    bool finished() const { return world_ != nullptr && world_->finished(); }
    double seconds() const { return seconds_; }

    // Draws over the picture, between Gui::begin_frame and end_frame.
    void draw() const;
    // What is to be told once, such as a checkpoint that was set aside; empty: nothing.
    std::string take_message() { return std::exchange(message_, {}); }

private:
    void save_checkpoint();
    void remove_checkpoints();
    void end_saving(); // waits, and keeps what went wrong as a message
    void draw_title() const;
    void draw_sensor() const;

    CheckpointFiles files_;
    bool has_folder_ = false;
    GameWorld* world_ = nullptr;
    ecs::Entity area_;
    double seconds_ = 0.0, title_seconds_ = 0.0, hint_seconds_ = 0.0, area_seconds_ = 0.0;
    std::string message_;
    bool ended_ = false;
    std::future<Status> saving_; // valid: a checkpoint is being written, or all are removed
};

} // namespace sunfleck::demo
