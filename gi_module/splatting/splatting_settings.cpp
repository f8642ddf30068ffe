#include "gi_module/splatting/splatting_settings.h"

namespace sunfleck::gi {

const TypeDescription& SplattingSettings::description() {
    using S = SplattingSettings;
    static const TypeDescription type{
        "SplattingSettings",
        1,
        "Splatted indirect light.",
        {SUNFLECK_CHOICE(S, splat_lights,
                         "Whose first bounce is splatted: nobody's; that of emitters that move or vary and of what "
                         "movers reflect (first_bounce.dynamic in the plan); or everybody's",
                         "none", "moving", "all"),
         SUNFLECK_FIELD(S, splats, "", 0, 65536, "Pixel lights of all emitters together; more is smoother and slower"),
         SUNFLECK_FIELD(
             S, glossy_splats, "", 0, 65536,
             "Pixel lights beside those for what glossy surfaces reflect in a lobe about the mirror direction, "
             "such as caustics; 0: they reflect diffusely"),
         SUNFLECK_FIELD(S, splat_footprints, "", 0, 1,
                        "Glossy pixel lights have the shape of the beam that their piece of surface reflects, so that "
                        "caustics have no spots; off: round lobes about the mirror direction"),
         SUNFLECK_CHOICE(S, splat_refraction,
                         "Glossy pixel lights where light leaves smooth glass: nowhere; refracted once, where it "
                         "leaves a body; or by every surface on its way, also total reflections within. Without "
                         "glossy_splats there are none",
                         "off", "single", "traced"),
         SUNFLECK_FIELD(S, splat_rays, "rays", 16, 1048576,
                        "Texels of all reflective shadow maps together, each a ray"),
         SUNFLECK_CHOICE(S, splat_pattern,
                         "Where pixel lights are: on surfaces, where they stay while their emitter moves, each with "
                         "the light of the texels around it; or in a pattern that is fixed in the emitter's view, "
                         "which flickers more. Glossy ones are always in a pattern",
                         "followed", "fixed"),
         SUNFLECK_CHOICE(S, splat_importance,
                         "What decides where pixel lights are: chance, reflected flux, or what that does for the "
                         "picture: of the light at some points that the camera sees, how much is theirs",
                         "none", "flux", "contribution"),
         SUNFLECK_CHOICE(S, splat_warp,
                         "Importance warping: with rows weighed on their own, or all alike, which is faster", "a", "b"),
         SUNFLECK_FIELD(S, splat_warp_levels, "levels", 0, 10,
                        "Levels of the importance warping, at most those of the map"),
         SUNFLECK_FIELD(S, splat_cutoff, "", 0, 1,
                        "A pixel light ends where its irradiance falls below this share of the mean irradiance of all "
                        "pixel lights together on the scene's surface; 0: nowhere"),
         SUNFLECK_FIELD(S, splat_lists, "", 0, 1,
                        "Each group of pixels has a list of the pixel lights that may reach it; off: each pixel gets "
                        "the light of all, for comparison"),
         SUNFLECK_FIELD(
             S, splat_levels, "", 0, 1,
             "Multiresolution: the light of those that are far from a flat piece of the picture is evaluated "
             "at eight places of it and interpolated in between. Needs the lists"),
         SUNFLECK_CHOICE(S, splat_occlusion,
                         "What blocks the light of pixel lights: nothing; what is near them, as a factor (ambient "
                         "occlusion); or all that a shadow map of each shows, movers included",
                         "none", "ambient", "maps"),
         SUNFLECK_FIELD(S, splat_map_side, "texels", 4, 128,
                        "Side of the shadow map of a pixel light, each texel a ray")
             .only({4, 8, 16, 32, 64, 128}),
         SUNFLECK_FIELD(S, splat_map_filter, "", 0, 1, "Blends the four nearest texels of those maps"),
         SUNFLECK_FIELD(S, splat_ambient_reach, "", 0.01, 1000,
                        "How far ambient occlusion looks, in units of the scene, of which a room is a few wide")}};
    return type;
}

} // namespace sunfleck::gi
