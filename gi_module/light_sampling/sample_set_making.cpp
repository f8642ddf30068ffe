// How a SampleSet generates all of its samples.
#include "gi_module/light_sampling/sample_set.h"

#include "engine/core/progress_part.h"
#include "engine/core/random.h"
#include "gi_module/light_sampling/sample_source.h"
#include "gi_module/transport/light_plan.h"

#include <algorithm>
#include <atomic>
#include <tuple>

namespace sunfleck::gi {
namespace {

std::uint64_t next_generation() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

// Samples for dynamic emitters: their share, but at least two each. `others`: there are static ones, too.
std::uint32_t dynamic_share(const SampleRequest& request, std::size_t dynamic_emitters, bool others) {
    if (dynamic_emitters == 0 || request.lights == 0)
        return 0;
    if (!others)
        return request.lights;
    const std::uint32_t share = std::uint32_t(float(request.lights) * request.dynamic_share);
    return std::min(request.lights, std::max(share, 2 * std::uint32_t(dynamic_emitters)));
}

} // namespace

Status SampleSet::make_samples(const SampleRequest& request, const SceneView& scene, const Cause& cause,
                               const std::function<bool(float)>& progress) {
    const raytrace::RayScene& rays = scene.rays;
    const std::uint32_t on_movers =
        cause.movers_reflect ? std::uint32_t(float(request.lights) * request.mover_share) : 0;
    followed_.movers.reset(scene.changes, scene.meshes, rays, on_movers, request);
    followed_.let_through.clear();
    SampleRequest fixed = request; // for static emitters: what the others leave
    fixed.lights -= std::min(request.lights, std::uint32_t(followed_.movers.samples().size()));
    const std::uint32_t moving = dynamic_share(fixed, dynamic_emitters_.size(), !emitters_.empty());
    followed_.lights.reset(moving > 0 ? dynamic_emitters_ : std::vector<Emitter>(), moving, request, rays);
    fixed.lights -= std::min(fixed.lights, std::uint32_t(followed_.lights.samples().size()));
    bool stopped = false;
    const auto watched = [&](float done) {
        stopped = stopped || !progress(done);
        return !stopped;
    };
    const auto make = [&](const SampleRequest& wanted, float begin, float end) {
        const std::function<bool(float)> whole = progress ? watched : std::function<bool(float)>();
        return sample_sources()[request.source].make(emitters_, wanted, rays, progress_part(whole, begin, end));
    };
    SampleRequest many = fixed;
    many.lights = request.baked_samples;
    many.seed = hash_combine(request.seed, 0xba4ed); // others
    const float share = float(fixed.lights) / float(std::max(fixed.lights + many.lights, 1u));
    std::vector<LightSample> made = make(fixed, 0.0f, share);
    std::vector<LightSample> refining;
    if (many.lights > 0 && !stopped)
        refining = make(many, share, 1.0f);
    if (stopped)
        return Error{"preparing the light samples was stopped", ErrorCode::stopped};
    samples_ = std::move(made);
    refining_ = std::move(refining);
    for (const auto* dynamic : {&followed_.lights.samples(), &followed_.movers.samples()})
        samples_.insert(samples_.end(), dynamic->begin(), dynamic->end());
    sort_samples();
    generation_ = next_generation();
    return {};
}

void SampleSet::sort_samples() {
    // By all that decides which technique lights a sample, so that a technique's samples are few, long runs.
    const auto key = [](const LightSample& sample) {
        return std::tuple(light_class(sample.kind), sample.dynamic, path_part(sample.bounce, sample.punctual));
    };
    std::stable_sort(samples_.begin(), samples_.end(),
                     [&](const LightSample& a, const LightSample& b) { return key(a) < key(b); });
    // Within a class, dynamic samples keep their order.
    std::vector<LightSample> dynamic = followed_.lights.samples();
    dynamic.insert(dynamic.end(), followed_.movers.samples().begin(), followed_.movers.samples().end());
    std::vector<std::uint32_t> order(dynamic.size());
    for (std::uint32_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return key(dynamic[a]) < key(dynamic[b]); });
    dynamic_samples_.assign(dynamic.size(), 0);
    for (std::uint32_t i = 0, next = 0; i < samples_.size(); ++i) {
        samples_[i].index = i;
        if (samples_[i].dynamic)
            dynamic_samples_[order[next++]] = i;
    }
}

} // namespace sunfleck::gi
