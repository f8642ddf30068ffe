#include "gi_module/many_light/many_light_settings.h"

namespace sunfleck::gi {

const TypeDescription& ManyLightSettings::description() {
    using S = ManyLightSettings;
    static const TypeDescription type{
        "ManyLightSettings",
        1,
        "The many-light system.",
        {SUNFLECK_FIELD(S, visibility, "", 0, 1,
                        "Shadow tests only where the visibility database says that something may be in the way"),
         SUNFLECK_FIELD(S, light_maps, "", 0, 1,
                        "Keeps unshadowed light in light maps; only what is blocked is evaluated by pixel"),
         SUNFLECK_FIELD(S, baked_light, "", 0, 1,
                        "Keeps light with the shadows of static geometry where it is smooth; there only the shadows of "
                        "movers are evaluated by pixel"),
         SUNFLECK_FIELD(S, count_passes, "", 0, 1,
                        "Counts the render passes that a renderer with a few lights a pass would need, before and "
                        "after merging them (thesis sec. 4.3.5)"),
         SUNFLECK_FIELD(S, lights_per_pass, "", 1, 64, "Lights of such a pass"),
         SUNFLECK_FIELD(S, pass_extras, "", 0, 1,
                        "Such passes may test lights that an object does not need, where that changes nothing")}};
    return type;
}

} // namespace sunfleck::gi
