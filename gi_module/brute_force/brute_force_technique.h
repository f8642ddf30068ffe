// The baseline as a technique of gi::System: `brute_force`.
#pragma once

#include "gi_module/brute_force/brute_force.h"
#include "gi_module/brute_force/brute_force_settings.h"
#include "gi_module/technique.h"

namespace sunfleck::gi {

class BruteForceTechnique final : public Technique {
public:
    static Result<std::unique_ptr<Technique>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    Status update(const SceneView& scene, Services& services, CellSet cells) override;
    Status add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) override;
    void report(Report& report) const override;
    std::optional<std::vector<LightShare>> explain(const PointQuestion& question) const override {
        return sample_shares(question);
    }

private:
    std::unique_ptr<BruteForce> kernel_;
    KernelShape standard_shape_; // the fastest known one on this device
    CellSet cells_;
    float unit_ = 1.0f; // m, of the space that flux is counted in
    std::size_t batches_ = 0;
};

} // namespace sunfleck::gi
