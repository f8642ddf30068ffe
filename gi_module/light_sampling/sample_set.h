// The light samples (virtual point lights, VPLs) of a scene: the one copy that all techniques read. It follows the
// registry: samples are generated again when the request, static emitters or static geometry changed; those of dynamic
// emitters (which move or vary) follow them.
//
// A set is a value that owns all it needs: the next one can be prepared from the same registry while another lights,
// and two systems can light one registry.
//
// Samples are sorted by light class, then static before dynamic ones, then by path (direct, first bounce, later
// bounces). A sample's index is its position in this order; shadow map, visibility rows and GPU rows follow it.
// Samples, indices and rows are stable until generation() changes.
#pragma once

#include "engine/scene/gpu_scene.h"
#include "gi_module/light_sampling/blocked_paths.h"
#include "gi_module/light_sampling/dynamic_lights.h"
#include "gi_module/light_sampling/mover_reflections.h"
#include "gi_module/light_sampling/sampling_settings.h"
#include "gi_module/transport/light_row.h"
#include "gi_module/transport/report.h"

#include <functional>
#include <map>
#include <set>
#include <span>

namespace sunfleck::gi {

// The scene to be lit. All parts must be up to date and outlive the call.
struct SceneView {
    ecs::Registry& registry;
    const scene::SceneChanges& changes; // that all below have followed
    const scene::MeshStore& meshes;
    const scene::GpuScene& gpu_scene;
    const raytrace::RayScene& rays;
};

class SampleSet {
public:
    struct UpdateOptions {
        // Nobody saw what the update before this one made, so dynamic samples go on from where they were before it.
        bool previous_lost = false;
        bool keep = false; // FrameInput::keep_samples
        // Called with the share that is done while samples of static emitters are generated, by the calling
        // thread. If it returns false, the update ends with an error, and the next one begins again.
        std::function<bool(float)> progress = {};
    };
    // Generates or moves samples. Call once a frame, then update_rows.
    Status update(const SceneView& scene, const SampleRequest& request, const LightSettings& settings,
                  const UpdateOptions& options);
    // Samples were kept that no longer fit.
    bool outdated() const { return outdated_; }
    // Fills the rows that shaders read. `slots`: shadow maps that fit into memory; sample i uses slot i % slots.
    struct Strengths {
        float indirect_scale = 1.0f;               // of reflected light
        std::uint32_t change_budget = 0xffffffffu; // FrameInput::strength_budget
        std::optional<vec3> eye{};                 // changes near it come first; none: in the order of samples
    };
    void update_rows(const SceneView& scene, const LightSettings& settings, std::uint32_t slots,
                     const Strengths& strengths);

    std::span<const LightSample> samples() const { return samples_; }
    std::span<const shared::LightRow> rows() const { return rows_; }
    std::uint32_t late_changes() const { return late_changes_; } // of strength, that wait for a later frame
    std::uint32_t size() const { return std::uint32_t(samples_.size()); }
    std::uint32_t light_class_of(std::uint32_t sample) const { return light_class(samples_[sample].kind); }
    std::uint32_t slot(std::uint32_t sample) const { return sample % slots_; }

    // Changes when the samples are generated again; unique among all sets of the process.
    std::uint64_t generation() const { return generation_; }
    // Dynamic samples whose position or direction changed in the last update.
    std::span<const std::uint32_t> moved() const { return moved_; }
    // Samples that stayed, but whose shadow map covers another region since the last update_rows: its static part is
    // invalid, too.
    std::span<const std::uint32_t> remapped() const { return remapped_; }
    // Whether a door or the like blocks the path of the sample's light.
    bool is_blocked(std::uint32_t sample) const { return blocked_paths_.is_blocked(sample); }

    // The bound that clamps the geometry term, 1/m2 (transport/clamping.h); single samples may have lower ones.
    float geometry_bound() const { return bound_; }

    // Of the same fixed emitters, as many as SamplingSettings::baked_samples: what light would be with so many. They
    // have no rows, and no shadow maps here.
    std::span<const LightSample> refining_samples() const { return refining_; }
    // Of the last update: those that stay as they are, and those that move or vary.
    std::span<const Emitter> fixed_emitters() const { return emitters_; }
    std::span<const Emitter> dynamic_emitters() const { return dynamic_emitters_; }
    // Emitters that do not move, but have changed their flux: the first change of one makes all samples again, later
    // ones only scale its own.
    const std::set<ecs::Entity>& varying_lights() const { return varying_; }
    // These count among them from now on: another set has seen them change.
    void expect_varying(const std::set<ecs::Entity>& lights);
    // Lights have moved or changed since they were first seen, and samples follow them. A start with the scene as it is
    // would share samples otherwise between lights, and those of light that stands still are medoids: fewer errors.
    bool follows_changes() const { return !varying_.empty() || followed_.lights.changed(); }

    static std::span<const Counter> counters();
    void report(Report& report) const;

private:
    // What samples were made for.
    struct Cause {
        std::uint64_t emitters = 0, geometry = 0; // hash; generation
        SampleRequest request;
        bool movers_reflect = false, valid = false;
    };
    void find_emitters(const SceneView& scene, const SampleRequest& request);
    Cause cause_of(const SampleRequest& request, const SceneView& scene) const;
    bool is_cause(const Cause& now) const;
    void keep_emitters(const std::vector<Emitter>& fixed, const std::vector<Emitter>& dynamic);
    bool find_varying(ecs::Registry& registry);
    Status make_samples(const SampleRequest& request, const SceneView& scene, const Cause& cause,
                        const std::function<bool(float)>& progress);
    void sort_samples();
    void take_over(std::uint32_t follower, const LightSample& now, bool moved);
    void follow_dynamic_lights(const raytrace::RayScene& rays);
    void follow_movers(const SceneView& scene, const LightSettings& settings);
    void take_over_movers(const raytrace::RayScene& rays, const LightSettings& settings);
    void find_let_through(const raytrace::RayScene& rays, const LightSettings& settings);
    void limit_changes(const std::vector<shared::LightRow>& before, const Strengths& strengths);
    void update_bounds(const SceneView& scene, const LightSettings& settings);
    float bound_of(const LightSample& sample, const LightSettings& settings) const;
    void find_loss(const SceneView& scene, const LightSettings& settings);

    std::vector<LightSample> samples_, refining_;
    std::vector<shared::LightRow> rows_;
    std::vector<Emitter> emitters_;         // static
    std::vector<Emitter> dynamic_emitters_; // that move or vary
    std::set<ecs::Entity> warned_of_;       // lights that are ignored
    std::set<ecs::Entity> varying_;         // do not move, but have changed their flux
    std::map<ecs::Entity, vec3> last_flux_; // of those that do not move
    // What dynamic samples come from; depends on the updates so far.
    struct Followed {
        DynamicLights lights;
        MoverReflections movers;
        // By sample of `lights`, then of `movers`: what its bound lets through; 0: not known. The rest is given back.
        std::vector<float> let_through;
        float let_through_bound = 0.0f;
        struct Disc {
            float bound = 0.0f, let_through = 0.0f;
        };
        std::vector<Disc> discs; // by sample of `movers`: the bound of its disc, and what that lets through
    };
    Followed followed_, followed_before_; // before: the last update
    BlockedPaths blocked_paths_;
    // Index of each dynamic sample among all: those of dynamic lights, then those of movers.
    std::vector<std::uint32_t> dynamic_samples_;
    std::vector<std::uint32_t> moved_, remapped_;
    scene::ChangeCursor emitter_cursor_; // of emitters_ and dynamic_emitters_
    Bounds emitter_bounds_;              // of the scene that they were found in
    scene::SceneSpace emitter_space_;    // and where they lie
    std::uint32_t punctual_lights_ = 0;  // and how many of them count as punctual
    bool emitters_as_static_ = false;    // and whether movers counted as static geometry
    Cause cause_;
    bool outdated_ = false;
    std::uint32_t slots_ = 1;
    std::uint64_t rows_generation_ = 0; // of the samples that rows_ is of
    std::vector<std::uint32_t> waited_; // by sample: updates that its change of strength has waited for
    std::uint32_t late_changes_ = 0;    // samples that wait for theirs
    std::uint64_t generation_ = 0;
    Bounds bounds_;                             // of the scene, at the last update_rows
    float bound_ = 0.0f, dynamic_bound_ = 0.0f; // of the geometry term
    // What the loss by the bound was found for.
    struct LossCause {
        std::uint64_t generation = 0;
        float bound = 0.0f, clamp_scale = 0.0f;
        bool operator==(const LossCause&) const = default;
    } loss_cause_;
    double loss_ = 0.0; // clamping_loss
};

} // namespace sunfleck::gi
