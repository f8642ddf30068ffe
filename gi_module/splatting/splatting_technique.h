// Splatted indirect light as a technique of gi::System: `splatting`.
#pragma once

#include "gi_module/splatting/splat_kernel.h"
#include "gi_module/splatting/splat_lights.h"
#include "gi_module/splatting/splat_occlusion.h"
#include "gi_module/technique.h"

namespace sunfleck::gi {

class SplattingTechnique final : public Technique {
public:
    static Result<std::unique_ptr<Technique>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    Status update(const SceneView& scene, Services& services, CellSet cells) override;
    Status add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) override;
    Status light_pixels(const PixelStage& stage, Services& services) override;
    void report(Report& report) const override;

    // Of the last frame.
    const SplatLights& lights() const { return lights_; }

private:
    void find_occlusion(const SceneView& scene, const SplattingSettings& settings, bool shadows);
    void show_texels(bool importance);

    std::unique_ptr<SplatKernel> kernel_;
    SplatLights lights_;
    std::vector<shared::PixelLightRow> rows_, view_rows_; // view_rows_: of a debug view, in place of the lights
    PixelLightMaps maps_;                                 // their shadow maps; none: they have none
};

} // namespace sunfleck::gi
