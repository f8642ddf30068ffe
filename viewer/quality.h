// The quality presets of a level: which light settings fit which device. The demo offers them, `sunfleck bench level`
// measures with them.
#pragma once

#include "gi_module/settings.h"

#include <map>
#include <span>
#include <string>

namespace sunfleck::viewer {

constexpr float usual_field_of_view = 68.0f; // degrees, from bottom to top

enum class Quality : std::uint32_t { software, low, medium, high, ultra };

struct QualityPreset {
    const char* name;
    float render_scale; // of the window's size
    std::uint32_t light_samples, map_budget;
    bool transfer;                        // complex movers by precomputed radiance transfer
    std::uint32_t moving_light_tiles = 4; // of the shadows of a lamp that is carried
};
// In the order of Quality.
std::span<const QualityPreset> quality_presets();

// Of a picture to look at, where neither scene nor user says otherwise: gi's defaults with filtered shadows.
const gi::Settings& usual_lighting();
// The values of `settings` that are not the usual ones, as scene files and presets keep them.
std::map<std::string, std::string> unusual_lighting(const gi::Settings& settings);

// Whether precomputed radiance transfer is among the techniques of this build.
bool has_transfer();
// `preset` has the quality's own values or others in their place.
gi::Settings quality_settings(Quality quality, const QualityPreset& preset);

} // namespace sunfleck::viewer
