// The half of gi::System that declares GPU work.
#include "gi_module/system.h"

#include "gi_module/many_light/pass_cover.h"
#include "gi_module/many_light/pass_optimisation.h"
#include "gi_module/many_light/visible_nodes.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace sunfleck::gi {
namespace {

// Texels by which movers' simplified surfaces may be off. Shadows of direct light lie on each other and show their
// outline; those of reflected light are scattered.
constexpr float direct_detail = 0.35f, indirect_detail = 2.0f;

} // namespace

std::vector<ShadowRequest> System::make_requests(std::span<const std::uint32_t> samples) const {
    std::vector<ShadowRequest> requests;
    const bool knows_hidden = uses_many_light() && settings_.visibility;
    for (const std::uint32_t sample : samples) {
        requests.push_back({sample % shadow_maps_->slots(),
                            light_class(samples_[sample].kind),
                            rows_[sample],
                            scheduler_.is_static_stale(sample),
                            samples_[sample].bounce == 0 ? direct_detail : indirect_detail,
                            {}});
        if (knows_hidden)
            requests.back().hidden = database_.hidden_entities(sample);
    }
    return requests;
}

Result<std::vector<LightBatch>> System::make_batches(std::uint32_t first, std::uint32_t count) {
    std::vector<LightBatch> batches;
    std::uint32_t place = first;
    do {
        LightBatch batch;
        batch.first = place;
        batch.light_class = place < samples_.size() ? light_class(samples_[place].kind) : 0;
        batch.dynamic = place < samples_.size() && samples_[place].dynamic;
        SUNFLECK_ASSIGN(batch.rows, resources_.allocate(sizeof(shared::LightRow) * shared::lights_per_batch));
        while (place < first + count && batch.count < shared::lights_per_batch &&
               light_class(samples_[place].kind) == batch.light_class && samples_[place].dynamic == batch.dynamic) {
            shared::LightRow row = rows_[place];
            row.bitangent.w = std::min(scheduler_.lag(place++), lag_limit_);
            std::memcpy(batch.rows.data + sizeof row * batch.count++, &row, sizeof row);
        }
        batches.push_back(batch);
    } while (place < first + count);
    counters_.light_batches += batches.size();
    return batches;
}

Result<gpu::ResourceId> System::add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene,
                                           const GBufferInput& g_buffer, const gpu::UploadSlice& camera,
                                           VkFormat output_format) {
    const gpu::ResourceId output = graph.create_image("irradiance", output_format, g_buffer.width, g_buffer.height);
    SUNFLECK_TRY(add_passes(graph, gpu_scene, g_buffer, camera, output));
    return output;
}

Status System::add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const GBufferInput& g_buffer,
                          const gpu::UploadSlice& camera, gpu::ResourceId output) {
    if (uses_many_light())
        SUNFLECK_TRY(add_many_light(graph, gpu_scene, g_buffer, camera, output));
    else
        SUNFLECK_TRY(add_brute_force(graph, gpu_scene, g_buffer, camera, output));
    if (input_.show == shared::show_nothing)
        SUNFLECK_TRY(transfer_pass_->add_passes(graph, gpu_scene, g_buffer, camera, transfer_.draws(), output));
    counters_.shadow_maps_stale = scheduler_.stale();
    return {};
}

Status System::add_brute_force(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const GBufferInput& g_buffer,
                               const gpu::UploadSlice& camera, gpu::ResourceId output) {
    const std::uint32_t total = std::uint32_t(samples_.size());
    const std::uint32_t slots = settings_.shadows ? std::max(shadow_maps_->slots(), 1u) : std::max(total, 1u);
    const bool slots_shared = total > slots;
    const bool one_batch = !slots_shared && total <= shared::lights_per_batch &&
                           (total == 0 || (light_class(samples_.front().kind) == light_class(samples_.back().kind) &&
                                           samples_.front().dynamic == samples_.back().dynamic));
    SUNFLECK_TRY(brute_force_->begin_frame(g_buffer.width, g_buffer.height, !one_batch, input_.serial,
                                           input_.completed_serial, resources_));
    counters_.clamped_flux = brute_force_->clamped().flux;
    counters_.clamped_irradiance = brute_force_->clamped().mean_irradiance;
    BruteForceOptions options;
    options.shadows = settings_.shadows;
    options.filter = settings_.shadow_filter;
    options.count_clamped = settings_.count_clamped;

    ShadowCounters shadow_counters;
    std::uint32_t first = 0;
    // With more samples than slots, groups of samples take turns: their maps are drawn, used and overwritten.
    do {
        const std::uint32_t count = std::min(slots, total - first);
        std::vector<std::uint32_t> drawn;
        if (settings_.shadows && slots_shared)
            for (std::uint32_t i = first; i < first + count; ++i)
                drawn.push_back(i);
        else if (settings_.shadows)
            drawn = to_draw_;
        if (!drawn.empty()) {
            SUNFLECK_TRY(shadow_maps_->add_passes(graph, gpu_scene, resources_, make_requests(drawn),
                                                  {.keep_static = false, .detail = false}, shadow_counters));
            scheduler_.done(drawn);
        }
        SUNFLECK_ASSIGN(const std::vector<LightBatch> batches, make_batches(first, count));
        SUNFLECK_TRY(brute_force_->add_pass(graph, g_buffer, camera, *shadow_maps_, batches, options, first == 0,
                                            first + count == total, output));
        first += count;
    } while (first < total);
    counters_.shadow_map_updates = shadow_counters.maps;
    counters_.shadow_map_faces = shadow_counters.faces;
    counters_.shadow_map_vertices = shadow_counters.vertices;
    return {};
}

Status System::add_many_light(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const GBufferInput& g_buffer,
                              const gpu::UploadSlice& camera, gpu::ResourceId output) {
    const auto start = std::chrono::steady_clock::now();
    ManyLightOptions options;
    options.shadows = settings_.shadows;
    options.filter = settings_.shadow_filter;
    options.visibility = settings_.visibility;
    options.light_maps = settings_.light_maps && settings_.visibility;
    // A host may draw the first maps over many frames (FrameInput::map_budget): baking begins when all are there.
    const auto waits = [this](std::uint32_t sample) {
        return scheduler_.is_static_stale(sample) && held_by_light_maps(samples_[sample]);
    };
    std::size_t waiting = 0;
    for (std::uint32_t sample = 0; sample < samples_.size(); ++sample)
        waiting += waits(sample);
    const std::size_t drawn = std::size_t(std::count_if(to_draw_.begin(), to_draw_.end(), waits));
    options.baked_light =
        settings_.baked_light && settings_.static_maps && waiting == drawn && shadow_maps_->slots() >= samples_.size();
    options.static_maps_changed = drawn > 0;
    options.scale = settings_.low_resolution;
    options.contrast = settings_.repair_contrast;
    options.normal_degrees = settings_.repair_angle;
    options.show = input_.show;
    SUNFLECK_TRY(many_light_->update(database_, curved_charts_, gpu_scene, samples_, rows_, options, input_.serial,
                                     input_.completed_serial, resources_));
    ShadowCounters shadow_counters;
    if (settings_.shadows && !to_draw_.empty()) {
        SUNFLECK_TRY(shadow_maps_->add_passes(graph, gpu_scene, resources_, make_requests(to_draw_),
                                              {.keep_static = settings_.static_maps, .detail = settings_.map_detail},
                                              shadow_counters));
        scheduler_.done(to_draw_);
    }
    SUNFLECK_ASSIGN(const std::vector<LightBatch> batches, make_batches(0, std::uint32_t(samples_.size())));
    options.simplified_movers = settings_.map_detail;
    options.stale_maps = settings_.shadows && scheduler_.stale() > 0;
    SUNFLECK_TRY(many_light_->add_passes(graph, g_buffer, camera, *shadow_maps_, batches, scheduler_.ages(), options,
                                         resources_, output));
    counters_.shadow_map_updates = shadow_counters.maps;
    counters_.shadow_map_faces = shadow_counters.faces;
    counters_.shadow_map_vertices = shadow_counters.vertices;
    counters_.visibility = database_.counters();
    counters_.surface_patches = database_.patches().leaves();
    counters_.light_map_updates = many_light_->light_maps().counters().updates;
    counters_.light_map_texels = many_light_->light_maps().counters().texels;
    counters_.baked_light_updates = many_light_->baked_light().counters().updates;
    counters_.baked_light_waiting = many_light_->baked_light().counters().waiting;
    counters_.pixels = many_light_->counters();
    count_passes();
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    cpu_times_["light lists"] += elapsed.count();
    return {};
}

// Nodes that left the view are drawn no longer; the rest keeps its elements from frame to frame.
void System::count_passes() {
    if (!settings_.count_passes || !input_.view_projection)
        return;
    if (!passes_ || passes_generation_ != database_.generation() || passes_lights_ != settings_.lights_per_pass ||
        passes_extras_ != settings_.pass_extras) {
        if (settings_.pass_extras)
            passes_ = std::make_unique<PassCover>(settings_.lights_per_pass);
        else
            passes_ = std::make_unique<PassOptimiser>(settings_.lights_per_pass);
        passes_generation_ = database_.generation();
        passes_lights_ = settings_.lights_per_pass;
        passes_extras_ = settings_.pass_extras;
        seen_nodes_.clear();
    }
    auto changed = tested_lights_of_visible_nodes(database_, *input_.view_projection, settings_.pass_extras);
    const auto seen = changed;
    for (const auto& [node, lights] : seen_nodes_) {
        const LightSet none(lights.needed.size(), 0);
        changed.try_emplace(node, PassLights{none, none});
    }
    passes_->update(changed);
    seen_nodes_ = seen;
    counters_.render_passes = passes_->passes();
    counters_.pass_fill = passes_->fill();
    counters_.render_passes_unoptimised = passes_->passes_unoptimised();
}

} // namespace sunfleck::gi
