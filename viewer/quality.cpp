#include "viewer/quality.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace sunfleck::viewer {
namespace {

constexpr QualityPreset presets[] = {
    {"software", 0.5f, 200, 24, false, 1}, // without a GPU
    {"low", 0.67f, 250, 40, false, 2},     {"medium", 0.75f, 400, 60, false, 4},
    {"high", 1.0f, 600, 120, true, 8},     {"ultra", 1.0f, 1500, 300, true, 16},
};

} // namespace

std::span<const QualityPreset> quality_presets() {
    return presets;
}

const gi::Settings& usual_lighting() {
    static const gi::Settings usual = [] {
        gi::Settings settings;
        settings.shadow_filter = true; // without it, maps draw their texels on the walls
        const std::vector<std::string_view>& choices = gi::Settings::find("specular")->choices;
        if (std::find(choices.begin(), choices.end(), "gloss") != choices.end())
            settings.with("specular", "gloss");
        return settings;
    }();
    return usual;
}

std::map<std::string, std::string> unusual_lighting(const gi::Settings& settings) {
    std::map<std::string, std::string> result;
    for (const std::string_view name : gi::Settings::names())
        if (std::string value = settings.get(name); value != usual_lighting().get(name))
            result.emplace(name, std::move(value));
    return result;
}

bool has_transfer() {
    const std::vector<std::string_view>& choices = gi::Settings::find("movers")->choices;
    return std::find(choices.begin(), choices.end(), "prt") != choices.end();
}

gi::Settings quality_settings(Quality quality, const QualityPreset& preset) {
    gi::Settings result = usual_lighting();
    result.lights = preset.light_samples;
    result.map_budget = preset.map_budget;
    result.shadow_map_resolution = quality <= Quality::low ? 128 : 256;
    // A picture is as near to the path tracer with a quarter as with half of its pixels in each direction, at any size;
    // it is the repair that draws what is fine.
    result.low_resolution = quality == Quality::ultra ? 1 : 4;
    result.repair_contacts = quality > Quality::low; // with less, shadow maps are too coarse to show contacts
    result.patch_levels = 2;                         // houses have many small surfaces
    result.dynamic_share = 0.2f;
    result.baked_samples = quality <= Quality::low ? 1600 : 3200; // these are made once
    result.map_priority = gi::MapPriority::contribution;
    if (gi::Settings::find("moving_light_tiles") != nullptr)
        result.with("moving_light_tiles", std::to_string(preset.moving_light_tiles));
    if (quality == Quality::software && gi::Settings::find("gloss_samples") != nullptr)
        result.with("gloss_samples", "48");
    if (preset.transfer && has_transfer())
        result.with("movers", "prt");
    return result;
}

} // namespace sunfleck::viewer
