// Values that random hosts give each setting: cheap ones, all of which but one pair fit together.
#pragma once

#include "gi_module/settings.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <string_view>

namespace sunfleck::tests {

struct SettingValues {
    std::string_view name;
    std::array<const char*, 3> values; // the first is that of a fresh context which describe_room has described
};

inline constexpr SettingValues host_settings[] = {
    {"punctual", {"automatic", "adaptive_shadows", "none"}},
    {"direct", {"light_samples", "brute_force", "none"}},
    {"indirect", {"light_samples", "brute_force", "none"}},
    {"specular", {"none", "gloss", "none"}},
    {"movers", {"per_pixel", "static", "prt"}},
    {"plan", {"", "first_bounce.dynamic=none", "direct.fixed=brute_force"}},
    {"source", {"random_walk", "random_walk", "random_walk"}},
    {"lights", {"16", "8", "1"}},
    {"baked_samples", {"0", "40", "2"}},
    {"direct_share", {"0.25", "0", "1"}},
    {"dynamic_share", {"0.15", "0", "1"}},
    {"mover_share", {"0", "0.3", "1"}},
    {"punctual_lights", {"8", "0", "2"}},
    {"bounces", {"5", "0", "1"}},
    {"seed", {"1", "2", "4294967295"}},
    {"sequence", {"sobol", "pseudo_random", "sobol"}},
    {"termination", {"russian_roulette", "bounce_limit", "russian_roulette"}},
    {"candidates", {"64", "1", "4"}},
    {"spread", {"0.5", "0", "1"}},
    {"sampled_light", {"used", "all", "used"}},
    {"mover_paths", {"true", "false", "true"}},
    {"clamp_scale", {"1", "0.001", "1000000"}},
    {"shadows", {"true", "false", "true"}},
    {"shadow_map_resolution", {"32", "64", "8"}},
    {"shadow_map_bits", {"16", "32", "16"}},
    {"shadow_memory", {"512", "64", "512"}},
    {"shadow_filter", {"false", "true", "false"}},
    {"static_maps", {"true", "false", "true"}},
    {"kept_maps", {"false", "true", "false"}},
    {"map_detail", {"true", "false", "true"}},
    {"map_budget", {"80", "1", "0"}},
    {"map_milliseconds", {"0", "1", "0"}},
    {"map_priority", {"contribution", "flux_and_age", "age"}},
    {"patch_levels", {"4", "0", "2"}},
    {"visibility_tests", {"clusters", "trees", "pairs"}},
    {"low_resolution", {"4", "1", "8"}},
    {"repair_contrast", {"0.3", "0", "1"}},
    {"repair_angle", {"12", "0.1", "90"}},
    {"repair_contacts", {"true", "false", "true"}},
    {"visibility", {"true", "false", "true"}},
    {"light_maps", {"true", "false", "true"}},
    {"baked_light", {"true", "false", "true"}},
    {"count_passes", {"false", "true", "false"}},
    {"lights_per_pass", {"7", "1", "64"}},
    {"pass_extras", {"true", "false", "true"}},
    {"count_clamped", {"false", "true", "false"}},
    {"kernel_pixels", {"0", "1", "16"}},
    {"kernel_lights", {"standard", "uniform", "storage"}},
    {"kernel_maps", {"standard", "texel", "storage"}},
    {"transfer_points", {"4", "1", "2"}},
    {"transfer_reflections", {"2", "0", "1"}},
    {"shadow_detail", {"1", "0.05", "4"}},
    {"shadow_tile_memory", {"128", "8", "32"}},
    {"moving_light_tiles", {"4", "1", "16"}},
    {"splat_lights", {"none", "moving", "all"}},
    {"splats", {"256", "0", "16"}},
    {"glossy_splats", {"0", "16", "1"}},
    {"splat_footprints", {"true", "false", "true"}},
    {"splat_refraction", {"traced", "single", "off"}},
    {"splat_rays", {"4096", "16", "256"}},
    {"splat_pattern", {"followed", "fixed", "followed"}},
    {"splat_importance", {"flux", "none", "contribution"}},
    {"splat_warp", {"a", "b", "a"}},
    {"splat_warp_levels", {"6", "0", "10"}},
    {"splat_cutoff", {"0", "0.01", "1"}},
    {"splat_lists", {"true", "false", "true"}},
    {"splat_levels", {"false", "true", "false"}},
    {"splat_occlusion", {"maps", "none", "ambient"}},
    {"splat_map_side", {"32", "4", "8"}},
    {"splat_map_filter", {"true", "false", "true"}},
    {"splat_ambient_reach", {"1", "0.01", "1000"}},
    {"gather_lights", {"none", "moving", "all"}},
    {"gather_samples", {"256", "1", "16"}},
    {"gather_rays", {"4096", "16", "256"}},
    {"gather_radius", {"0.7072", "0.01", "0.1"}},
    {"gather_softening", {"false", "true", "false"}},
    {"gloss_samples", {"0", "1", "100"}},
    {"sensor_rays", {"2048", "1", "100"}},
    {"sensors", {"all", "direct", "all"}},
};

// Transferred radiance is the only light of the movers that it supports, so that no other technique may be told to
// light them, too.
inline bool contradict(std::string_view movers, std::string_view plan) {
    return movers == "prt" && plan == "direct.fixed=brute_force";
}

inline std::string_view initial_value(std::string_view name) {
    const auto* found = std::find_if(std::begin(host_settings), std::end(host_settings),
                                     [name](const SettingValues& known) { return known.name == name; });
    return found->values[0];
}

// Settings that the list above forgets.
inline std::string forgotten_settings() {
    std::string names;
    for (const std::string_view name : gi::Settings::names())
        if (std::none_of(std::begin(host_settings), std::end(host_settings),
                         [&](const SettingValues& known) { return known.name == name; }))
            names += std::string(name) + " ";
    return names;
}

} // namespace sunfleck::tests
