#include "game_demo/presets.h"

#include <algorithm>

namespace sunfleck::demo {
namespace {

struct Quality {
    float render_scale;
    std::uint32_t light_samples, map_budget;
    bool transfer;
};
constexpr Quality qualities[] = {
    {0.5f, 200, 24, false},  // software
    {0.67f, 250, 40, false}, // low
    {0.75f, 400, 60, false}, // medium
    {1.0f, 600, 120, true},  // high
    {1.0f, 1500, 300, true}, // ultra
};

// The nearest preset of similar cost.
Preset equivalent_preset(const DemoSettings& settings) {
    if (settings.preset != Preset::custom)
        return settings.preset;
    return settings.light_samples <= 250   ? Preset::software
           : settings.light_samples <= 500 ? Preset::medium
                                           : Preset::ultra;
}

} // namespace

void apply_preset(DemoSettings& settings) {
    if (settings.preset == Preset::custom)
        return;
    const Quality& quality = qualities[std::size_t(settings.preset)];
    settings.render_scale = quality.render_scale;
    settings.light_samples = quality.light_samples;
    settings.map_budget = quality.map_budget;
    settings.transfer = quality.transfer;
}

gi::Settings lighting_of(const DemoSettings& settings) {
    const Preset preset = equivalent_preset(settings);
    gi::Settings result;
    result.lights = settings.light_samples;
    result.map_budget = settings.map_budget;
    result.bounces = preset <= Preset::low ? 3 : 5;
    result.shadow_map_resolution = preset <= Preset::low ? 128 : 256;
    result.low_resolution = preset == Preset::ultra ? 1 : 2;
    result.patch_levels = 2; // the house has many small surfaces
    result.dynamic_share = 0.2f;
    result.map_priority = gi::MapPriority::contribution;
    if (settings.transfer && has_transfer())
        result.with("movers", "prt");
    return result;
}

bool has_transfer() {
    const std::vector<std::string_view>& choices = gi::Settings::find("movers")->choices;
    return std::find(choices.begin(), choices.end(), "prt") != choices.end();
}

Preset default_preset(bool software_device) {
    return software_device ? Preset::software : Preset::high;
}

} // namespace sunfleck::demo
