#include "gi_module/rsm_gather/rsm_gather_settings.h"

namespace sunfleck::gi {

const TypeDescription& RsmGatherSettings::description() {
    using S = RsmGatherSettings;
    static const TypeDescription type{
        "RsmGatherSettings",
        1,
        "Light that is gathered from reflective shadow maps, unshadowed: the baseline of splatting.",
        {SUNFLECK_CHOICE(S, gather_lights,
                         "Whose first bounce is gathered: nobody's; that of emitters that move or vary and of what "
                         "movers reflect (first_bounce.dynamic in the plan); or everybody's",
                         "none", "moving", "all"),
         SUNFLECK_FIELD(S, gather_samples, "", 1, 65536,
                        "Texels that a pixel looks up in all reflective shadow maps together, at least one in each; as "
                        "many as there are: each texel once"),
         SUNFLECK_FIELD(S, gather_rays, "rays", 16, 65536, "Texels of all reflective shadow maps together, each a ray"),
         SUNFLECK_FIELD(S, gather_radius, "", 0.01, 0.7072,
                        "How far from where the pixel lies in a map it is looked up, as a share of the map's side; "
                        "light from farther away is missing, and at 0.7072 there is none"),
         SUNFLECK_FIELD(S, gather_softening, "", 0, 1,
                        "A texel that stands for others, too, is softened as a light as wide as they are: less noise, "
                        "but light near a surface's edges is too even")}};
    return type;
}

} // namespace sunfleck::gi
