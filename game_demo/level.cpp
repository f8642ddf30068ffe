#include "game_demo/level.h"

#include "engine/core/file.h"
#include "game_demo/presets.h"
#include "viewer/built_in_scenes.h"
#include "viewer/exposure.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::demo {
namespace {

constexpr double seconds_per_camera = 9.0;

} // namespace

Result<io::ImportReport> load_world(const LevelSource& source, ecs::Registry& registry, scene::MeshStore& meshes,
                                    scene::TextureStore& textures) {
    SUNFLECK_ASSIGN(const std::filesystem::path path, viewer::find_scene(source.scene));
    io::ImportOptions import;
    import.allow_outside = source.allow_outside;
    return io::load_scene(path, registry, meshes, textures, import);
}

Result<std::unique_ptr<Level>> Level::load(gpu::Device& device, const LevelSource& source, const DemoSettings& settings,
                                           std::uint32_t frames_in_flight, const std::function<bool(float)>& progress) {
    std::unique_ptr<Level> level(new Level());
    SUNFLECK_ASSIGN(level->renderer_, viewer::SceneRenderer::create(device, frames_in_flight));
    SUNFLECK_ASSIGN(const std::filesystem::path path, viewer::find_scene(source.scene));
    io::ImportOptions import;
    import.progress = progress;
    import.allow_outside = source.allow_outside;
    level->renderer_->lighting().set_cache_folder(user_cache_folder());
    SUNFLECK_TRY(level->renderer_->load(path, import));
    ecs::Registry& registry = level->renderer_->registry();
    level->ev100_ = viewer::scene_exposure(registry).value_or(viewer::default_exposure);
    registry.view<scene::Camera, scene::Name>().each(
        [&](ecs::Entity entity, const scene::Camera&, const scene::Name& name) {
            if (name.name.rfind("bench", 0) != 0)
                level->cameras_.push_back(scene::camera_view(registry, entity));
        });
    level->simulation_ = std::make_unique<simulation::Simulation>(registry, level->renderer_->meshes());
    SUNFLECK_TRY(level->apply(settings));
    SUNFLECK_TRY(level->sensors_.begin(source.sensors));
    return level;
}

Status Level::prepare(const DemoSettings& settings, std::uint32_t width, std::uint32_t height,
                      const std::function<bool(float)>& progress) {
    constexpr float samples_until = 0.5f; // the rest are shadow maps
    viewer::FrameRequest request = this->request(settings, width, height);
    request.map_budget = 0;
    request.progress = [&](float share) { return progress(samples_until * share); };
    SUNFLECK_TRY(renderer_->render_and_wait(request));
    request.progress = {};
    // Adapts the number of maps so that a portion takes about 0.1 s.
    request.map_budget = 4;
    for (bool more = true; more;) {
        SUNFLECK_TRY(renderer_->render_and_wait(request));
        const gi::Report& counters = renderer_->statistics().counters;
        more = counters["shadow_maps_stale"] > 0 && counters["shadow_map_updates"] > 0;
        const float stale =
            float(counters["shadow_maps_stale"]) / float(std::max<std::uint64_t>(counters["light_samples"], 1));
        if (!progress(samples_until + (1.0f - samples_until) * (1.0f - stale)))
            return Error{"loading was cancelled"};
        const double milliseconds = renderer_->statistics().frame_ms;
        request.map_budget = milliseconds < 80.0    ? request.map_budget * 2
                             : milliseconds > 160.0 ? std::max(request.map_budget / 2, 1u)
                                                    : request.map_budget;
    }
    return {};
}

void Level::step(const simulation::StepInput& input) {
    simulation_->step(renderer_->registry(), input);
    sensors_.step(renderer_->registry(), renderer_->meshes(), renderer_->textures());
}

scene::CameraView Level::view(const DemoSettings& settings) const {
    scene::CameraView view;
    view.position = simulation_->player().eye();
    view.target = view.position + simulation_->player().forward();
    view.vertical_field_of_view = glm::radians(settings.field_of_view);
    return view;
}

scene::CameraView Level::title_camera(double seconds) const {
    if (cameras_.empty())
        return view(DemoSettings());
    const double place = std::max(seconds, 0.0) / seconds_per_camera;
    scene::CameraView view = cameras_[std::size_t(place) % cameras_.size()];
    const float turn = float(place - std::floor(place)) - 0.5f;
    view.target = view.position + glm::angleAxis(0.35f * turn, vec3(0.0f, 1.0f, 0.0f)) * (view.target - view.position);
    return view;
}

Status Level::apply(const DemoSettings& settings) {
    return renderer_->lighting().set_settings(lighting_of(settings));
}

viewer::FrameRequest Level::request(const DemoSettings& settings, std::uint32_t width, std::uint32_t height) {
    viewer::FrameRequest request;
    request.simulate = false;
    request.step = simulation_->steps();
    request.camera = view(settings);
    request.screen_width = width;
    request.screen_height = height;
    const auto scaled = [&](std::uint32_t size) {
        return std::max(1u, std::uint32_t(std::lround(float(size) * settings.render_scale)));
    };
    request.width = scaled(width);
    request.height = scaled(height);
    request.antialiasing = settings.antialiasing;
    request.glare = settings.glare;
    request.ev100 = ev100_ - settings.exposure;
    return request;
}

} // namespace sunfleck::demo
