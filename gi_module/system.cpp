#include "gi_module/system.h"

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
    std::uint64_t hash = 0xcbf29ce484222325ull;
    const auto add = [&](const void* data, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; ++i)
            hash = (hash ^ bytes[i]) * 0x100000001b3ull;
    };
    for (const Emitter& emitter : emitters) {
        add(&emitter.kind, sizeof emitter.kind);
        add(&emitter.entity, sizeof emitter.entity);
        add(&emitter.matrix, sizeof emitter.matrix);
        add(&emitter.flux, sizeof emitter.flux);
        add(&emitter.area, sizeof emitter.area);
        add(&emitter.inner_cosine, sizeof emitter.inner_cosine);
        add(&emitter.outer_cosine, sizeof emitter.outer_cosine);
    }
    return hash;
}

bool same_sampling(const Settings& a, const Settings& b) {
    return a.direct == b.direct && a.indirect == b.indirect && a.movers == b.movers && a.lights == b.lights &&
           a.direct_share == b.direct_share && a.bounces == b.bounces && a.seed == b.seed && a.sequence == b.sequence &&
           a.termination == b.termination;
}

} // namespace

std::span<const gpu::EmbeddedShader> shaders() {
    return gpu::sunfleck_gi_shaders();
}

Result<std::unique_ptr<System>> System::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<System> system(new System(device));
    SUNFLECK_ASSIGN(system->shadow_maps_, ShadowMaps::create(device, pipelines));
    SUNFLECK_ASSIGN(system->brute_force_, BruteForce::create(device, pipelines));
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
    settings_ = settings;
    return {};
}

bool System::needs_new_samples(const raytrace::RayScene& rays) {
    const std::uint64_t hash = hash_emitters(emitters_);
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
    const SampleBudget budget = divide_samples(settings_, emitters_);
    samples_ = sample_direct(emitters_, budget.direct, settings_, rays);
    const std::vector<LightSample> indirect = sample_indirect(emitters_, budget.indirect, settings_, rays);
    samples_.insert(samples_.end(), indirect.begin(), indirect.end());
    std::stable_sort(samples_.begin(), samples_.end(), [](const LightSample& a, const LightSample& b) {
        return light_class(a.kind) < light_class(b.kind);
    });
    for (std::uint32_t i = 0; i < samples_.size(); ++i)
        samples_[i].index = i;
    stale_.assign(samples_.size(), 1);
    mirror_samples(registry);
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

// A moved object touches the map of every sample that sees the box where it was, or the one where it is.
void System::mark_stale(const scene::GpuScene& gpu_scene) {
    std::vector<Bounds> touched = gpu_scene.removed_bounds();
    for (const scene::DrawItem& item : gpu_scene.draws())
        if (item.moved) {
            touched.push_back(item.bounds);
            if (!item.previous_bounds.empty())
                touched.push_back(item.previous_bounds);
        }
    for (std::uint32_t& age : stale_)
        age += age > 0 ? 1 : 0;
    if (touched.empty())
        return;
    for (std::uint32_t i = 0; i < samples_.size(); ++i) {
        if (stale_[i] > 0)
            continue;
        const ShadowRequest request{0, light_class(samples_[i].kind), row_of(i)};
        const bool sees = std::any_of(touched.begin(), touched.end(), [&](const Bounds& bounds) {
            return ShadowMaps::faces_that_see(request, bounds) != 0;
        });
        stale_[i] = sees ? 1 : 0;
    }
}

shared::LightRow System::row_of(std::uint32_t sample) const {
    const std::uint32_t slots = std::max(shadow_maps_->slots(), 1u);
    return make_light_row(samples_[sample], sample % slots, bound_, scene_bounds_);
}

Status System::update(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::GpuScene& gpu_scene,
                      raytrace::RayScene& rays, const FrameInput& input) {
    cpu_times_.clear();
    input_ = input;
    resources_.begin_frame(input.serial, input.completed_serial);
    const Bounds bounds = gpu_scene.bounds();
    {
        const StageTimer timer(cpu_times_, "light samples");
        emitters_ =
            collect_emitters(registry, meshes, gpu_scene.static_bounds().empty() ? bounds : gpu_scene.static_bounds());
        if (needs_new_samples(rays))
            make_samples(registry, rays);
    }
    const StageTimer timer(cpu_times_, "shadow scheduling");
    std::uint32_t surface_samples = 0;
    for (const LightSample& sample : samples_)
        surface_samples += sample.kind == SampleKind::surface;
    bound_ = gi::geometry_bound(surface_samples, rays.static_area(), settings_.clamp_scale);
    // The maps of directional lights cover the scene's bounds, so all maps follow a change of those.
    const bool bounds_changed = bounds.minimum != scene_bounds_.minimum || bounds.maximum != scene_bounds_.maximum;
    scene_bounds_ = bounds;
    if (settings_.shadows) {
        SUNFLECK_ASSIGN(const bool cleared,
                        shadow_maps_->configure(
                            settings_.shadow_map_resolution, settings_.shadow_map_bits, std::uint32_t(samples_.size()),
                            std::uint64_t(double(settings_.shadow_memory) * 1048576.0), resources_));
        if (cleared)
            std::fill(stale_.begin(), stale_.end(), 1u);
    }
    if (bounds_changed)
        for (std::size_t i = 0; i < samples_.size(); ++i)
            if (samples_[i].kind == SampleKind::directional)
                stale_[i] = std::max(stale_[i], 1u);
    mark_stale(gpu_scene);
    to_draw_ = choose_maps(input.map_budget);
    counters_ = {};
    counters_.light_samples = samples_.size();
    counters_.light_samples_direct = std::uint64_t(
        std::count_if(samples_.begin(), samples_.end(), [](const LightSample& s) { return s.bounce == 0; }));
    return {};
}

std::vector<std::uint32_t> System::choose_maps(std::uint32_t budget) {
    std::vector<std::uint32_t> chosen;
    if (!settings_.shadows)
        return chosen;
    for (std::uint32_t i = 0; i < samples_.size(); ++i)
        if (stale_[i] > 0)
            chosen.push_back(i);
    if (chosen.size() > budget) {
        std::stable_sort(chosen.begin(), chosen.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return stale_[a] > stale_[b]; });
        chosen.resize(budget);
        std::sort(chosen.begin(), chosen.end());
    }
    return chosen;
}

std::vector<ShadowRequest> System::make_requests(std::span<const std::uint32_t> samples) const {
    std::vector<ShadowRequest> requests;
    for (const std::uint32_t sample : samples)
        requests.push_back({sample % shadow_maps_->slots(), light_class(samples_[sample].kind), row_of(sample)});
    return requests;
}

Result<std::vector<LightBatch>> System::make_batches(std::uint32_t first, std::uint32_t count) {
    std::vector<LightBatch> batches;
    std::uint32_t place = first;
    do {
        LightBatch batch;
        batch.light_class = place < samples_.size() ? light_class(samples_[place].kind) : 0;
        SUNFLECK_ASSIGN(batch.rows, resources_.allocate(sizeof(shared::LightRow) * shared::lights_per_batch));
        while (place < first + count && batch.count < shared::lights_per_batch &&
               light_class(samples_[place].kind) == batch.light_class) {
            const shared::LightRow row = row_of(place++);
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
    const std::uint32_t total = std::uint32_t(samples_.size());
    const std::uint32_t slots = settings_.shadows ? std::max(shadow_maps_->slots(), 1u) : std::max(total, 1u);
    const bool slots_shared = total > slots;
    const bool one_batch = !slots_shared && total <= shared::lights_per_batch &&
                           (total == 0 || light_class(samples_.front().kind) == light_class(samples_.back().kind));
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
            SUNFLECK_TRY(shadow_maps_->add_passes(graph, gpu_scene, resources_, make_requests(drawn), shadow_counters));
            for (const std::uint32_t sample : drawn)
                stale_[sample] = 0;
        }
        SUNFLECK_ASSIGN(const std::vector<LightBatch> batches, make_batches(first, count));
        SUNFLECK_TRY(brute_force_->add_pass(graph, g_buffer, camera, *shadow_maps_, batches, options, first == 0,
                                            first + count == total, output));
        first += count;
    } while (first < total);
    counters_.shadow_map_updates = shadow_counters.maps;
    counters_.shadow_map_faces = shadow_counters.faces;
    counters_.shadow_map_vertices = shadow_counters.vertices;
    counters_.shadow_maps_stale =
        std::uint64_t(std::count_if(stale_.begin(), stale_.end(), [](std::uint32_t age) { return age > 0; }));
    return output;
}

} // namespace sunfleck::gi
