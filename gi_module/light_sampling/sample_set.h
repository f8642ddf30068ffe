// The light samples (VPLs) of a scene: the one copy that all techniques read. It follows the registry: samples are made
// when the request, emitters that stay, or static geometry changed; those of emitters that move or vary follow them.
//
// A set is a value that owns all it needs: a next one can be prepared from the same registry while another lights, and
// two systems can light one registry.
//
// Samples are sorted by light class, then those that stay before dynamic ones, then direct before reflected; a sample's
// index is its place, and shadow map, visibility rows and GPU rows follow it. Samples, indices and rows are stable
// until generation() changes.
#pragma once

#include "engine/scene/gpu_scene.h"
#include "gi_module/light_sampling/blocked_paths.h"
#include "gi_module/light_sampling/dynamic_lights.h"
#include "gi_module/light_sampling/sampling_settings.h"
#include "gi_module/transport/light_row.h"
#include "gi_module/transport/report.h"

#include <map>
#include <set>
#include <span>

namespace sunfleck::gi {

// What is lit, as the engine has it. All must be up to date and outlive the call.
struct SceneView {
    ecs::Registry& registry;
    const scene::MeshStore& meshes;
    const scene::GpuScene& gpu_scene;
    const raytrace::RayScene& rays;
};

class SampleSet {
public:
    // Makes or moves samples. Call once a frame, then update_rows.
    void update(const SceneView& scene, const SampleRequest& request);
    // What shaders see of the samples. `slots`: shadow maps that memory holds; sample i uses slot i % slots.
    // Reflected light is multiplied by `indirect_scale`.
    void update_rows(const SceneView& scene, const LightSettings& settings, std::uint32_t slots, float indirect_scale);

    std::span<const LightSample> samples() const { return samples_; }
    std::span<const shared::LightRow> rows() const { return rows_; }
    std::uint32_t size() const { return std::uint32_t(samples_.size()); }
    std::uint32_t light_class_of(std::uint32_t sample) const { return light_class(samples_[sample].kind); }
    std::uint32_t slot(std::uint32_t sample) const { return sample % slots_; }

    // Another number means other samples altogether; unique among all sets of the process.
    std::uint64_t generation() const { return generation_; }
    // Dynamic samples whose place or direction changed in the last update.
    std::span<const std::uint32_t> moved() const { return moved_; }
    // Samples that stayed, but whose shadow map covers something else since the last update_rows: its static part is
    // void, too.
    std::span<const std::uint32_t> remapped() const { return remapped_; }
    // Whether a door or the like keeps the sample's light from it.
    bool is_blocked(std::uint32_t sample) const { return blocked_paths_.is_blocked(sample); }

    // The bound of the geometry term in use, 1/m2 (transport/clamping.h); single samples may have lower ones.
    float geometry_bound() const { return bound_; }

    static std::span<const Counter> counters();
    void report(Report& report) const;

private:
    void find_emitters(const SceneView& scene, const SampleRequest& request);
    bool find_varying(ecs::Registry& registry);
    bool needs_new_samples(const SampleRequest& request, const raytrace::RayScene& rays);
    void make_samples(const SampleRequest& request, const raytrace::RayScene& rays);
    void sort_samples();
    void follow_dynamic_lights(const raytrace::RayScene& rays);

    std::vector<LightSample> samples_;
    std::vector<shared::LightRow> rows_;
    std::vector<Emitter> emitters_;         // whose samples stay
    std::vector<Emitter> dynamic_emitters_; // that move or vary
    std::set<ecs::Entity> varying_;         // do not move, but have changed their strength
    std::map<ecs::Entity, vec3> last_flux_; // of those that do not move
    DynamicLights dynamic_lights_;
    BlockedPaths blocked_paths_;
    std::vector<std::uint32_t> dynamic_samples_; // place of each dynamic sample among all
    std::vector<std::uint32_t> moved_, remapped_;
    SampleRequest sampled_; // what the samples were made for
    std::uint32_t slots_ = 1;
    bool valid_ = false;
    std::uint64_t generation_ = 0, geometry_generation_ = 0, emitter_hash_ = 0;
    Bounds bounds_; // of the scene, at the last update_rows
    float bound_ = 0.0f;
};

} // namespace sunfleck::gi
