// The level with all that shows it: renderer and simulation of one loaded scene.
#pragma once

#include "engine/simulation/simulation.h"
#include "game_demo/demo_settings.h"
#include "viewer/scene_renderer.h"

namespace sunfleck::demo {

// Where a built-in scene of that name was installed or built.
std::filesystem::path built_in_scene(const std::string& name);

class Level {
public:
    // `scene`: a scene file, glTF file, or the name of a built-in scene.
    // `progress`: io::ImportOptions::progress.
    static Result<std::unique_ptr<Level>> load(gpu::Device& device, const std::string& scene,
                                               const DemoSettings& settings, std::uint32_t frames_in_flight,
                                               const std::function<bool(float)>& progress = {});
    // Does what the first picture of a window of this size waits for: samples, visibility, all shadow maps. In
    // portions, so that other threads' pictures get through. `progress` is told the share that is done; false stops it
    // with an error.
    Status prepare(const DemoSettings& settings, std::uint32_t width, std::uint32_t height,
                   const std::function<bool(float)>& progress);

    viewer::SceneRenderer& renderer() { return *renderer_; }
    simulation::Simulation& simulation() { return *simulation_; }
    void step(const simulation::StepInput& input);
    // What the person sees.
    scene::CameraView view(const DemoSettings& settings) const;
    // From one of the scene's cameras to the next, slowly turning: behind the title.
    scene::CameraView show_round(double seconds) const;
    // Takes over what the player chose.
    Status apply(const DemoSettings& settings);
    // The frame to render for a window (or picture) of this size.
    viewer::FrameRequest request(const DemoSettings& settings, std::uint32_t width, std::uint32_t height);

private:
    Level() = default;
    std::unique_ptr<viewer::SceneRenderer> renderer_;
    std::unique_ptr<simulation::Simulation> simulation_;
    std::vector<scene::CameraView> cameras_;
    float ev100_ = 8.0f;
};

} // namespace sunfleck::demo
