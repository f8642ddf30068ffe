#include "gi_module/shadows/shadow_service.h"

#include "engine/core/jobs.h"
#include "gi_module/shadows/light_batches.h"
#include "gi_module/shadows/map_contributions.h"

#include <algorithm>
#include <utility>

namespace sunfleck::gi {
namespace {

// As direct_detail_texels, of reflected samples, whose shadows are scattered.
constexpr float indirect_detail_texels = 2.0f;

constexpr Counter map_updates{"shadow_map_updates", "maps", "shadow maps", "Shadow maps drawn in this frame"};
constexpr Counter map_faces{"shadow_map_faces", "faces", "shadow maps",
                            "Octahedron faces drawn, i.e. those with an occluder"};
constexpr Counter map_vertices{"shadow_map_vertices", "vertices", "shadow maps",
                               "Vertices shaded for shadow maps, by the size of the meshes"};
constexpr Counter maps_stale{"shadow_maps_stale", "maps", "shadow maps",
                             "Shadow maps that are still stale after this frame: they show movers where they were"};
constexpr Counter map_memory{"shadow_maps", "B", memory_group, "Shadow maps, including their static parts"};

} // namespace

std::span<const Counter> ShadowService::counters() {
    static const Counter all[] = {map_updates, map_faces, map_vertices, maps_stale, light_batch_counter, map_memory};
    return all;
}

void ShadowService::report(Report& report) const {
    report.set(map_updates, double(drawn_.maps));
    report.set(map_faces, double(drawn_.faces));
    report.set(map_vertices, double(drawn_.vertices));
    report.set(maps_stale, settings_.shadows ? double(scheduler_.stale()) : 0.0);
    report.set(map_memory, double(maps_->texels().size() + maps_->static_texels().size()));
}

Result<std::unique_ptr<ShadowService>> ShadowService::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    auto service = std::make_unique<ShadowService>();
    SUNFLECK_ASSIGN(service->maps_, ShadowMaps::create(device, pipelines));
    return service;
}

void ShadowService::begin_frame(bool previous_lost) {
    maps_->begin_frame(previous_lost);
    scheduler_.begin_frame(previous_lost);
}

// With the database every sample keeps a map: if memory does not suffice at full resolution, maps are smaller. With so
// many samples, each of them is also dimmer.
Status ShadowService::configure(const ShadowSettings& settings, MapPolicy policy, std::uint32_t count,
                                gpu::FrameResources& resources) {
    settings_ = settings;
    policy_ = policy;
    cleared_ = false;
    redetailed_ = std::exchange(simplified_, simplifies_movers()) != simplifies_movers();
    drawn_ = {};
    if (!settings.shadows)
        return {};
    MapLayout layout;
    layout.resolution = settings.shadow_map_resolution;
    layout.bits = settings.shadow_map_bits;
    layout.wanted = count;
    layout.memory_bytes = std::uint64_t(double(settings.shadow_memory) * 1048576.0);
    layout.keep_static = policy.database && settings.static_maps;
    layout.shrink = policy.database;
    SUNFLECK_ASSIGN(cleared_, maps_->configure(layout, resources));
    return {};
}

void ShadowService::follow(const SampleSet& samples, bool static_changed) {
    if (static_changed || sample_generation_ != samples.generation())
        scheduler_.reset(samples.size());
    sample_generation_ = samples.generation();
    for (std::uint32_t sample = 0; cleared_ && sample < samples.size(); ++sample)
        scheduler_.mark_undefined(sample);
    for (std::uint32_t sample = 0; redetailed_ && sample < samples.size(); ++sample)
        scheduler_.mark(sample);
    for (const std::span<const std::uint32_t> changed : {samples.moved(), samples.remapped()})
        for (const std::uint32_t sample : changed)
            scheduler_.mark_static(sample);
}

void ShadowService::schedule(const SampleSet& samples, const ScheduleInput& input) {
    database_ = input.database;
    gpu_scene_ = &input.gpu_scene;
    view_projection_ = input.view_projection;
    scheduler_.advance(input.milliseconds);
    if (database_ != nullptr)
        mark_by_visibility(samples, input);
    else
        mark_by_bounds(samples, input.gpu_scene);
    set_unread_aside(samples, input.read);
    to_draw_.clear();
    if (settings_.shadows) {
        const std::uint32_t budget = budget_of(input);
        const std::vector<float> shares = contributions(samples, input, budget);
        to_draw_ = scheduler_.choose(samples.samples(), settings_.map_priority, budget, shares);
        if (budget < input.host_budget)
            to_draw_ = scheduler_.with_late_ones(std::move(to_draw_), shares);
    }
    budget_.add_frame(input.serial, to_draw_.size());
}

// Maps that are read again hold what they held when they were set aside.
void ShadowService::set_unread_aside(const SampleSet& samples, CellSet read) {
    unread_.resize(samples.size());
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const bool unread = !owns_sample(read, samples.samples()[i]);
        if (unread)
            scheduler_.set_aside(i);
        else if (unread_[i])
            scheduler_.mark_undefined(i);
        unread_[i] = unread ? 1 : 0;
    }
}

// The host's budget is a hard limit; that of the settings is exceeded for maps that are unusable otherwise.
std::uint32_t ShadowService::budget_of(const ScheduleInput& input) const {
    if (database_ == nullptr)
        return input.host_budget;
    const std::uint32_t usual = settings_.map_milliseconds > 0.0f
                                    ? budget_.maps_in(double(settings_.map_milliseconds), settings_.map_budget)
                                    : settings_.map_budget;
    return std::min(input.host_budget, std::max(usual, std::uint32_t(scheduler_.unusable())));
}

void ShadowService::mark_by_visibility(const SampleSet& samples, const ScheduleInput& input) {
    float distance = 0.0f;
    lag_limit_ = 0.0f;
    for (const scene::DrawItem& item : input.gpu_scene.draws())
        if (!item.is_static) {
            distance = std::max(distance, item.displacement);
            lag_limit_ = std::max(lag_limit_, 0.5f * glm::length(item.bounds.extent()));
        }
    for (std::uint32_t i = 0; i < samples.size(); ++i)
        if (database_->affected_samples()[i])
            scheduler_.mark(i, distance);
}

// A moved object affects the map of every sample that sees its box, at its old or its new position.
void ShadowService::mark_by_bounds(const SampleSet& samples, const scene::GpuScene& gpu_scene) {
    std::vector<Bounds> affected(gpu_scene.removed_bounds().begin(), gpu_scene.removed_bounds().end());
    for (const scene::DrawItem& item : gpu_scene.draws())
        if (item.moved && item.casts_shadow) {
            affected.push_back(item.bounds);
            if (!item.previous_bounds.empty())
                affected.push_back(item.previous_bounds);
        }
    if (affected.empty())
        return;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const ShadowRequest request{0, samples.light_class_of(i), samples.rows()[i], true};
        if (std::any_of(affected.begin(), affected.end(),
                        [&](const Bounds& bounds) { return ShadowMaps::faces_that_see(request, bounds) != 0; }))
            scheduler_.mark(i);
    }
}

// Empty if the choice does not depend on them.
std::vector<float> ShadowService::contributions(const SampleSet& samples, const ScheduleInput& input,
                                                std::uint32_t budget) const {
    if (database_ == nullptr || !input.view_projection || settings_.map_priority != MapPriority::contribution ||
        scheduler_.stale() <= budget)
        return {};
    std::vector<std::uint8_t> stale(samples.size());
    for (std::uint32_t i = 0; i < samples.size(); ++i)
        stale[i] = scheduler_.frames_out_of_date(i) > 0 ? 1 : 0;
    return map_contributions(*database_, samples.samples(), samples.rows(), input.gpu_scene.draws(),
                             *input.view_projection, stale);
}

static void hide(ecs::Entity entity, std::vector<std::uint8_t>& hidden) {
    hidden.resize(std::max<std::size_t>(hidden.size(), entity.index + 1));
    hidden[entity.index] = 1;
}

std::vector<ShadowRequest> ShadowService::requests(const SampleSet& samples,
                                                   std::span<const std::uint32_t> drawn) const {
    std::vector<ShadowRequest> requests;
    requests.reserve(drawn.size());
    for (const std::uint32_t sample : drawn) {
        requests.push_back({samples.slot(sample),
                            samples.light_class_of(sample),
                            samples.rows()[sample],
                            scheduler_.is_static_stale(sample),
                            samples.samples()[sample].bounce == 0 ? direct_detail_texels : indirect_detail_texels,
                            {}});
    }
    parallel_for_chunks(drawn.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (database_ != nullptr)
                requests[i].hidden = database_->hidden_entities(drawn[i]);
            if (samples.samples()[drawn[i]].on_mover)
                hide(samples.samples()[drawn[i]].emitter, requests[i].hidden);
        }
    });
    return requests;
}

Status ShadowService::draw(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const SampleSet& samples,
                           std::span<const std::uint32_t> drawn, gpu::FrameResources& resources) {
    if (drawn.empty())
        return {};
    const MapOptions options{.keep_static = policy_.database && settings_.static_maps, .detail = simplifies_movers()};
    SUNFLECK_TRY(maps_->add_passes(graph, gpu_scene, resources, requests(samples, drawn), options, drawn_));
    scheduler_.done(drawn);
    return {};
}

Status ShadowService::add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const SampleSet& samples,
                                 bool read, gpu::FrameResources& resources) {
    if (settings_.shadows && read)
        clear_undefined(graph, samples);
    return draw(graph, gpu_scene, samples, to_draw_, resources);
}

// What the budget leaves undrawn: through a map of some other sample, light would fall anywhere.
void ShadowService::clear_undefined(gpu::FrameGraph& graph, const SampleSet& samples) {
    const std::vector<std::uint32_t> undefined = scheduler_.to_clear(to_draw_);
    std::vector<std::uint32_t> slots;
    slots.reserve(undefined.size());
    for (const std::uint32_t sample : undefined)
        slots.push_back(samples.slot(sample));
    maps_->add_clearing(graph, slots);
    scheduler_.cleared(undefined);
}

Status ShadowService::add_map_range(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const SampleSet& samples,
                                    std::uint32_t first, std::uint32_t count, gpu::FrameResources& resources) {
    std::vector<std::uint32_t> drawn(count);
    for (std::uint32_t i = 0; i < count; ++i)
        drawn[i] = first + i;
    return draw(graph, gpu_scene, samples, drawn, resources);
}

MapState ShadowService::state(const SampleSet& samples, std::uint32_t sample) const {
    return {samples.slot(sample), maps_->resolution(), scheduler_.frames_out_of_date(sample),
            !scheduler_.is_static_stale(sample)};
}

} // namespace sunfleck::gi
