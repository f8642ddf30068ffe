// Loads and prepares a level on its own thread, so that the window stays responsive.
#pragma once

#include "game_demo/level.h"

#include <atomic>
#include <thread>

namespace sunfleck::demo {

class LevelLoader {
public:
    static constexpr std::uint32_t frames_in_flight = 2; // of the level's renderer

    // Starts loading.
    LevelLoader(gpu::Device& device, LevelSource source, const DemoSettings& settings);
    // The same for a level that moves to the device from one that is lost.
    LevelLoader(gpu::Device& device, std::unique_ptr<Level> level, const DemoSettings& settings);
    // Cancels loading and waits for the thread, which in the long parts takes a fraction of a second.
    ~LevelLoader();
    LevelLoader(const LevelLoader&) = delete;
    LevelLoader& operator=(const LevelLoader&) = delete;

    bool finished() const { return finished_; }
    // Fraction done, 0 to 1. Never decreases.
    float share() const { return share_; }
    // The level or the error. Call once, after finished().
    Result<std::unique_ptr<Level>> take();
    // The level that was to move, where it did not get as far as take(): cancels and waits. Null if there was none.
    std::unique_ptr<Level> give_back();

private:
    void start();
    Status load();
    void stop();
    bool report(float share);

    gpu::Device& device_;
    const LevelSource source_;
    const DemoSettings settings_;
    std::atomic<bool> finished_{false}, stop_{false};
    std::atomic<float> share_{0.0f};
    std::unique_ptr<Level> level_;
    bool moves_ = false;
    Status loaded_;
    std::thread thread_;
};

} // namespace sunfleck::demo
