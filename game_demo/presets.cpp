#include "game_demo/presets.h"

#include "viewer/quality.h"

namespace sunfleck::demo {
namespace {

// The nearest quality of similar cost.
viewer::Quality equivalent_quality(const DemoSettings& settings) {
    if (settings.preset != Preset::custom)
        return viewer::Quality(settings.preset);
    return settings.light_samples <= 250   ? viewer::Quality::software
           : settings.light_samples <= 500 ? viewer::Quality::medium
                                           : viewer::Quality::ultra;
}

} // namespace

void apply_preset(DemoSettings& settings) {
    if (settings.preset == Preset::custom)
        return;
    const viewer::QualityPreset& quality = viewer::quality_presets()[std::size_t(settings.preset)];
    settings.render_scale = quality.render_scale;
    settings.light_samples = quality.light_samples;
    settings.map_budget = quality.map_budget;
    settings.transfer = quality.transfer;
}

gi::Settings lighting_of(const DemoSettings& settings) {
    const viewer::Quality quality = equivalent_quality(settings);
    viewer::QualityPreset preset = viewer::quality_presets()[std::size_t(quality)];
    preset.render_scale = settings.render_scale;
    preset.light_samples = settings.light_samples;
    preset.map_budget = settings.map_budget;
    preset.transfer = settings.transfer;
    return viewer::quality_settings(quality, preset);
}

bool has_transfer() {
    return viewer::has_transfer();
}

Preset default_preset(bool software_device) {
    return software_device ? Preset::software : Preset::high;
}

} // namespace sunfleck::demo
