#include "gi_module/shadows/shadow_settings.h"

namespace sunfleck::gi {

const TypeDescription& ShadowSettings::description() {
    using S = ShadowSettings;
    static const TypeDescription type{
        "ShadowSettings",
        1,
        "Shadow maps of light samples.",
        {SUNFLECK_FIELD(S, shadows, "", 0, 1, "Off: every sample lights through walls"),
         SUNFLECK_FIELD(S, shadow_map_resolution, "texels", 8, 2048, "Side of a map; more is sharper").multiple(2),
         SUNFLECK_FIELD(S, shadow_map_bits, "bits", 16, 32, "16 or 32 bits a texel").only({16, 32}),
         SUNFLECK_FIELD(S, shadow_memory, "MiB", 1, 65536,
                        "Limit of the maps' memory; with many samples, maps are smaller or share memory within the "
                        "frame"),
         SUNFLECK_FIELD(S, shadow_filter, "", 0, 1,
                        "Percentage-closer filtering over the four nearest texels: smooth edges; off is faster"),
         SUNFLECK_FIELD(S, static_maps, "", 0, 1, "Keeps the static geometry in shadow maps; only movers are redrawn"),
         SUNFLECK_FIELD(S, kept_maps, "", 0, 1,
                        "Redraws maps within map_budget and keeps their static part also where only brute_force reads "
                        "them; off: it has every affected map redrawn whole in each frame"),
         SUNFLECK_FIELD(S, map_detail, "", 0, 1,
                        "Draws movers into shadow maps with only as much detail as texels resolve"),
         SUNFLECK_FIELD(S, map_budget, "maps", 0, 65536,
                        "Maximum number of shadow maps redrawn in a frame because of movers; fewer is faster, but "
                        "shadows lag behind"),
         SUNFLECK_FIELD(S, map_milliseconds, "ms", 0, 1000,
                        "GPU time for redrawing maps in a frame, in place of their number; for interactive use, since "
                        "pictures then depend on the machine; 0: map_budget applies"),
         SUNFLECK_CHOICE(S, map_priority, "Which stale shadow maps are redrawn first", "contribution", "flux_and_age",
                         "age")}};
    return type;
}

} // namespace sunfleck::gi
