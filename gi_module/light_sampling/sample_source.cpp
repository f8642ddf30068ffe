#include "gi_module/light_sampling/sample_source.h"

#include "gi_module/light_sampling/light_sampler.h"

namespace sunfleck::gi {
namespace {

std::vector<LightSample> sample_by_random_walks(const std::vector<Emitter>& emitters, const SampleRequest& request,
                                                const raytrace::RayScene& rays,
                                                const std::function<bool(float)>& progress) {
    const SampleBudget budget = divide_samples(request, emitters);
    std::vector<LightSample> samples = sample_direct(emitters, budget.direct, request, rays);
    const std::vector<LightSample> indirect = sample_indirect(emitters, budget.indirect, request, rays, progress);
    samples.insert(samples.end(), indirect.begin(), indirect.end());
    return samples;
}

} // namespace

std::span<const SampleSource> sample_sources() {
    static const SampleSource sources[] = {
        {"random_walk",
         "Random walks from the emitters leave a sample at every reflection (instant radiosity, thesis sec. 4.1)",
         sample_by_random_walks},
    };
    return sources;
}

} // namespace sunfleck::gi
