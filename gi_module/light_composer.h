// Composes the light of all techniques of the plan into one picture: who writes it first, who shares the low-resolution
// sums, whose light is a layer that is added, and which receivers count.
#pragma once

#include "gi_module/technique.h"

namespace sunfleck::gi {

class LightComposer {
public:
    static Result<std::unique_ptr<LightComposer>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    // Adds the passes of all techniques that light something, so that `target.irradiance` holds the sum. With a view,
    // only its owner's.
    Status add_passes(gpu::FrameGraph& graph, std::span<const std::unique_ptr<Technique>> techniques,
                      const LightPlan& plan, Services& services, LightTarget target);

    // The frame recorded last was never submitted.
    void drop_last_counts() { low_resolution_->drop_last_counts(); }

    void report(Report& report) const { low_resolution_->report(report); }

private:
    // Techniques whose light comes out of one set of passes: those that light all receivers' pixels share the sums.
    struct Part {
        std::vector<std::size_t> techniques;
        std::uint32_t receivers = 0;
        bool adds_in_place = false;
        bool replaces = false; // its receivers are lit by nobody else
    };
    static std::vector<Part> parts_of(const LightPlan& plan, const DebugView* view);
    Status add_part(gpu::FrameGraph& graph, std::span<const std::unique_ptr<Technique>> techniques, const Part& part,
                    Services& services, LightTarget& target);

    Status add_specular(gpu::FrameGraph& graph, std::span<const std::unique_ptr<Technique>> techniques,
                        const LightPlan& plan, Services& services, LightTarget& target);

    std::unique_ptr<LowResolution> low_resolution_;
    std::unique_ptr<LightSum> light_sum_;
};

} // namespace sunfleck::gi
