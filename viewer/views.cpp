#include "viewer/views.h"

namespace sunfleck::viewer {

std::span<const PictureView> picture_views() {
    static constexpr PictureView views[] = {
        {"final", shared::view_final, "The picture: light on surfaces, exposed and tone-mapped", "", ""},
        {"irradiance", shared::view_irradiance, "Light that arrives at surfaces, without their colours", "irradiance",
         "W/m2"},
        {"normals", shared::view_normals, "Which way surfaces face", "red, green, blue: along x, y, z; grey: across",
         ""},
        {"albedo", shared::view_albedo, "How much light surfaces reflect", "reflectance", ""},
        {"depth", shared::view_depth, "How far surfaces are, as the depth buffer holds it",
         "the near distance, 1 cm, over the distance", ""},
        {"surfaces", shared::view_surfaces, "Which surface is which", "a colour for each", ""},
        {"motion", shared::view_motion, "How surfaces move in the picture", "grey: not; red, green: to the right, down",
         ""}};
    return views;
}

std::uint32_t picture_view_of(const gi::DebugView& view) {
    return view.unit == "W/m2" ? shared::view_irradiance : shared::view_false_colours;
}

} // namespace sunfleck::viewer
