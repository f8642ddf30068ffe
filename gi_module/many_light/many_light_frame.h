// What the passes of one stage of the many-light system share.
#pragma once

#include "gi_module/many_light/many_light.h"

namespace sunfleck::gi {

struct ManyLight::Frame {
    const PixelStage& stage;
    const ManyLightOptions& options;
    const ShadowMaps& maps;
    shared::ManyLightConstants constants;
    bool baked = false;   // baked light is used
    bool refined = false; // and refined

    // Light maps, and baked light, hold surface samples that stay.
    bool is_held(const LightBatch& batch) const {
        return options.light_maps && options.visibility && batch.light_class == shared::light_class_surface &&
               !batch.dynamic;
    }
    // What a pass is called in timings and captures.
    std::string pass_name(const char* low_resolution, const char* repair, Phase phase = Phase::plain) const {
        const char* const suffix = phase == Phase::rough ? " (rough)" : phase == Phase::baked ? " (baked)" : "";
        return std::string(stage.repair ? repair : low_resolution) + suffix;
    }
};

} // namespace sunfleck::gi
