// Precomputed radiance transfer as a technique of gi::System: `prt`, for the movers that it supports.
#pragma once

#include "gi_module/technique.h"
#include "gi_module/transfer/transfer_lighting.h"
#include "gi_module/transfer/transfer_pass.h"
#include "gi_module/transfer/transfer_settings.h"

namespace sunfleck::gi {

class TransferTechnique final : public Technique {
public:
    static Result<std::unique_ptr<Technique>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    Status update(const SceneView& scene, Services& services, CellSet cells) override;
    Status add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) override;
    void report(Report& report) const override;

private:
    TransferLighting lighting_;
    std::unique_ptr<TransferPass> pass_;
    std::vector<shared::LightRow> owned_rows_;
};

} // namespace sunfleck::gi
