#include "viewer/picture_settings.h"

namespace sunfleck::viewer {

const TypeDescription& PictureSettings::description() {
    using S = PictureSettings;
    static const TypeDescription type{
        "PictureSettings",
        1,
        "How light becomes a picture.",
        {SUNFLECK_FIELD(S, antialiasing, "", 0, 1, "Smooths stairs along edges; off is a little faster"),
         SUNFLECK_FIELD(S, glare, "", 0, 0.5,
                        "Share of the light of lamps and sky that the lens scatters around them; 0: none")}};
    return type;
}

} // namespace sunfleck::viewer
