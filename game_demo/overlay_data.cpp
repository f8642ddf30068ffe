#include "game_demo/overlay_data.h"

namespace sunfleck::demo {

OverlayData overlay_data(Level& level, const viewer::FrameRequest& request) {
    const viewer::FrameStatistics& statistics = level.renderer().statistics();
    OverlayData result;
    result.interaction = level.simulation().possible_interaction(level.renderer().registry());
    result.carries_lantern = level.simulation().carries_lantern();
    result.gpu_ms = statistics.gpu_ms;
    result.cpu_ms = statistics.cpu_ms;
    if (level.game().has_sensors())
        result.cpu_ms["light sensors"] = level.take_sensor_milliseconds();
    result.is_game = level.game().is_game();
    if (const scene::GameArea* area = level.game().area()) {
        result.has_area = true;
        result.has_hint = !area->hint.empty();
    }
    result.light_samples = statistics.counters["light_samples"];
    result.rendered_width = request.width;
    result.rendered_height = request.height;
    result.light_share = level.light_share();
    return result;
}

} // namespace sunfleck::demo
