// The many-light system as a technique of gi::System: `light_samples`.
#pragma once

#include "gi_module/charts/curved_charts.h"
#include "gi_module/many_light/many_light.h"
#include "gi_module/many_light/many_light_settings.h"
#include "gi_module/many_light/pass_counter.h"
#include "gi_module/technique.h"

namespace sunfleck::gi {

class ManyLightTechnique final : public Technique {
public:
    static Result<std::unique_ptr<Technique>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    Status update(const SceneView& scene, Services& services, CellSet cells) override;
    Status add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) override;
    Status light_pixels(const PixelStage& stage, Services& services) override;
    void report(Report& report) const override;
    std::optional<std::vector<LightShare>> explain(const PointQuestion& question) const override {
        return sample_shares(question);
    }

    const ManyLight& lighting() const { return *lighting_; }
    const CurvedCharts& curved_charts() const { return curved_charts_; }

private:
    ManyLightOptions options_of(const Services& services, const scene::GpuScene& gpu_scene) const;
    void find_static_maps(const Services& services, ManyLightOptions& options) const;

    std::unique_ptr<ManyLight> lighting_;
    CurvedCharts curved_charts_;          // of the database's static geometry, while light is baked
    std::uint64_t curved_generation_ = 0; // of the database that they were found for
    CellSet cells_;
    std::vector<shared::LightRow> owned_rows_;
    ManyLightOptions options_;
    std::size_t batches_ = 0;
    PassCounter passes_;
};

} // namespace sunfleck::gi
