#include "game_demo/level.h"

#include "engine/core/log.h"
#include "engine/core/user_folders.h"
#include "engine/ecs/world_copy.h"
#include "game_demo/in_sight.h"
#include "game_demo/presets.h"
#include "viewer/built_in_scenes.h"
#include "viewer/exposure.h"
#include "viewer/preparation.h"

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
    level->fixed_exposure_ = source.ev100.has_value();
    level->usual_ev100_ = level->ev100_ =
        source.ev100 ? *source.ev100 : viewer::scene_exposure(registry).value_or(viewer::default_exposure);
    registry.view<scene::Camera, scene::Name>().each(
        [&](ecs::Entity entity, const scene::Camera&, const scene::Name& name) {
            if (name.name.rfind("bench", 0) != 0)
                level->cameras_.push_back(scene::camera_view(registry, entity));
        });
    ecs::copy_world(registry, level->start_);
    level->changes_ = std::make_unique<viewer::LightingChanges>(device);
    SUNFLECK_ASSIGN(level->game_, GameWorld::create(registry, level->renderer_->meshes(), &level->renderer_->textures(),
                                                    source.sensors));
    SUNFLECK_TRY(level->apply(settings));
    return level;
}

Status Level::prepare(const DemoSettings& settings, const std::function<bool(float)>& progress) {
    // Nothing that is kept depends on the picture. Hardly any side of the game's is a power of two.
    const viewer::PictureSize small = viewer::small_picture({});
    const auto of_screen = [&](std::uint32_t size) { return std::uint32_t(float(size) / settings.render_scale); };
    return viewer::prepare_lighting(*renderer_, request(settings, of_screen(small.width), of_screen(small.height)),
                                    {100.0, progress});
}

Status Level::move_to(gpu::Device& device, std::uint32_t frames_in_flight) {
    SUNFLECK_ASSIGN(auto renderer, viewer::SceneRenderer::create(device, frames_in_flight));
    renderer->lighting().set_cache_folder(user_cache_folder());
    SUNFLECK_TRY(renderer->lighting().set_settings(wanted_));
    SUNFLECK_TRY(renderer->take_scene(renderer_->copy_scene(viewer::SceneRenderer::CopyOf::all)));
    game_->continue_with(renderer->registry(), renderer->meshes(), &renderer->textures());
    changes_ = std::make_unique<viewer::LightingChanges>(device); // the one before draws with the renderer before
    interpolation_.forget();
    renderer_ = std::move(renderer);
    return {};
}

void Level::restart() {
    ecs::copy_world(start_, renderer_->registry());
    note_sensors(game_->restart());
    interpolation_.forget();
}

bool Level::moves() const {
    if (interpolation_.eye_moves())
        return true;
    const vec3 eye = renderer_->space().point(interpolation_.eye(game_->simulation(), {}).position);
    const std::vector<ecs::Entity> moved = interpolation_.moved();
    return std::any_of(moved.begin(), moved.end(), [&](ecs::Entity entity) {
        const scene::DrawItem* item = renderer_->gpu_scene().find(entity);
        return gives_light(renderer_->registry(), entity) ||
               (item != nullptr && in_sight(renderer_->rays(), eye, entity, item->bounds));
    });
}

Status Level::update(const viewer::FrameRequest& request, const simulation::DrawnMoment& moment) {
    interpolation_.apply(renderer_->registry(), game_->simulation(), moment);
    Status updated = renderer_->update(request);
    interpolation_.undo(renderer_->registry());
    return updated;
}

void Level::step(const simulation::StepInput& input) {
    const Status stepped = game_->step(input);
    interpolation_.took_step(game_->registry(), game_->simulation());
    if ((input.buttons & simulation::button_reset) != 0)
        interpolation_.forget();
    if (game_->has_sensors())
        sensor_milliseconds_ += game_->sensors().milliseconds();
    note_sensors(stepped);
}

void Level::note_sensors(const Status& followed) {
    if (!followed && !std::exchange(sensors_failed_, true))
        log_warning("light sensors stay as they are: " + followed.error().message);
}

scene::CameraView Level::view(const DemoSettings& settings, const simulation::DrawnMoment& moment) const {
    const simulation::DrawnEye eye = interpolation_.eye(game_->simulation(), moment);
    scene::CameraView view;
    view.position = eye.position;
    view.target = view.position + eye.forward();
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
    changes_->cancel();
    wanted_ = lighting_of(settings);
    return renderer_->lighting().set_settings(wanted_);
}

void Level::apply_later(const DemoSettings& settings) {
    const gi::Settings lighting = lighting_of(settings);
    if (lighting == wanted_)
        return;
    wanted_ = lighting;
    gi::Settings present = renderer_->lighting().settings();
    present.map_budget = lighting.map_budget; // needs no other light
    if (lighting != present)
        return changes_->request(lighting);
    changes_->cancel();
    static_cast<void>(renderer_->lighting().set_settings(lighting)); // they are those of a menu, within their ranges
}

Status Level::advance_light() {
    const Result<bool> changed = changes_->advance(*renderer_);
    if (changed)
        return {};
    wanted_ = renderer_->lighting().settings();
    return changed.error();
}

void Level::set_map_budget(std::uint32_t maps) {
    gi::Settings present = renderer_->lighting().settings();
    if (std::exchange(present.map_budget, maps) != maps)
        static_cast<void>(renderer_->lighting().set_settings(present)); // within its range, as that of a menu is
}

std::optional<float> Level::light_share() const {
    return changes_->pending() ? std::optional(changes_->share()) : std::nullopt;
}

void Level::adapt(const DemoSettings& settings, double seconds) {
    if (!settings.adaptation || fixed_exposure_) {
        adaptation_.forget();
        ev100_ = usual_ev100_;
        return;
    }
    ev100_ = adaptation_.advance(usual_ev100_, renderer_->metered_exposure(), seconds);
}

viewer::FrameRequest Level::request(const DemoSettings& settings, std::uint32_t width, std::uint32_t height,
                                    const simulation::DrawnMoment& moment) {
    viewer::FrameRequest request;
    request.simulate = false;
    request.step = game_->simulation().steps();
    request.camera = view(settings, moment);
    request.screen_width = width;
    request.screen_height = height;
    const auto scaled = [&](std::uint32_t size) {
        return std::max(1u, std::uint32_t(std::lround(float(size) * settings.render_scale)));
    };
    request.width = scaled(width);
    request.height = scaled(height);
    request.antialiasing = settings.antialiasing;
    request.temporal = settings.temporal;
    request.glare = settings.glare;
    request.strength_budget = strength_changes;
    request.refinement_budget = refinement;
    request.ev100 = ev100_ - settings.exposure;
    request.meter = settings.adaptation && !fixed_exposure_;
    return request;
}

} // namespace sunfleck::demo
