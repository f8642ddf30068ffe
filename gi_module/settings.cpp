#include "gi_module/settings.h"

namespace sunfleck::gi {

const TypeDescription& Settings::description() {
    static const TypeDescription type{
        "Settings",
        1,
        "Lighting by light samples.",
        {SUNFLECK_CHOICE(Settings, direct, "Technique for light straight from emitters", "light_samples", "brute_force",
                         "none"),
         SUNFLECK_CHOICE(Settings, indirect, "Technique for light that was reflected", "light_samples", "brute_force",
                         "none"),
         SUNFLECK_CHOICE(Settings, movers,
                         "Movers are lit like all else; or also reflect light like static geometry; or, complex ones, "
                         "by precomputed radiance transfer",
                         "per_pixel", "static", "prt"),
         SUNFLECK_FIELD(Settings, lights, "", 0, 65536, "Number of light samples; more is smoother and slower"),
         SUNFLECK_FIELD(Settings, direct_share, "", 0, 1, "Share of the samples that lie on emitters"),
         SUNFLECK_FIELD(Settings, dynamic_share, "", 0, 1,
                        "Share of the samples for emitters that move or vary, where there are any"),
         SUNFLECK_FIELD(Settings, mover_paths, "", 0, 1,
                        "Doors and other large boxes that move block the light that samples reflect"),
         SUNFLECK_FIELD(Settings, transfer_points, "", 1, 6,
                        "With movers prt: points along each side of a mover where its light is known; more for "
                        "sharper shadows on it"),
         SUNFLECK_FIELD(Settings, transfer_reflections, "", 0, 2,
                        "With movers prt: how often a mover reflects light onto itself"),
         SUNFLECK_FIELD(Settings, bounces, "", 0, 64, "How often light is reflected at most; 0 is direct light only"),
         SUNFLECK_FIELD(Settings, seed, "", 0, 4294967295.0, "Another seed is another set of samples"),
         SUNFLECK_CHOICE(Settings, sequence, "Random numbers of the samples; sobol is smoother at equal count",
                         "pseudo_random", "sobol"),
         SUNFLECK_CHOICE(Settings, termination,
                         "Walks end at the bounce limit only, or also at random with equally strong samples",
                         "bounce_limit", "russian_roulette"),
         SUNFLECK_FIELD(
             Settings, candidates, "", 1, 1024,
             "Reflected samples are made from so many times as many, like ones joined; 1: as walks leave them"),
         SUNFLECK_FIELD(Settings, spread, "", 0, 1,
                        "Where like samples are kept apart: 0 where most flux is, 1 where most surface is"),
         SUNFLECK_FIELD(Settings, shadow_map_resolution, "texels", 8, 2048, "Side of a map; more is sharper"),
         SUNFLECK_FIELD(Settings, shadow_map_bits, "bits", 16, 32, "16 or 32 bits a texel"),
         SUNFLECK_FIELD(Settings, shadow_memory, "MiB", 1, 65536,
                        "Bound of the maps' memory; with more samples, maps share slots within the frame"),
         SUNFLECK_FIELD(Settings, shadow_filter, "", 0, 1,
                        "Blends the four nearest texels' answers: edges without steps; off is faster"),
         SUNFLECK_FIELD(Settings, shadows, "", 0, 1, "Off: every sample lights through walls"),
         SUNFLECK_FIELD(Settings, clamp_scale, "", 0.001, 1e6,
                        "Scales the bound of the geometry term; more is brighter in corners and blotchier"),
         SUNFLECK_FIELD(Settings, count_clamped, "", 0, 1,
                        "Measures the light that the bound removes (brute force only)"),
         SUNFLECK_FIELD(Settings, visibility, "", 0, 1,
                        "Shadow tests only where the visibility database says that something may be in the way"),
         SUNFLECK_FIELD(Settings, patch_levels, "", 0, 6, "How often patches of surfaces are divided at most"),
         SUNFLECK_FIELD(Settings, light_maps, "", 0, 1,
                        "Unshadowed light is kept in light maps; only what is blocked is evaluated by pixel"),
         SUNFLECK_FIELD(Settings, baked_light, "", 0, 1,
                        "Light that static geometry lets pass is kept where it is smooth; there only the shadows of "
                        "movers are evaluated by pixel"),
         SUNFLECK_FIELD(Settings, low_resolution, "pixels", 1, 8,
                        "Light is evaluated once for so many pixels in each direction: 1 (all), 2, 4 or 8"),
         SUNFLECK_FIELD(Settings, repair_contrast, "", 0, 1,
                        "Pixels whose low-resolution neighbours differ by more than this share are lit again"),
         SUNFLECK_FIELD(Settings, repair_angle, "degrees", 0.1, 90,
                        "Pixels whose normals differ by more from all neighbours are lit again"),
         SUNFLECK_FIELD(Settings, static_maps, "", 0, 1,
                        "Static geometry's part of shadow maps is kept; only movers are redrawn"),
         SUNFLECK_FIELD(Settings, map_detail, "", 0, 1,
                        "Movers are drawn into shadow maps with as much detail as a texel shows"),
         SUNFLECK_FIELD(
             Settings, map_budget, "maps", 0, 65536,
             "Shadow maps that movers changed, redrawn in a frame at most; fewer is faster, and shadows lag behind"),
         SUNFLECK_FIELD(Settings, map_milliseconds, "ms", 0, 1000,
                        "GPU time for such maps in a frame, in place of their number; for interactive use, since the "
                        "picture then depends on the machine; 0: their number"),
         SUNFLECK_CHOICE(Settings, map_priority, "Which stale shadow maps are redrawn first", "contribution",
                         "flux_and_age", "age"),
         SUNFLECK_CHOICE(Settings, visibility_tests,
                         "Visibility tests of what moves: of clusters of samples and a hierarchy of nodes, down the "
                         "trees of nodes by each sample, or of every pair by itself; all find the same",
                         "clusters", "trees", "pairs"),
         SUNFLECK_FIELD(
             Settings, count_passes, "", 0, 1,
             "Counts the render passes that a renderer with a few lights a pass would need, before and after "
             "merging them"),
         SUNFLECK_FIELD(Settings, lights_per_pass, "", 1, 64, "Lights of such a pass"),
         SUNFLECK_FIELD(Settings, pass_extras, "", 0, 1,
                        "Such passes may test lights that an object does not need, where that changes nothing")}};
    return type;
}

Settings Settings::brute_force() {
    Settings settings;
    settings.direct = DirectTechnique::brute_force;
    settings.indirect = IndirectTechnique::brute_force;
    return settings;
}

} // namespace sunfleck::gi
