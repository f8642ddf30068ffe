#include "gi_module/settings.h"

namespace sunfleck::gi {

const TypeDescription& Settings::description() {
    static const TypeDescription type{
        "Settings",
        1,
        "Lighting by light samples.",
        {SUNFLECK_CHOICE(Settings, direct, "Technique for light straight from emitters", "brute_force", "none"),
         SUNFLECK_CHOICE(Settings, indirect, "Technique for light that was reflected", "brute_force", "none"),
         SUNFLECK_CHOICE(Settings, movers, "Movers are lit like all else, or also reflect light like static geometry",
                         "per_pixel", "static"),
         SUNFLECK_FIELD(Settings, lights, "", 0, 65536, "Number of light samples; more is smoother and slower"),
         SUNFLECK_FIELD(Settings, direct_share, "", 0, 1, "Share of the samples that lie on emitters"),
         SUNFLECK_FIELD(Settings, bounces, "", 0, 64, "How often light is reflected at most; 0 is direct light only"),
         SUNFLECK_FIELD(Settings, seed, "", 0, 4294967295.0, "Another seed is another set of samples"),
         SUNFLECK_CHOICE(Settings, sequence, "Random numbers of the samples; sobol is smoother at equal count",
                         "pseudo_random", "sobol"),
         SUNFLECK_CHOICE(Settings, termination,
                         "Walks end at the bounce limit only, or also at random with equally strong samples",
                         "bounce_limit", "russian_roulette"),
         SUNFLECK_FIELD(Settings, shadow_map_resolution, "texels", 8, 2048, "Side of a map; more is sharper"),
         SUNFLECK_FIELD(Settings, shadow_map_bits, "bits", 16, 32, "16 or 32 bits a texel"),
         SUNFLECK_FIELD(Settings, shadow_memory, "MiB", 1, 65536,
                        "Bound of the maps' memory; with more samples, maps share slots within the frame"),
         SUNFLECK_FIELD(Settings, shadow_filter, "", 0, 1, "Blends the four nearest texels' answers"),
         SUNFLECK_FIELD(Settings, shadows, "", 0, 1, "Off: every sample lights through walls"),
         SUNFLECK_FIELD(Settings, clamp_scale, "", 0.001, 1e6,
                        "Scales the bound of the geometry term; more is brighter in corners and blotchier"),
         SUNFLECK_FIELD(Settings, count_clamped, "", 0, 1, "Measures the light that the bound removes")}};
    return type;
}

} // namespace sunfleck::gi
