// A loaded level: the renderer and the game of one scene.
#pragma once

#include "engine/simulation/step_interpolation.h"
#include "game_demo/demo_settings.h"
#include "game_demo/game/game_world.h"
#include "viewer/adaptation.h"
#include "viewer/lighting_change.h"

#include <utility>

namespace sunfleck::demo {

// A scene file, glTF file, or the name of a built-in scene.
struct LevelSource {
    std::string scene;
    bool allow_outside = false; // io::ImportOptions::allow_outside
    gi::SensorSettings sensors;
    std::optional<float> ev100{}; // a fixed exposure, in place of the scene's and without adaptation
};

// Reads the scene of a level, without its light.
Result<io::ImportReport> load_world(const LevelSource& source, ecs::Registry& registry, scene::MeshStore& meshes,
                                    scene::TextureStore& textures);

class Level {
public:
    // Samples that may change their strength in a frame: a door or the switch of bounced light changes a hundred and
    // more.
    static constexpr std::uint32_t strength_changes = 8;
    // Of refined light, in a frame: some ten milliseconds of two cores, for the first 300 frames or so.
    static constexpr std::uint32_t refinement = 2000;

    // `progress`: io::ImportOptions::progress.
    static Result<std::unique_ptr<Level>> load(gpu::Device& device, const LevelSource& source,
                                               const DemoSettings& settings, std::uint32_t frames_in_flight,
                                               const std::function<bool(float)>& progress = {});
    // Does the work that would delay the first frame: samples, visibility, all shadow maps. Works in small portions, so
    // that other threads can present frames meanwhile. `progress` receives the fraction done and returns false to
    // cancel with an error.
    Status prepare(const DemoSettings& settings, const std::function<bool(float)>& progress);
    // To another device, because the present one is lost: the world goes on from where it is, and its light is made
    // once more. Nothing has changed on an error. The device before may go then.
    Status move_to(gpu::Device& device, std::uint32_t frames_in_flight);

    viewer::SceneRenderer& renderer() { return *renderer_; }
    GameWorld& game() { return *game_; }
    simulation::Simulation& simulation() { return game_->simulation(); }
    // Readings of sensors stay as they are if rays fail; the log says so once.
    void step(const simulation::StepInput& input);
    // What light sensors took since the last call, ms.
    double take_sensor_milliseconds() { return std::exchange(sensor_milliseconds_, 0.0); }
    // The person's view; without a moment, that of the last step.
    scene::CameraView view(const DemoSettings& settings, const simulation::DrawnMoment& moment = {}) const;
    // The view behind the title: the scene's cameras in turn, slowly panning.
    scene::CameraView title_camera(double seconds) const;
    // The world as it was loaded, at step 0; the light stays.
    void restart();
    // The world was put elsewhere, by a checkpoint: there is no way from where it was.
    void jumped() { interpolation_.forget(); }
    // Whether the last step moved the person's view, a lamp, or anything in sight: where not, lifts far off go on, but
    // the picture is at rest. What is in sight is known since the first frame.
    bool moves() const;
    // viewer::SceneRenderer::update with what moves between the last two steps at that moment; the simulation is what
    // it was afterwards.
    Status update(const viewer::FrameRequest& request, const simulation::DrawnMoment& moment);
    // Applies the player's settings at once; makes the next frame wait for their light.
    Status apply(const DemoSettings& settings);
    // The same beside the frames (viewer/lighting_change.h), which go on with the present light. Once each frame, so
    // that it takes effect; the error is why a change failed, and the light stays as it was.
    void apply_later(const DemoSettings& settings);
    Status advance_light();
    // Shadow maps a frame, from the next frame on: needs no other light.
    void set_map_budget(std::uint32_t maps);
    // How far a change of light is, 0 to 1; none: everything that was applied is shown.
    std::optional<float> light_share() const;
    // Once before each request: the exposure follows what was seen. `seconds`: since the last call.
    void adapt(const DemoSettings& settings, double seconds);
    float shown_exposure() const { return ev100_; } // EV100, before the player's compensation
    // The frame request for a window or image of this size.
    viewer::FrameRequest request(const DemoSettings& settings, std::uint32_t width, std::uint32_t height,
                                 const simulation::DrawnMoment& moment = {});

private:
    Level() = default;
    void note_sensors(const Status& followed);
    ecs::Registry start_; // the world at step 0
    std::unique_ptr<viewer::SceneRenderer> renderer_;
    std::unique_ptr<viewer::LightingChanges> changes_;
    gi::Settings wanted_; // applied last
    std::unique_ptr<GameWorld> game_;
    simulation::StepInterpolation interpolation_;
    double sensor_milliseconds_ = 0.0;
    bool sensors_failed_ = false;
    std::vector<scene::CameraView> cameras_;
    float usual_ev100_ = 8.0f, ev100_ = 8.0f; // the scene's; what is shown
    bool fixed_exposure_ = false;
    viewer::ExposureAdaptation adaptation_;
};

} // namespace sunfleck::demo
