#include "gi_module/light_sampling/sample_set.h"

#include "engine/core/hash.h"
#include "engine/core/jobs.h"
#include "gi_module/light_sampling/clamping_loss.h"
#include "gi_module/transport/clamping.h"
#include "gi_module/transport/light_plan.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

// Of everything about the emitters that samples depend on.
std::uint64_t hash_emitters(const std::vector<Emitter>& emitters) {
    std::uint64_t hash = hash_start;
    const auto add = [&](const void* data, std::size_t size) { hash = hash_bytes(hash, data, size); };
    for (const Emitter& emitter : emitters) {
        add(&emitter.kind, sizeof emitter.kind);
        add(&emitter.entity, sizeof emitter.entity);
        add(&emitter.matrix, sizeof emitter.matrix);
        add(&emitter.flux, sizeof emitter.flux);
        add(&emitter.area, sizeof emitter.area);
        add(&emitter.punctual, sizeof emitter.punctual);
        add(&emitter.inner_cosine, sizeof emitter.inner_cosine);
        add(&emitter.outer_cosine, sizeof emitter.outer_cosine);
        const auto image = reinterpret_cast<std::uintptr_t>(emitter.map.image.get());
        add(&image, sizeof image);
        add(&emitter.map.rotation, sizeof emitter.map.rotation);
    }
    return hash;
}

// Whether samples are made for light that movers reflect.
bool wants_movers(const SampleRequest& request, const scene::SceneChanges& changes) {
    if (!request.indirect || request.bounces == 0 || request.movers_are_static || !(request.mover_share > 0.0f))
        return false;
    return !MoverReflections::reflecting(changes).empty();
}

constexpr std::size_t loss_rays = 64;     // by which the loss of a single sample is estimated
constexpr float least_let_through = 0.5f; // less is not given back in full: the sample stands in a corner

// What `bound` lets through of a sample's light; 1 for those on movers, which have discs of their own.
float let_through_of(const LightSample& sample, float bound, const raytrace::RayScene& rays) {
    if (sample.on_mover || sample.bounce == 0)
        return 1.0f;
    return std::max(1.0f - clamping_loss_of(sample, bound, loss_rays, rays), least_let_through);
}

constexpr Counter light_samples{"light_samples", "samples", "light samples", "Light samples (VPLs) in all"};
constexpr Counter direct_samples{"light_samples_direct", "samples", "light samples",
                                 "Light samples that lie on emitters: direct light"};
constexpr Counter dynamic_samples{"light_samples_dynamic", "samples", "light samples",
                                  "Light samples of emitters that move or vary"};
constexpr Counter moved_samples{"light_samples_moved", "samples", "light samples",
                                "Light samples whose position or direction changed in this frame"};
constexpr Counter late_samples{"light_samples_behind", "samples", "light samples",
                               "Light samples of what movers reflect that are not yet where they would be if the "
                               "movers had always been where they are"};
constexpr Counter blocked_samples{
    "light_samples_blocked", "samples", "light samples",
    "Reflected samples that are dark because a door or the like blocks the path of their light"};
constexpr Counter waiting_strengths{
    "light_samples_late", "samples", "light samples",
    "Light samples whose new strength waits for a later frame (FrameInput::strength_budget)"};
constexpr Counter clamped_share{"clamped_share", "%", "clamping",
                                "Share of the light of static surface samples that the bound of the geometry term "
                                "takes away; estimated by rays"};

} // namespace

std::span<const Counter> SampleSet::counters() {
    static const Counter all[] = {light_samples, direct_samples,  dynamic_samples,   moved_samples,
                                  late_samples,  blocked_samples, waiting_strengths, clamped_share};
    return all;
}

void SampleSet::report(Report& report) const {
    const auto direct =
        std::count_if(samples_.begin(), samples_.end(), [](const LightSample& sample) { return sample.bounce == 0; });
    report.set(light_samples, double(samples_.size()));
    report.set(direct_samples, double(direct));
    report.set(dynamic_samples, double(dynamic_samples_.size()));
    report.set(moved_samples, double(moved_.size()));
    report.set(late_samples, double(followed_.movers.behind()));
    report.set(blocked_samples, double(blocked_paths_.count()));
    report.set(waiting_strengths, double(late_changes_));
    report.set(clamped_share, 100.0 * loss_);
}

Status SampleSet::update(const SceneView& scene, const SampleRequest& request, const LightSettings& settings,
                         const UpdateOptions& options) {
    moved_.clear();
    const bool keep = options.keep && cause_.valid;
    const std::vector<Emitter> fixed = keep ? emitters_ : std::vector<Emitter>();
    const std::vector<Emitter> dynamic = keep ? dynamic_emitters_ : std::vector<Emitter>();
    find_emitters(scene, request);
    const Cause now = cause_of(request, scene);
    const bool fits = is_cause(now), others = !fits && !keep;
    outdated_ = !fits && keep;
    if (others) {
        cause_ = {}; // should it end before its end
        SUNFLECK_TRY(make_samples(request, scene, now, options.progress));
        cause_ = now;
    } else if (options.previous_lost) {
        followed_ = followed_before_;
    }
    followed_before_ = followed_;
    if (outdated_)
        keep_emitters(fixed, dynamic);
    if (!others)
        follow_dynamic_lights(scene.rays);
    const bool blocks = settings.mover_paths && !request.movers_are_static;
    if (blocks)
        blocked_paths_.update(scene.changes, scene.meshes, samples_, generation_);
    else
        blocked_paths_ = {};
    if (blocks)
        blocked_paths_.check(samples_, dynamic_samples_); // they reach movers, or not
    update_bounds(scene, settings);
    find_let_through(scene.rays, settings);
    follow_movers(scene, settings);
    if (blocks && !followed_.movers.samples().empty())
        blocked_paths_.check(samples_, dynamic_samples_);
    return {};
}

// Emitters that move have samples of their own, and so have those that once changed their flux: the first change
// generates all samples again, later ones only scale.
void SampleSet::find_emitters(const SceneView& scene, const SampleRequest& request) {
    const Bounds& fixed = scene.gpu_scene.static_bounds();
    const Bounds bounds = fixed.empty() ? scene.gpu_scene.bounds() : fixed;
    const bool same = emitter_cursor_.follows(scene.changes) && !scene.changes.emitters_changed() &&
                      emitters_as_static_ == request.movers_are_static && punctual_lights_ == request.punctual_lights &&
                      emitter_bounds_.minimum == bounds.minimum && emitter_bounds_.maximum == bounds.maximum;
    emitter_cursor_.saw(scene.changes);
    if (same)
        return;
    emitters_as_static_ = request.movers_are_static;
    punctual_lights_ = request.punctual_lights;
    emitter_bounds_ = bounds;
    const scene::SceneSpace& space = scene.changes.space;
    if (space != emitter_space_) // flux is counted in other units
        last_flux_.clear();
    emitter_space_ = space;
    emitters_ = collect_emitters(scene.registry, scene.meshes, bounds, varying_, space, &warned_of_);
    if (find_varying(scene.registry))
        emitters_ = collect_emitters(scene.registry, scene.meshes, bounds, varying_, space, &warned_of_);
    find_punctual(emitters_, request.punctual_lights);
    dynamic_emitters_.clear();
    if (request.movers_are_static)
        return;
    const auto moves = [&](const Emitter& emitter) {
        return DynamicLights::can_follow(emitter.kind) && (emitter.moves || varying_.count(emitter.entity));
    };
    for (const Emitter& emitter : emitters_)
        if (moves(emitter))
            dynamic_emitters_.push_back(emitter);
    std::erase_if(emitters_, moves);
}

void SampleSet::expect_varying(const std::set<ecs::Entity>& lights) {
    varying_.insert(lights.begin(), lights.end());
    emitter_cursor_ = {};
}

// True if there are new ones. One that was switched off is noticed by its absence.
bool SampleSet::find_varying(ecs::Registry& registry) {
    std::map<ecs::Entity, vec3> flux;
    for (const Emitter& emitter : emitters_)
        if (DynamicLights::can_follow(emitter.kind) && !emitter.moves)
            flux[emitter.entity] = emitter.flux;
    const std::size_t had = varying_.size();
    for (const auto& [entity, before] : last_flux_) {
        const auto now = flux.find(entity);
        const bool out = now == flux.end() && registry.alive(entity);
        if (out || (now != flux.end() && now->second != before))
            varying_.insert(entity);
    }
    last_flux_ = std::move(flux);
    return varying_.size() != had;
}

SampleSet::Cause SampleSet::cause_of(const SampleRequest& request, const SceneView& scene) const {
    Cause cause;
    cause.emitters = hash_emitters(emitters_);
    for (const Emitter& emitter : dynamic_emitters_) // only which ones there are
        cause.emitters = cause.emitters * 0x100000001b3ull ^
                         (emitter.entity.bits() * 32 + std::uint64_t(emitter.kind) * 2 + (emitter.punctual ? 1 : 0));
    // Where movers count as static geometry, each of their moves needs new walks.
    cause.geometry = request.movers_are_static ? scene.rays.generation() : scene.rays.static_generation();
    cause.request = request;
    cause.movers_reflect = wants_movers(request, scene.changes);
    cause.valid = true;
    return cause;
}

bool SampleSet::is_cause(const Cause& now) const {
    return cause_.valid && now.request.same_samples(cause_.request) && now.emitters == cause_.emitters &&
           now.geometry == cause_.geometry && now.movers_reflect == cause_.movers_reflect;
}

// `follower`: the sample's place in dynamic_samples_. `moved`: since the update before; where that was lost, the sample
// may have been elsewhere in it.
void SampleSet::take_over(std::uint32_t follower, const LightSample& now, bool moved) {
    const std::uint32_t i = dynamic_samples_[follower];
    const LightSample& old = samples_[i];
    moved = moved || now.position != old.position || now.normal != old.normal || now.cone_scale != old.cone_scale ||
            now.cone_offset != old.cone_offset;
    samples_[i] = now;
    samples_[i].index = i;
    if (moved)
        moved_.push_back(i);
}

void SampleSet::follow_dynamic_lights(const raytrace::RayScene& rays) {
    if (followed_.lights.samples().empty())
        return;
    followed_.lights.update(dynamic_emitters_, rays);
    for (std::uint32_t k = 0; k < followed_.lights.samples().size(); ++k)
        take_over(k, followed_.lights.samples()[k], followed_.lights.moved()[k] != 0);
}

// What arrives at movers is all other light, of one reflection less than may be at most.
void SampleSet::follow_movers(const SceneView& scene, const LightSettings& settings) {
    if (followed_.movers.samples().empty())
        return;
    const Bounds bounds = scene.gpu_scene.bounds();
    std::vector<float> shares(samples_.size(), 1.0f); // 0: what movers reflect
    const std::size_t first = followed_.lights.samples().size();
    for (std::size_t k = 0; k < dynamic_samples_.size(); ++k)
        shares[dynamic_samples_[k]] = k < first ? followed_.let_through[k] : 0.0f;
    std::vector<IncomingLight> incoming;
    for (const LightSample& sample : samples_) {
        const float share = shares[sample.index];
        if (share == 0.0f || is_blocked(sample.index) || sample.bounce >= cause_.request.bounces)
            continue;
        incoming.push_back({make_light_row(sample, 0, bound_of(sample, settings), bounds), light_class(sample.kind),
                            sample.bounce, sample.bounce > 0 ? sample.radius : 0.0f});
        incoming.back().row.intensity_slot /= vec4(vec3(share), 1.0f);
    }
    const auto let_through = [&](const LightSample& sample, std::uint32_t k) {
        float& share = followed_.let_through[first + k];
        if (followed_.movers.moved()[k] != 0 || share == 0.0f)
            share = let_through_of(sample, bound_of(sample, settings), scene.rays);
        return share;
    };
    MoverLight own;
    own.ends_paths = [&](ecs::Entity mover) { return blocked_paths_.is_box(mover); };
    own.blocked = [&](const LightSample& sample) { return blocked_paths_.blocks(sample); };
    own.arriving = [&](const LightSample& sample, std::uint32_t k) {
        LightSample one = sample;
        one.flux = vec3(1.0f / let_through(sample, k));
        return IncomingLight{make_light_row(one, 0, bound_of(one, settings), bounds), light_class(one.kind)};
    };
    followed_.movers.update(incoming, own, 4.0f * glm::length(bounds.extent()), scene.changes, scene.rays);
    take_over_movers(scene.rays, settings);
}

// A path's sample stands for a disc of surface (clamping.h) that is the larger the more light it carries: few paths
// differ much, and no wall is brighter near one of them than near the others.
void SampleSet::take_over_movers(const raytrace::RayScene& rays, const LightSettings& settings) {
    const std::uint32_t first = std::uint32_t(followed_.lights.samples().size());
    const std::vector<LightSample>& samples = followed_.movers.samples();
    float sum = 0.0f, paths = 0.0f;
    for (const LightSample& sample : samples)
        if (!sample.on_mover) {
            sum += luminance(sample.flux);
            paths += 1.0f;
        }
    followed_.discs.resize(samples.size());
    for (std::uint32_t k = 0; k < samples.size(); ++k) {
        LightSample now = samples[k];
        const bool moved = followed_.movers.moved()[k] != 0;
        if (!now.on_mover && sum > 0.0f)
            now.radius = std::sqrt(settings.clamp_scale * luminance(now.flux) * paths / (sum * dynamic_bound_));
        const float bound = bound_of(now, settings);
        Followed::Disc& disc = followed_.discs[k];
        if (moved || disc.let_through == 0.0f || disc.bound != bound)
            disc = {bound, let_through_of(now, bound, rays)};
        now.flux /= disc.let_through;
        take_over(first + k, now, moved);
    }
}

// Few samples have low bounds, which take away much of their light: the dynamic ones are so much brighter. (Where there
// are many, and medoids of clusters, a room's mean comes nearer to the truth by that, but not its pixels.)
void SampleSet::find_let_through(const raytrace::RayScene& rays, const LightSettings& settings) {
    if (followed_.let_through_bound != dynamic_bound_ || followed_.let_through.size() != dynamic_samples_.size())
        followed_.let_through.assign(dynamic_samples_.size(), 0.0f);
    followed_.let_through_bound = dynamic_bound_;
    parallel_for_chunks(followed_.lights.samples().size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const LightSample& sample = samples_[dynamic_samples_[k]];
            float& let_through = followed_.let_through[k];
            if (followed_.lights.moved()[k] != 0 || let_through == 0.0f)
                let_through = let_through_of(sample, bound_of(sample, settings), rays);
        }
    });
}

// Dynamic emitters have few samples, each with more flux: their reflected samples are clamped as if there were no
// others. Those that lie on movers have discs of their own.
void SampleSet::update_bounds(const SceneView& scene, const LightSettings& settings) {
    std::uint32_t surface_samples = 0, dynamic_reflected = 0;
    for (const LightSample& sample : samples_) {
        surface_samples += sample.kind == SampleKind::surface;
        dynamic_reflected +=
            sample.kind == SampleKind::surface && sample.dynamic && sample.bounce > 0 && !sample.on_mover;
    }
    const float area = scene.rays.static_area();
    bound_ = gi::geometry_bound(surface_samples, area, settings.clamp_scale);
    dynamic_bound_ = gi::geometry_bound(dynamic_reflected, area, settings.clamp_scale);
}

float SampleSet::bound_of(const LightSample& sample, const LightSettings& settings) const {
    const bool alone = sample.dynamic && sample.bounce > 0;
    // Texels of light maps are as fine as the highest bound of the samples in them asks for.
    if (sample.bounce == 0 && sample.dynamic)
        return emitter_bound_of(sample.radius, bound_, settings.clamp_scale);
    if (sample.on_mover)
        return geometry_bound_of(sample.radius, 1e30f, settings.clamp_scale);
    return geometry_bound_of(sample.radius, alone ? dynamic_bound_ : bound_, settings.clamp_scale);
}

void SampleSet::find_loss(const SceneView& scene, const LightSettings& settings) {
    const LossCause now{generation_, bound_, settings.clamp_scale};
    if (now == loss_cause_)
        return;
    loss_cause_ = now;
    std::vector<float> bounds;
    bounds.reserve(samples_.size());
    for (const LightSample& sample : samples_)
        bounds.push_back(bound_of(sample, settings));
    loss_ = clamping_loss(samples_, bounds, scene.rays);
}

void SampleSet::update_rows(const SceneView& scene, const LightSettings& settings, std::uint32_t slots,
                            const Strengths& strengths) {
    remapped_.clear();
    slots_ = std::max(slots, 1u);
    find_loss(scene, settings);
    // The maps of directional lights cover the scene's bounds and change with them.
    const Bounds bounds = scene.gpu_scene.bounds();
    const bool resized = bounds.minimum != bounds_.minimum || bounds.maximum != bounds_.maximum;
    bounds_ = bounds;
    const std::vector<shared::LightRow> before = rows_;
    rows_.resize(samples_.size());
    for (std::uint32_t i = 0; i < samples_.size(); ++i) {
        const LightSample& sample = samples_[i];
        const bool reflected = sample.bounce > 0;
        const float cone = rows_[i].position_bound.w;
        rows_[i] = make_light_row(sample, slot(i), bound_of(sample, settings), bounds_);
        // A spot light's map covers its cone, whose angle may change while the light stays.
        if ((resized && sample.kind == SampleKind::directional) ||
            (sample.kind == SampleKind::spot && rows_[i].position_bound.w != cone))
            remapped_.push_back(i);
        if (reflected)
            rows_[i].intensity_slot *= vec4(vec3(blocked_paths_.is_blocked(i) ? 0.0f : strengths.indirect_scale), 1.0f);
    }
    for (std::size_t k = 0; k < followed_.lights.samples().size(); ++k)
        rows_[dynamic_samples_[k]].intensity_slot /= vec4(vec3(followed_.let_through[k]), 1.0f);
    late_changes_ = 0;
    if (rows_generation_ == generation_)
        limit_changes(before, strengths);
    else
        waited_.clear();
    rows_generation_ = generation_;
}

} // namespace sunfleck::gi
