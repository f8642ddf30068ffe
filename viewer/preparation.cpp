#include "viewer/preparation.h"

#include <algorithm>
#include <bit>

namespace sunfleck::viewer {
namespace {

constexpr float samples_until = 0.5f; // of the progress; the rest are shadow maps

// Of the last frame; where the device tells no times, that of the whole frame.
double gpu_milliseconds(const FrameStatistics& statistics) {
    double sum = 0.0;
    for (const auto& [name, time] : statistics.gpu_ms)
        sum += time;
    return sum > 0.0 ? sum : statistics.frame_ms;
}

} // namespace

PictureSize small_picture(PictureSize shown) {
    return {std::has_single_bit(shown.width) ? 64u : 60u, std::has_single_bit(shown.height) ? 32u : 36u};
}

Status prepare_lighting(SceneRenderer& renderer, FrameRequest request, const PreparationOptions& options) {
    // Pixels are lit at the end alone. Until then that would be done by kernels that no later frame may need, and some
    // drivers compile a kernel only when it runs, while all wait who share the queue; and maps that are still to be
    // drawn, often hundreds of MiB, would be cleared first.
    request.light_pixels = false;
    request.map_budget = 0;
    request.refinement_budget = 0;
    request.progress = [&](float share) { return options.progress(samples_until * share); };
    SUNFLECK_TRY(renderer.render_and_wait(request));
    request.progress = {};
    request.map_budget = 4;
    for (bool more = true; more;) {
        SUNFLECK_TRY(renderer.render_and_wait(request));
        const gi::Report& counters = renderer.statistics().counters;
        more = (counters["shadow_maps_stale"] > 0 && counters["shadow_map_updates"] > 0) ||
               counters["light_maps_waiting"] > 0 ||
               (counters["baked_light_waiting"] > 0 && counters["baked_light_updates"] > 0);
        const float stale =
            float(counters["shadow_maps_stale"]) / float(std::max<std::uint64_t>(counters["light_samples"], 1));
        if (!options.progress(samples_until + (1.0f - samples_until) * (1.0f - stale)))
            return Error{"preparing the lighting was cancelled"};
        const double milliseconds = gpu_milliseconds(renderer.statistics());
        if (milliseconds < 0.8 * options.portion)
            request.map_budget *= 2;
        else if (milliseconds > 1.6 * options.portion)
            request.map_budget = std::max(request.map_budget / 2, 1u);
    }
    request.light_pixels = true;
    request.refinement_budget = 1; // it begins: its kernels are compiled
    SUNFLECK_TRY(renderer.render_and_wait(request));
    request.as_if_stale = true; // as soon as something moves
    return renderer.render_and_wait(request);
}

bool light_is_being_refined(SceneRenderer& renderer) {
    return renderer.lighting().counters()["refined_light_waiting"] > 0.0;
}

} // namespace sunfleck::viewer
