// Settings of splatted indirect light.
#pragma once

#include "engine/core/description.h"
#include "gi_module/light_sampling/importance_warping.h"
#include "gi_module/light_sampling/refracted_light.h"

namespace sunfleck::gi {

// Whose first bounce is splatted: a short way to fill cells of the light plan. moving: emitters that move or vary, and
// what movers reflect (first_bounce.dynamic); all: every first bounce.
enum class SplatChoice : std::uint32_t { none, moving, all };
// What pixel lights are chosen by.
enum class SplatImportance : std::uint32_t { none, flux, contribution };

// Where pixel lights are: on surfaces, where they stay while their emitter moves; or in a pattern that is fixed in the
// emitter's view.
enum class SplatPattern : std::uint32_t { followed, fixed };

// What blocks the light of pixel lights: nothing; ambient occlusion, as a factor of their flux; a shadow map of each.
enum class SplatOcclusion : std::uint32_t { none, ambient, maps };

struct SplattingSettings {
    SplatChoice splat_lights = SplatChoice::none;
    std::uint32_t splats = 256;
    std::uint32_t glossy_splats = 0;
    bool splat_footprints = true;
    Refraction splat_refraction = Refraction::traced;
    std::uint32_t splat_rays = 4096;
    SplatPattern splat_pattern = SplatPattern::followed;
    SplatImportance splat_importance = SplatImportance::flux;
    WarpMethod splat_warp = WarpMethod::a;
    std::uint32_t splat_warp_levels = 6;
    float splat_cutoff = 0.0f; // of the mean irradiance
    bool splat_lists = true;
    bool splat_levels = false;
    SplatOcclusion splat_occlusion = SplatOcclusion::maps;
    std::uint32_t splat_map_side = 32; // texels
    bool splat_map_filter = true;
    float splat_ambient_reach = 1.0f; // units of the scene

    static const TypeDescription& description();
};

} // namespace sunfleck::gi
