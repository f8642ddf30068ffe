// A recorded walk through a level, frame by frame at a fixed step: what `bench level` measures and `bench compare`
// drives.
#pragma once

#include "editor/command_line/common.h"
#include "editor/gate/protocol.h"
#include "engine/simulation/simulation.h"

namespace sunfleck::command_line {

struct LevelOptions {
    std::string scene = "lantern_house";
    std::string input; // recording; empty: the scene's own
    std::string preset = "software";
    std::string size = "320x180"; // rendered
    std::vector<std::string> settings;
    std::uint32_t steps_per_frame = 6;
    std::uint32_t frames = 0; // 0: to the end of the recording
    std::uint32_t warmup = 8;
    std::string device, output;
    bool serve = false;
};

class LevelRun {
public:
    // Loads the level and draws all its shadow maps.
    static Result<std::unique_ptr<LevelRun>> create(const LevelOptions& options);

    // What the programs of a pair must have in common.
    gate::Hello hello() const;
    std::uint32_t frames() const;
    // The next frame that will be drawn.
    std::uint32_t next_frame() const;
    // Simulates up to the frame without drawing; backwards is an error.
    Status go_to(std::uint32_t frame);
    // Simulates and draws the next frame, and appends it. What the GPU counts arrives a frame later: it is written to
    // the frame before.
    Status draw(std::vector<gate::Frame>& frames);
    // Draws the last frame once more, for the counts of the GPU that it lacks.
    Status finish(std::vector<gate::Frame>& frames);
    Status write_picture(const std::string& file);

    const gi::Settings& settings() const { return settings_; }
    Size size() const { return size_; }
    gpu::Device& device() { return *device_; }
    const gi::Report& counters() const { return renderer_->statistics().counters; }

private:
    LevelRun() = default;
    Status load(const LevelOptions& options);
    Status read_input(const LevelOptions& options);
    Status prepare();
    Status render();
    void step();

    Size size_{};
    std::string recording_;
    std::uint32_t stride_ = 1;
    std::vector<simulation::StepInput> input_;
    gi::Settings settings_;
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<viewer::SceneRenderer> renderer_;
    std::unique_ptr<simulation::Simulation> simulation_;
    viewer::FrameRequest request_;
};

// What is wrong with options can be told before anything is built, loaded or run: settings, the scene's name, the walk.
Status check_level(const LevelOptions& options);

Status bench_level(const LevelOptions& options);

} // namespace sunfleck::command_line
