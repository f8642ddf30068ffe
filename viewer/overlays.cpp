#include "viewer/overlays.h"

#include "engine/simulation/path_movers.h"

namespace sunfleck::viewer {
namespace {

constexpr gi::Overlay mover_paths{"mover_paths", "Where movers on paths go",
                                  "yellow: all the time, orange: when something sets them going", "scene", 0};
constexpr std::uint32_t path_steps = 96;

void draw_mover_paths(SceneRenderer& renderer, gi::OverlayLines& lines) {
    const scene::SceneSpace& space = renderer.space();
    renderer.registry().view<scene::Mover>().each([&](ecs::Entity entity, const scene::Mover& mover) {
        const std::vector<vec3> places = simulation::mover_path(renderer.registry(), entity, path_steps);
        const bool always = mover.activation == scene::MoverActivation::clock;
        const vec3 colour = always ? vec3(1.0f, 0.9f, 0.3f) : vec3(1.0f, 0.55f, 0.15f);
        for (std::size_t i = 1; i < places.size(); ++i)
            lines.line(space.point(places[i - 1]), space.point(places[i]), colour);
    });
}

} // namespace

std::vector<const gi::Overlay*> overlays() {
    std::vector<const gi::Overlay*> all = gi::all_overlays();
    all.push_back(&mover_paths);
    return all;
}

Status draw_overlay(SceneRenderer& renderer, std::string_view name, gi::OverlayLines& lines) {
    if (name != mover_paths.name)
        return renderer.lighting().draw_overlay(name, lines);
    draw_mover_paths(renderer, lines);
    return {};
}

void SceneRenderer::draw_samples() {
    for (const gi::LightSample& sample : lighting_->samples()) {
        const float brightest = std::max({sample.flux.x, sample.flux.y, sample.flux.z, 1e-12f});
        debug_lines_->line(sample.position, sample.position + 0.12f * sample.normal, sample.flux / brightest);
        debug_lines_->box({sample.position - 0.015f, sample.position + 0.015f}, sample.flux / brightest);
    }
}

Status SceneRenderer::draw_lines(const FrameRequest& request) {
    debug_lines_->clear();
    if (!request.tone_map)
        return {};
    if (request.show_samples)
        draw_samples();
    gi::OverlayLines lines;
    lines.sample = request.overlay_sample;
    for (const std::string& name : request.overlays)
        SUNFLECK_TRY(draw_overlay(*this, name, lines));
    for (const gi::OverlayLines::Line& line : lines.lines())
        debug_lines_->line(line.from, line.to, line.colour);
    return {};
}

} // namespace sunfleck::viewer
