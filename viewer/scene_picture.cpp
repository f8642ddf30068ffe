// The half of SceneRenderer that makes light, and of light a picture.
#include "viewer/exposure.h"
#include "viewer/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <tuple>

namespace sunfleck::viewer {
namespace {

constexpr VkFormat shown_format = VK_FORMAT_R8G8B8A8_UNORM, light_format = VK_FORMAT_R16G16B16A16_SFLOAT;

} // namespace

bool FrameRequest::is_enlarged() const {
    return tone_map && screen_width > 0 && screen_height > 0 && (screen_width != width || screen_height != height);
}

bool FrameRequest::may_be_temporal() const {
    return temporal && antialiasing && tone_map && view == shared::view_final &&
           (!is_enlarged() || (screen_width >= width && screen_height >= height));
}

bool SceneRenderer::is_cut(const FrameRequest& request) const {
    constexpr float steady = 0.02f; // EV a frame: adaptation that goes on all the time; a hundredth of the brightness
    const FrameRequest& before = previous_request_;
    const auto shown = [](const FrameRequest& frame) { // besides light
        return std::tie(frame.width, frame.height, frame.screen_width, frame.screen_height, frame.view, frame.tone_map,
                        frame.lighting_view, frame.glare, frame.indirect_scale);
    };
    return camera_moves_ || !(std::abs(before.ev100 - request.ev100) < steady) || shown(before) != shown(request) ||
           previous_settings_ != lighting_->settings() || lighting_->counters()["baked_light_updates"] > 0.0;
}

bool SceneRenderer::picture_changes() const {
    const gi::Report& counters = lighting_->counters();
    const std::initializer_list<const char*> unfinished = {
        "shadow_maps_stale",  "shadow_map_updates",  "light_samples_late",   "light_map_updates",
        "light_maps_waiting", "baked_light_waiting", "refined_light_changes"};
    return scene_changed_ ||
           std::any_of(unfinished.begin(), unfinished.end(), [&](const char* name) { return counters[name] > 0.0; });
}

Status SceneRenderer::add_picture(const FrameRequest& request, const render::GBuffer& g_buffer, const Light& light,
                                  const gpu::UploadSlice& camera, gpu::ResourceId output) {
    render::CompositionInput composition;
    composition.irradiance = light.irradiance;
    composition.specular = light.specular;
    composition.view = request.view;
    composition.tone_map = request.tone_map;
    composition.ev100 = request.ev100;
    const bool final = request.tone_map && request.view == shared::view_final;
    const bool temporal = temporal_frame_, smoothed = request.antialiasing && final && !temporal;
    const bool enlarged = request.is_enlarged();
    composition.alpha_is_brightness = smoothed && !enlarged;
    registry_.view<scene::Environment>().each([&](ecs::Entity entity, const scene::Environment& environment) {
        composition.sky += environment.radiance;
        if (const auto* map = registry_.try_get<scene::EnvironmentMap>(entity))
            composition.sky_rotation = map->rotation;
    });
    composition.sky_image = sky_.get();
    if (final && request.glare > 0.0f) {
        composition.glare_share = request.glare;
        composition.glare = glare_.add(*graph_, *gpu_scene_, g_buffer, composition, camera);
    }
    // Other points of a pixel are not as bright: the exposure would follow that, and nothing come to rest.
    if (request.meter && (!temporal || temporal_->begins_round())) {
        SUNFLECK_ASSIGN(const std::uint64_t completed, submission_->completed());
        SUNFLECK_TRY(
            meter_->add(*graph_, *gpu_scene_, g_buffer, composition, camera, {submission_->serial(), completed}));
    }
    const bool shown_as_it_is = !smoothed && !enlarged && !temporal;
    const gpu::ResourceId current =
        shown_as_it_is ? output : graph_->create_image("composed picture", shown_format, request.width, request.height);
    composition_.add(*graph_, *gpu_scene_, g_buffer, composition, camera, current);
    if (final && gpu_scene_->has_stippled_surfaces())
        stipple_.add(*graph_, g_buffer, render::stippled_rectangle(*gpu_scene_, camera_row(request)), current,
                     shown_format);
    debug_lines_->add(*graph_, g_buffer, camera, current);
    const bool changes = picture_changes() || previous_request_.ev100 != request.ev100;
    previous_request_ = request;
    previous_settings_ = lighting_->settings();
    if (compiles_temporal(request) && !temporal) {
        SUNFLECK_TRY(temporal_->add(*graph_, {current, g_buffer.depth, g_buffer.motion, false}, output, *resources_));
        temporal_->forget();
        temporal_compiled_ = true;
    }
    if (temporal)
        return temporal_->add(*graph_, {current, g_buffer.depth, g_buffer.motion, changes}, output, *resources_);
    if (smoothed && enlarged)
        return subpixel_edges_->add(
            *graph_, *gpu_scene_,
            {current, g_buffer, camera, composition.irradiance, composition.specular, composition.ev100}, output,
            *resources_);
    if (smoothed)
        antialiasing_.add(*graph_, current, output);
    else if (enlarged)
        upscale_.add(*graph_, current, output);
    return {};
}

Result<SceneRenderer::Light> SceneRenderer::add_lighting(const FrameRequest& request, const render::GBuffer& g_buffer,
                                                         const gpu::UploadSlice& camera) {
    const gi::GBufferInput input{g_buffer.depth, g_buffer.normals, g_buffer.surface,
                                 g_buffer.width, g_buffer.height,  {},
                                 g_buffer.gloss, g_buffer.albedo};
    Light light;
    light.irradiance = graph_->create_image("irradiance", light_format, request.width, request.height);
    if (request.view == shared::view_final && lighting_->lights_specular() && gpu_scene_->has_glossy_surfaces())
        light.specular = graph_->create_image("specular light", light_format, request.width, request.height);
    SUNFLECK_TRY(lighting_->add_passes(*graph_, *gpu_scene_, input, camera, light.irradiance, light.specular));
    return light;
}

std::optional<float> SceneRenderer::metered_exposure() {
    const auto completed = submission_->completed();
    const std::span<const float> points = completed ? meter_->collect(*completed) : std::span<const float>();
    if (points.empty())
        return std::nullopt;
    io::Picture picture{shared::meter_columns, shared::meter_rows, {}};
    picture.pixels.reserve(points.size());
    for (const float point : points)
        picture.pixels.emplace_back(point, point, point, 1.0f);
    return automatic_exposure(picture);
}

} // namespace sunfleck::viewer
