// The sounds of a level in a window, and their subtitles.
#pragma once

#include "engine/app/sound.h"
#include "game_demo/demo_settings.h"
#include "game_demo/game/heard.h"

#include <array>
#include <deque>

namespace sunfleck::demo {

class GameSounds {
public:
    GameSounds();
    // Once a frame. `playing`: otherwise nothing is heard.
    void update(const GameWorld& world, const DemoSettings& settings, double seconds, bool playing);
    // The world was exchanged for another moment of it.
    void forget();
    // Draws over the picture, between Gui::begin_frame and end_frame.
    void draw() const;
    // The sound device; empty: there is none.
    const std::string& device() const { return sound_.device(); }
    // What the subtitles say now.
    std::vector<std::string> subtitles() const;

private:
    struct Line {
        std::string text;
        double seconds;
    };
    void play(const Heard& heard);
    void write(const GameWorld& world, const Heard& heard);
    void end_others(const std::vector<Heard>& heard);

    app::Sound sound_;
    std::array<app::Sound::Clip, sound_kinds> clips_{};
    Listening listening_;
    std::vector<std::uint64_t> going_on_; // keys
    std::deque<Line> lines_;
};

} // namespace sunfleck::demo
