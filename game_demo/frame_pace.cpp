#include "game_demo/frame_pace.h"

#include "engine/core/log.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::demo {

FrameQuality FramePace::choose(const DemoSettings& settings, Level& level, double now, bool turns, bool playing) {
    const double target = double(settings.frame_milliseconds);
    control_.set(target, {settings.render_scale, settings.map_budget, Level::strength_changes});
    playing_ = playing;
    if (!playing) {
        level.set_map_budget(control_.quality().maps);
        return control_.quality();
    }
    double gpu_ms = 0.0; // where the GPU works beside the CPU, whichever takes longer counts
    for (const auto& [pass, milliseconds] : level.renderer().statistics().gpu_ms)
        gpu_ms += milliseconds;
    const FrameQuality quality =
        control_.next(std::max(work_ms_, gpu_ms), now, control_.on() && (turns || level.moves()));
    level.set_map_budget(quality.maps);
    if (std::exchange(reaches_, !control_.out_of_reach()) == control_.out_of_reach())
        tell(target);
    return quality;
}

void FramePace::tell(double target) {
    if (reaches_ && told_of_ != target)
        return; // the player chose another time
    const std::string frames = "Frames of " + std::to_string(std::lround(target)) + " ms are ";
    const std::string line = reaches_ ? frames + "within reach again"
                                      : frames + "out of reach here: they take longer with the least settings";
    log_information(line);
    if (!reaches_ && std::exchange(told_of_, target) != target)
        message_ = line;
}

} // namespace sunfleck::demo
