#include "game_demo/presets.h"

#include "viewer/quality.h"

#include <algorithm>

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
    gi::Settings result = viewer::quality_settings(quality, preset);
    if (!settings.refines)
        result.baked_samples = 0;
    return result;
}

DemoSettings first_light(DemoSettings settings) {
    constexpr std::uint32_t share = 6, least = 32;
    settings.preset = Preset::custom;
    settings.light_samples = std::min(settings.light_samples, std::max(settings.light_samples / share, least));
    settings.transfer = false;
    settings.refines = false;
    return settings;
}

bool has_transfer() {
    return viewer::has_transfer();
}

Preset default_preset(bool software_device) {
    return software_device ? Preset::software : Preset::high;
}

} // namespace sunfleck::demo
