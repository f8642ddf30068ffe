#include "gi_module/low_resolution/low_resolution_settings.h"

namespace sunfleck::gi {

const TypeDescription& LowResolutionSettings::description() {
    using S = LowResolutionSettings;
    static const TypeDescription type{
        "LowResolutionSettings",
        1,
        "Lighting at low resolution, and its repair (thesis sec. 4.3.3).",
        {SUNFLECK_FIELD(S, low_resolution, "pixels", 1, 8,
                        "Light is evaluated once for so many pixels in each direction; 1 is every pixel")
             .only({1, 2, 4, 8}),
         SUNFLECK_FIELD(S, repair_contrast, "", 0, 1,
                        "Pixels whose low-resolution neighbours differ by more than this share are lit at full "
                        "resolution"),
         SUNFLECK_FIELD(S, repair_angle, "degrees", 0.1, 90,
                        "Pixels whose normals differ by more from all neighbours are lit at full resolution"),
         SUNFLECK_FIELD(S, repair_contacts, "", 0, 1,
                        "Pixels of a surface just behind another one's edge are lit at full resolution: narrow shadows "
                        "under a shelf, beside a frame")}};
    return type;
}

} // namespace sunfleck::gi
