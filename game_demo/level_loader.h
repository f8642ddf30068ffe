// Loads a level on a thread of its own, up to the point where its first picture is quick, so that the window answers
// meanwhile.
#pragma once

#include "game_demo/level.h"

#include <atomic>
#include <thread>

namespace sunfleck::demo {

class LevelLoader {
public:
    // Starts. `width` and `height` of the window.
    LevelLoader(gpu::Device& device, std::string scene, const DemoSettings& settings, std::uint32_t width,
                std::uint32_t height);
    // Stops the work, within a fraction of a second in the long parts of it, and waits for that.
    ~LevelLoader();
    LevelLoader(const LevelLoader&) = delete;
    LevelLoader& operator=(const LevelLoader&) = delete;

    bool finished() const { return finished_; }
    // What is done, 0 to 1. It never falls.
    float share() const { return share_; }
    // The level, or why there is none. Once, after finished().
    Result<std::unique_ptr<Level>> take();

private:
    Result<std::unique_ptr<Level>> load(std::uint32_t width, std::uint32_t height);
    bool report(float share);

    gpu::Device& device_;
    const std::string scene_;
    const DemoSettings settings_;
    std::atomic<bool> finished_{false}, stop_{false};
    std::atomic<float> share_{0.0f};
    std::optional<Result<std::unique_ptr<Level>>> result_;
    std::thread thread_;
};

} // namespace sunfleck::demo
