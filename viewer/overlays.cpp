#include "viewer/overlays.h"

#include "viewer/scene_overlays.h"

namespace sunfleck::viewer {

std::vector<const gi::Overlay*> overlays() {
    std::vector<const gi::Overlay*> all = gi::all_overlays();
    for (const gi::Overlay& overlay : scene_overlays())
        all.push_back(&overlay);
    return all;
}

Status draw_overlay(SceneRenderer& renderer, std::string_view name, gi::OverlayLines& lines) {
    for (const gi::Overlay& overlay : scene_overlays())
        if (overlay.name == name) {
            draw_scene_overlay(overlay.code, renderer, lines);
            return {};
        }
    return renderer.lighting().draw_overlay(name, lines);
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
