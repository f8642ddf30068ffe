// The visibility database of a scene, kept in step with it: built when samples, static geometry or options changed, and
// following movers in every frame.
#pragma once

#include "engine/core/stage_times.h"
#include "engine/scene/gpu_scene.h"
#include "engine/scene/scene_changes.h"
#include "gi_module/transport/report.h"
#include "gi_module/visibility/visibility_database.h"
#include "gi_module/visibility/visibility_settings.h"

#include <functional>
#include <optional>

namespace sunfleck::gi {

struct VisibilityInput {
    ecs::Registry& registry;
    const scene::SceneChanges& changes; // that meshes and GPU scene have followed
    const scene::MeshStore& meshes;
    const scene::GpuScene& gpu_scene;
    std::span<const LightSample> samples;
    std::uint64_t sample_generation = 0;
    std::span<const std::uint32_t> moved_samples;
    bool static_changed = false; // static geometry did
    // Whether a mover is lit by a technique that needs nothing of the database; null: none is.
    std::function<bool(const scene::DrawItem&)> lit_elsewhere;
    std::uint64_t lighting_generation = 0;              // another number: lit_elsewhere may answer differently
    std::function<bool(float)> progress;                // of building
    StageTimes& cpu_times;                              // stages within the caller's
    std::uint64_t max_buffer_bytes = ~std::uint64_t(0); // that the device lets shaders see at once
};

class SceneVisibility {
public:
    Status update(const VisibilitySettings& settings, const VisibilityInput& input);
    // Nobody needs it: the next update builds it from scratch.
    void forget() { sample_generation_ = 0; }

    VisibilityDatabase& database() { return database_; }
    const VisibilityDatabase& database() const { return database_; }

    static std::span<const Counter> counters();
    void report(Report& report) const;

private:
    bool find_movers(const VisibilityInput& input, bool all);

    VisibilityDatabase database_;
    std::optional<VisibilityOptions> options_; // that it was built with
    std::uint64_t sample_generation_ = 0;      // of the samples that it knows; 0: none
    scene::ChangeCursor mover_cursor_;
    std::vector<MoverPlace> movers_; // of this frame's changes
    std::vector<ecs::Entity> gone_;
    std::uint64_t lighting_generation_ = 0;
};

} // namespace sunfleck::gi
