#include "gi_module/transport/light_sample.h"

namespace sunfleck::gi {

const TypeDescription& LightSample::description() {
    static const TypeDescription type{
        "LightSample",
        1,
        "A virtual point light, made by the GI module.",
        {SUNFLECK_CHOICE(LightSample, kind, "How it radiates", "surface", "point", "spot", "directional"),
         SUNFLECK_FIELD(LightSample, position, "m", -1e6, 1e6, "World position"),
         SUNFLECK_FIELD(LightSample, normal, "", -1, 1, "Axis of radiation"),
         SUNFLECK_FIELD(LightSample, flux, "W", 0, unbounded, "Share of the flux that it carries"),
         SUNFLECK_FIELD(LightSample, bounce, "", 0, 1000, "Reflections so far"),
         SUNFLECK_FIELD(LightSample, cone_scale, "", -1e6, 1e6, "Spot cone: slope of the falloff"),
         SUNFLECK_FIELD(LightSample, cone_offset, "", -1e6, 1e6, "Spot cone: offset of the falloff"),
         SUNFLECK_FIELD(LightSample, radius, "m", 0, 1e6,
                        "Of the disc of surface that it represents; 0: the same for all samples"),
         SUNFLECK_FIELD(LightSample, index, "", 0, 4294967295.0, "Stable number"),
         SUNFLECK_FIELD(LightSample, emitter, "", 0, 0, "Entity that emits its light"),
         SUNFLECK_FIELD(LightSample, path_vertex_count, "", 0, 6, "Stored vertices of the light's path"),
         SUNFLECK_FIELD(LightSample, punctual, "", 0, 1, "All light of a sun, point light or spot"),
         SUNFLECK_FIELD(LightSample, dynamic, "", 0, 1, "Its emitter moves or varies")}};
    return type;
}

} // namespace sunfleck::gi
