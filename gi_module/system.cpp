#include "gi_module/system.h"

#include "engine/core/hash.h"
#include "gi_module/many_light/map_contributions.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/transport/clamping.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr std::uint64_t most_curved_points = std::uint64_t(1) << 20; // of baked light: 56 MiB

// Adds the time until its end to a stage.
class StageTimer {
public:
    StageTimer(std::map<std::string, double>& times, const char* stage) : times_(times), stage_(stage) {}
    ~StageTimer() {
        const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start_;
        times_[stage_] += elapsed.count();
    }

private:
    std::map<std::string, double>& times_;
    const char* stage_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Tells whether anything about the emitters changed.
std::uint64_t hash_emitters(const std::vector<Emitter>& emitters) {
    std::uint64_t hash = hash_start;
    const auto add = [&](const void* data, std::size_t size) { hash = hash_bytes(hash, data, size); };
    for (const Emitter& emitter : emitters) {
        add(&emitter.kind, sizeof emitter.kind);
        add(&emitter.entity, sizeof emitter.entity);
        add(&emitter.matrix, sizeof emitter.matrix);
        add(&emitter.flux, sizeof emitter.flux);
        add(&emitter.area, sizeof emitter.area);
        add(&emitter.inner_cosine, sizeof emitter.inner_cosine);
        add(&emitter.outer_cosine, sizeof emitter.outer_cosine);
        const scene::EnvironmentImage* image = emitter.map.image.get();
        add(&image, sizeof image);
        add(&emitter.map.rotation, sizeof emitter.map.rotation);
    }
    return hash;
}

bool same_sampling(const Settings& a, const Settings& b) {
    const auto without = [](auto technique) { return technique == std::remove_cvref_t<decltype(technique)>::none; };
    return without(a.direct) == without(b.direct) && without(a.indirect) == without(b.indirect) &&
           (a.movers == MoverHandling::as_static) == (b.movers == MoverHandling::as_static) && a.lights == b.lights &&
           a.direct_share == b.direct_share && a.dynamic_share == b.dynamic_share && a.bounces == b.bounces &&
           a.seed == b.seed && a.sequence == b.sequence && a.termination == b.termination &&
           a.candidates == b.candidates && a.spread == b.spread;
}

} // namespace

std::span<const gpu::EmbeddedShader> shaders() {
    return gpu::sunfleck_gi_shaders();
}

Result<std::unique_ptr<System>> System::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<System> system(new System(device));
    SUNFLECK_ASSIGN(system->shadow_maps_, ShadowMaps::create(device, pipelines));
    SUNFLECK_ASSIGN(system->brute_force_, BruteForce::create(device, pipelines));
    SUNFLECK_ASSIGN(system->many_light_, ManyLight::create(device, pipelines));
    SUNFLECK_ASSIGN(system->transfer_pass_, TransferPass::create(device, pipelines));
    return system;
}

System::~System() = default;

Status System::set_settings(const Settings& settings) {
    SUNFLECK_TRY(validate(Settings::description(), &settings));
    if (settings.shadow_map_bits != 16 && settings.shadow_map_bits != 32)
        return Error{"shadow_map_bits is " + std::to_string(settings.shadow_map_bits) + "; 16 or 32 is needed"};
    if (settings.shadow_map_resolution < 8 || settings.shadow_map_resolution > 2048 ||
        settings.shadow_map_resolution % 2 != 0)
        return Error{"shadow_map_resolution is " + std::to_string(settings.shadow_map_resolution) +
                     "; an even number from 8 to 2048 is needed"};
    if (settings.lights > 65536)
        return Error{"lights is " + std::to_string(settings.lights) + "; at most 65536 are possible"};
    if (settings.low_resolution != 1 && settings.low_resolution != 2 && settings.low_resolution != 4 &&
        settings.low_resolution != 8)
        return Error{"low_resolution is " + std::to_string(settings.low_resolution) + "; 1, 2, 4 or 8 is needed"};
    const bool some =
        settings.direct == DirectTechnique::light_samples || settings.indirect == IndirectTechnique::light_samples;
    if (some &&
        (settings.direct == DirectTechnique::brute_force || settings.indirect == IndirectTechnique::brute_force))
        return Error{"direct and indirect light share one pass: choose light_samples for both or brute_force for both "
                     "(or none for one of them)"};
    settings_ = settings;
    return {};
}

bool System::uses_many_light() const {
    return settings_.direct == DirectTechnique::light_samples || settings_.indirect == IndirectTechnique::light_samples;
}

bool System::needs_new_samples(const raytrace::RayScene& rays) {
    std::uint64_t hash = hash_emitters(emitters_);
    for (const Emitter& emitter : dynamic_emitters_) // only which they are
        hash = hash * 0x100000001b3ull ^ (emitter.entity.bits() * 16 + std::uint64_t(emitter.kind));
    // Where movers count as static geometry, their every move makes new walks.
    const std::uint64_t geometry =
        settings_.movers == MoverHandling::as_static ? rays.generation() : rays.static_generation();
    const bool same = samples_valid_ && same_sampling(settings_, sampled_settings_) && hash == emitter_hash_ &&
                      geometry == geometry_generation_;
    emitter_hash_ = hash;
    geometry_generation_ = geometry;
    sampled_settings_ = settings_;
    samples_valid_ = true;
    return !same;
}

void System::make_samples(ecs::Registry& registry, const raytrace::RayScene& rays) {
    Settings fixed = settings_; // what is left for emitters that stay
    std::uint32_t share = 0;
    if (!dynamic_emitters_.empty() && settings_.lights > 0)
        share = emitters_.empty() ? settings_.lights
                                  : std::min(settings_.lights,
                                             std::max(std::uint32_t(float(settings_.lights) * settings_.dynamic_share),
                                                      2 * std::uint32_t(dynamic_emitters_.size())));
    dynamic_lights_.reset(share > 0 ? dynamic_emitters_ : std::vector<Emitter>(), share, settings_, rays);
    fixed.lights = settings_.lights - std::min(settings_.lights, std::uint32_t(dynamic_lights_.samples().size()));
    const SampleBudget budget = divide_samples(fixed, emitters_);
    samples_ = sample_direct(emitters_, budget.direct, fixed, rays);
    const std::vector<LightSample> indirect = sample_indirect(emitters_, budget.indirect, fixed, rays);
    samples_.insert(samples_.end(), indirect.begin(), indirect.end());
    const auto& moving = dynamic_lights_.samples();
    samples_.insert(samples_.end(), moving.begin(), moving.end());
    std::stable_sort(samples_.begin(), samples_.end(), [](const LightSample& a, const LightSample& b) {
        return std::pair(light_class(a.kind), a.dynamic) < std::pair(light_class(b.kind), b.dynamic);
    });
    // The order within their kind is the one that they came in.
    std::vector<std::uint32_t> place(moving.size());
    for (std::uint32_t i = 0; i < place.size(); ++i)
        place[i] = i;
    std::stable_sort(place.begin(), place.end(), [&](std::uint32_t a, std::uint32_t b) {
        return light_class(moving[a].kind) < light_class(moving[b].kind);
    });
    dynamic_samples_.assign(moving.size(), 0);
    for (std::uint32_t i = 0, next = 0; i < samples_.size(); ++i)
        if (samples_[i].dynamic)
            dynamic_samples_[place[next++]] = i;
    for (std::uint32_t i = 0; i < samples_.size(); ++i)
        samples_[i].index = i;
    scheduler_.reset(samples_.size());
    ++sample_generation_;
    mirror_samples(registry);
}

// Those that move have samples of their own, and so have those that once changed their strength: the first change makes
// new samples for all, later ones only scale.
void System::find_emitters(ecs::Registry& registry, const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                           const Bounds& bounds) {
    const bool same = emitter_cursor_.follows(changes) && !changes.emitters_changed() &&
                      emitter_movers_ == settings_.movers && emitter_bounds_.minimum == bounds.minimum &&
                      emitter_bounds_.maximum == bounds.maximum;
    emitter_cursor_.saw(changes);
    if (same)
        return;
    emitter_movers_ = settings_.movers;
    emitter_bounds_ = bounds;
    emitters_ = collect_emitters(registry, meshes, bounds, varying_);
    if (find_varying(registry))
        emitters_ = collect_emitters(registry, meshes, bounds, varying_);
    dynamic_emitters_.clear();
    if (settings_.movers == MoverHandling::as_static)
        return;
    const auto moves = [&](const Emitter& emitter) {
        return DynamicLights::can_follow(emitter.kind) && (emitter.moves || varying_.count(emitter.entity));
    };
    for (const Emitter& emitter : emitters_)
        if (moves(emitter))
            dynamic_emitters_.push_back(emitter);
    std::erase_if(emitters_, moves);
}

// True if there are new ones. One that went out is noticed by its absence.
bool System::find_varying(ecs::Registry& registry) {
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

void System::follow_dynamic_lights(ecs::Registry& registry, const raytrace::RayScene& rays) {
    if (dynamic_samples_.empty())
        return;
    dynamic_lights_.update(dynamic_emitters_, rays);
    for (std::size_t k = 0; k < dynamic_samples_.size(); ++k) {
        const std::uint32_t i = dynamic_samples_[k];
        const LightSample& now = dynamic_lights_.samples()[k];
        if (!dynamic_lights_.moved()[k] && now.flux == samples_[i].flux)
            continue;
        samples_[i] = now;
        samples_[i].index = i;
        if (registry.alive(entities_[i]))
            registry.emplace_or_replace<LightSample>(entities_[i], samples_[i]);
        if (!dynamic_lights_.moved()[k])
            continue;
        changed_samples_.push_back(i);
        scheduler_.mark_static(i);
    }
}

void System::mirror_samples(ecs::Registry& registry) {
    while (entities_.size() > samples_.size()) {
        if (registry.alive(entities_.back()))
            registry.destroy(entities_.back());
        entities_.pop_back();
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        if (i >= entities_.size())
            entities_.push_back(registry.create());
        else if (!registry.alive(entities_[i]))
            entities_[i] = registry.create();
        registry.emplace_or_replace<LightSample>(entities_[i], samples_[i]);
        registry.emplace_or_replace<ShadowMap>(entities_[i], ShadowMap{});
    }
}

void System::update_rows(const Bounds& bounds, const raytrace::RayScene& rays) {
    // Emitters that move have few samples of their own, each of which carries more: the bound of what they reflect is
    // as if there were no others.
    std::uint32_t surface_samples = 0, dynamic_samples = 0;
    for (const LightSample& sample : samples_) {
        surface_samples += sample.kind == SampleKind::surface;
        dynamic_samples += sample.kind == SampleKind::surface && sample.dynamic && sample.bounce > 0;
    }
    bound_ = gi::geometry_bound(surface_samples, rays.static_area(), settings_.clamp_scale);
    const float dynamic_bound = gi::geometry_bound(dynamic_samples, rays.static_area(), settings_.clamp_scale);
    // The maps of directional lights cover the scene's bounds, so all of them follow a change of those.
    if (bounds.minimum != scene_bounds_.minimum || bounds.maximum != scene_bounds_.maximum)
        for (std::uint32_t i = 0; i < samples_.size(); ++i)
            if (samples_[i].kind == SampleKind::directional)
                scheduler_.mark_static(i);
    scene_bounds_ = bounds;
    const std::uint32_t slots = std::max(shadow_maps_->slots(), 1u);
    rows_.resize(samples_.size());
    for (std::uint32_t i = 0; i < samples_.size(); ++i) {
        const bool few = samples_[i].dynamic && samples_[i].bounce > 0;
        const float map_scale = rows_[i].position_bound.w;
        const float bound = geometry_bound_of(samples_[i].radius, few ? dynamic_bound : bound_, settings_.clamp_scale);
        rows_[i] = make_light_row(samples_[i], i % slots, bound, scene_bounds_);
        // A spot's map covers its cone, whose angle may change where the light stays.
        if (samples_[i].kind == SampleKind::spot && rows_[i].position_bound.w != map_scale)
            scheduler_.mark_static(i);
        const float share = blocked_paths_.is_blocked(i) ? 0.0f : input_.indirect_scale;
        if (samples_[i].bounce > 0)
            rows_[i].intensity_slot *= vec4(vec3(share), 1.0f);
    }
}

// The many-light system keeps a map for every sample: with more samples than memory_bytes holds at full size, maps are
// smaller. Each sample is then dimmer, too.
Status System::configure_maps() {
    if (!settings_.shadows)
        return {};
    MapLayout layout;
    layout.resolution = settings_.shadow_map_resolution;
    layout.bits = settings_.shadow_map_bits;
    layout.wanted = std::uint32_t(samples_.size());
    layout.memory_bytes = std::uint64_t(double(settings_.shadow_memory) * 1048576.0);
    layout.keep_static = uses_many_light() && settings_.static_maps;
    layout.shrink = uses_many_light();
    SUNFLECK_ASSIGN(const bool cleared, shadow_maps_->configure(layout, resources_));
    if (cleared)
        for (std::uint32_t i = 0; i < samples_.size(); ++i)
            scheduler_.mark_static(i);
    return {};
}

Status System::update_visibility(ecs::Registry& registry, const scene::SceneChanges& changes,
                                 const scene::MeshStore& meshes, const scene::GpuScene& gpu_scene,
                                 bool static_changed) {
    VisibilityOptions options;
    options.patches.levels = settings_.patch_levels;
    options.tests = settings_.visibility_tests;
    const bool same_options =
        options.patches.levels == database_options_.patches.levels && options.tests == database_options_.tests;
    const bool built = database_samples_ != sample_generation_ || static_changed || !same_options;
    if (built) {
        database_samples_ = 0; // should it be stopped
        if (!database_.build(registry, meshes, samples_, options, input_.progress))
            return Error{"the lighting's preparation was stopped"};
        database_options_ = options;
        database_samples_ = sample_generation_;
        changed_samples_.clear();
    }
    if (settings_.baked_light && curved_generation_ != database_.generation()) {
        curved_charts_.build(registry, meshes, database_.patches(), light_map_texel(bound_), most_curved_points);
        curved_generation_ = database_.generation();
    }
    database_.begin_frame();
    {
        const StageTimer timer(cpu_times_, "visibility of samples");
        database_.change_samples(samples_, changed_samples_);
    }
    update_movers(changes, meshes, gpu_scene, built || database_movers_ != settings_.movers);
    return {};
}

// `all`: the database knows none of them, or other settings apply.
void System::update_movers(const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                           const scene::GpuScene& gpu_scene, bool all) {
    all = all || !mover_cursor_.follows(changes);
    mover_cursor_.saw(changes);
    database_movers_ = settings_.movers;
    std::vector<MoverPlace> movers;
    std::vector<ecs::Entity> gone;
    const auto add = [&](const scene::Drawable& drawable) {
        const scene::DrawItem* item = gpu_scene.find(drawable.entity);
        if (item == nullptr) // its mesh is not on the GPU yet: looked for again in the next frame
            mover_cursor_ = {};
        if (item == nullptr || drawable.is_static)
            return gone.push_back(drawable.entity);
        movers.push_back(MoverPlace::of(drawable));
        movers.back().lit = settings_.movers != MoverHandling::transfer ||
                            !TransferLighting::takes(*item, drawable.matrix, meshes, drawable.mesh);
    };
    if (all) {
        for (const scene::Drawable* drawable : changes.all)
            add(*drawable);
        return database_.update_movers(movers, meshes);
    }
    for (const scene::DrawableChange& change : changes.drawables)
        if (change.removed())
            gone.push_back(change.entity);
        else if (change.is_mover())
            add(*change.now);
    database_.change_movers(movers, gone, meshes);
}

Status System::update_transfer(const ecs::Registry& registry, const scene::MeshStore& meshes,
                               const scene::GpuScene& gpu_scene, const raytrace::RayScene& rays) {
    transfer_.clear();
    if (settings_.movers != MoverHandling::transfer)
        return {};
    const StageTimer timer(cpu_times_, "transfer");
    TransferLightingOptions options;
    options.points = settings_.transfer_points;
    options.reflections = settings_.transfer_reflections;
    options.cache = cache_folder_;
    options.progress = input_.progress;
    const ProbeScene scene{rays, samples_, rows_, gpu_scene.draws(), uses_many_light() ? &database_ : nullptr};
    SUNFLECK_TRY(transfer_.update(registry, meshes, scene, options, resources_));
    counters_.transfer_vertices = transfer_.vertices();
    return {};
}

void System::mark_by_visibility(const scene::GpuScene& gpu_scene) {
    float distance = 0.0f;
    lag_limit_ = 0.0f;
    for (const scene::DrawItem& item : gpu_scene.draws())
        if (!item.is_static) {
            distance = std::max(distance, item.displacement);
            lag_limit_ = std::max(lag_limit_, 0.5f * glm::length(item.bounds.extent()));
        }
    for (std::uint32_t i = 0; i < samples_.size(); ++i)
        if (database_.affected_samples()[i])
            scheduler_.mark(i, distance);
}

// A moved object touches the map of every sample that sees the box where it was, or the one where it is.
void System::mark_by_bounds(const scene::GpuScene& gpu_scene) {
    std::vector<Bounds> touched = gpu_scene.removed_bounds();
    for (const scene::DrawItem& item : gpu_scene.draws())
        if (item.moved && item.casts_shadow) {
            touched.push_back(item.bounds);
            if (!item.previous_bounds.empty())
                touched.push_back(item.previous_bounds);
        }
    if (touched.empty())
        return;
    for (std::uint32_t i = 0; i < samples_.size(); ++i) {
        const ShadowRequest request{0, light_class(samples_[i].kind), rows_[i], true};
        if (std::any_of(touched.begin(), touched.end(),
                        [&](const Bounds& bounds) { return ShadowMaps::faces_that_see(request, bounds) != 0; }))
            scheduler_.mark(i);
    }
}

// Empty where the choice does not need them.
std::vector<float> System::contributions_of_stale_maps(const scene::GpuScene& gpu_scene, std::uint32_t budget) const {
    if (!uses_many_light() || !input_.view_projection || settings_.map_priority != MapPriority::contribution ||
        scheduler_.stale() <= budget)
        return {};
    std::vector<std::uint8_t> wanted(samples_.size());
    for (std::uint32_t i = 0; i < samples_.size(); ++i)
        wanted[i] = scheduler_.frames_out_of_date(i) > 0 ? 1 : 0;
    return map_contributions(database_, samples_, rows_, gpu_scene.draws(), *input_.view_projection, wanted);
}

Status System::update(ecs::Registry& registry, const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                      const scene::GpuScene& gpu_scene, raytrace::RayScene& rays, const FrameInput& input) {
    cpu_times_.clear();
    counters_ = {};
    input_ = input;
    resources_.begin_frame(input.serial, input.completed_serial);
    const Bounds bounds = gpu_scene.bounds();
    const bool static_changed = database_geometry_ != rays.static_generation();
    database_geometry_ = rays.static_generation();
    {
        const StageTimer timer(cpu_times_, "light samples");
        find_emitters(registry, changes, meshes,
                      gpu_scene.static_bounds().empty() ? bounds : gpu_scene.static_bounds());
        changed_samples_.clear();
        if (needs_new_samples(rays))
            make_samples(registry, rays);
        else
            follow_dynamic_lights(registry, rays);
        if (static_changed)
            scheduler_.reset(samples_.size());
        SUNFLECK_TRY(configure_maps());
        if (settings_.mover_paths && settings_.movers != MoverHandling::as_static)
            blocked_paths_.update(changes, meshes, samples_, sample_generation_);
        else
            blocked_paths_ = {};
        update_rows(bounds, rays);
    }
    if (uses_many_light()) {
        const StageTimer timer(cpu_times_, "visibility");
        SUNFLECK_TRY(update_visibility(registry, changes, meshes, gpu_scene, static_changed));
    } else {
        database_samples_ = 0;
    }
    SUNFLECK_TRY(update_transfer(registry, meshes, gpu_scene, rays));
    input_.progress = {}; // what it refers to may end with this call
    const StageTimer timer(cpu_times_, "shadow scheduling");
    scheduler_.advance();
    if (uses_many_light())
        mark_by_visibility(gpu_scene);
    else
        mark_by_bounds(gpu_scene);
    // The host's budget is a limit; the setting's is exceeded for maps that could not be used otherwise.
    map_budget_.took(input.measured_serial, input.measured_map_milliseconds);
    const std::uint32_t usual = settings_.map_milliseconds > 0.0f
                                    ? map_budget_.maps_in(double(settings_.map_milliseconds), settings_.map_budget)
                                    : settings_.map_budget;
    const std::uint32_t wanted = std::max(usual, std::uint32_t(scheduler_.unusable()));
    const std::uint32_t budget = uses_many_light() ? std::min(input.map_budget, wanted) : input.map_budget;
    to_draw_.clear();
    if (settings_.shadows)
        to_draw_ =
            scheduler_.choose(samples_, settings_.map_priority, budget, contributions_of_stale_maps(gpu_scene, budget));
    map_budget_.drew(input.serial, to_draw_.size());
    counters_.light_samples = samples_.size();
    counters_.light_samples_dynamic = dynamic_samples_.size();
    counters_.light_samples_blocked = blocked_paths_.count();
    counters_.light_samples_moved = changed_samples_.size();
    counters_.light_samples_direct = std::uint64_t(
        std::count_if(samples_.begin(), samples_.end(), [](const LightSample& s) { return s.bounce == 0; }));
    return {};
}

} // namespace sunfleck::gi
