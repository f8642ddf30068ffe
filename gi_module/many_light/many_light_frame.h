// What the passes of one frame of the many-light system share.
#pragma once

#include "gi_module/many_light/many_light.h"

namespace sunfleck::gi {

struct ManyLight::Frame {
    gpu::FrameGraph& graph;
    const GBufferInput& g_buffer;
    const gpu::UploadSlice& camera;
    const ShadowMaps& maps;
    const ManyLightOptions& options;
    gpu::ResourceId output;
    shared::ManyLightConstants constants;
    bool baked = false;          // baked light is used
    bool through_buffer = false; // the reconstructed picture is written to a buffer, and copied

    // Light maps, and baked light, hold surface samples that stay.
    bool is_held(const LightBatch& batch) const {
        return options.light_maps && options.visibility && batch.light_class == shared::light_class_surface &&
               !batch.dynamic;
    }
};

inline std::uint32_t divide_up(std::uint32_t value, std::uint32_t by) {
    return (value + by - 1) / by;
}

} // namespace sunfleck::gi
