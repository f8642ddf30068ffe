// Everything about the lighting that a user can set, described once: the command line's --set, scene files and editors
// read the descriptions.
#pragma once

#include "engine/core/description.h"
#include "gi_module/visibility/test_grouping.h"

namespace sunfleck::gi {

// light_samples: the many-light system. brute_force: the same samples, each with its map at every pixel.
enum class DirectTechnique : std::uint32_t { light_samples, brute_force, none };
enum class IndirectTechnique : std::uint32_t { light_samples, brute_force, none };
enum class Sequence : std::uint32_t { pseudo_random, sobol };
enum class Termination : std::uint32_t { bounce_limit, russian_roulette };
// contribution: by the light that the map's movers shadow in the picture (many_light/map_contributions.h), times age;
// with brute force, which knows no such thing, flux_and_age: brightest channel times age, thesis sec. 4.5.3. age: in
// turns.
enum class MapPriority : std::uint32_t { contribution, flux_and_age, age };
// as_static: as static geometry, in random walks, too. transfer: complex ones by precomputed radiance transfer.
enum class MoverHandling : std::uint32_t { per_pixel, as_static, transfer };

struct Settings {
    DirectTechnique direct = DirectTechnique::light_samples;
    IndirectTechnique indirect = IndirectTechnique::light_samples;
    MoverHandling movers = MoverHandling::per_pixel;

    std::uint32_t lights = 300; // light samples, exactly
    float direct_share = 0.25f; // of the samples, for light from area emitters
    // Of the samples, for emitters that move or vary, if there are any; they divide it by flux.
    float dynamic_share = 0.15f;
    bool mover_paths = true;                // large boxes that move, as doors do, block the light that samples reflect
    std::uint32_t transfer_points = 4;      // along each side of a mover, where its light is known
    std::uint32_t transfer_reflections = 2; // of a mover's light onto itself
    std::uint32_t bounces = 5;              // reflections before the surface that is shown
    std::uint32_t seed = 1;
    Sequence sequence = Sequence::sobol;
    Termination termination = Termination::russian_roulette;

    // Reflected samples are chosen from so many times as many (light_sampling/sample_clusters.h); 1: as they come.
    std::uint32_t candidates = 64;
    float spread = 0.5f;

    std::uint32_t shadow_map_resolution = 256;
    std::uint32_t shadow_map_bits = 16;
    float shadow_memory = 512.0f; // MiB
    bool shadow_filter = false;
    bool shadows = true;
    float clamp_scale = 1.0f;
    bool count_clamped = false;

    // The many-light system; each part can be switched off, to see what it is worth.
    bool visibility = true;
    std::uint32_t patch_levels = 4;
    bool light_maps = true;
    bool baked_light = true;
    std::uint32_t low_resolution = 4;
    float repair_contrast = 0.3f;
    float repair_angle = 12.0f;
    bool static_maps = true;
    bool map_detail = true;
    std::uint32_t map_budget = 80; // shadow maps a frame
    float map_milliseconds = 0.0f; // GPU time for them; 0: map_budget counts
    MapPriority map_priority = MapPriority::contribution;
    TestGrouping visibility_tests = TestGrouping::clusters;
    bool count_passes = false;
    std::uint32_t lights_per_pass = 7;
    bool pass_extras = true;

    static const TypeDescription& description();
    // Defaults, with the baseline as the technique for all light.
    static Settings brute_force();
};

} // namespace sunfleck::gi
