// The quality presets of a level: which light settings fit which device. The demo offers them, `sunfleck bench level`
// measures with them.
#pragma once

#include "gi_module/settings.h"

#include <span>

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

// Whether precomputed radiance transfer is among the techniques of this build.
bool has_transfer();
// `preset` has the quality's own values or others in their place.
gi::Settings quality_settings(Quality quality, const QualityPreset& preset);

} // namespace sunfleck::viewer
