// What a place of the picture shows, and what lights it: for the editor's inspection, and whoever else explains one.
#pragma once

#include "viewer/scene_renderer.h"

namespace sunfleck::viewer {

// What is known of the light samples' ways to a place, and of their shadow maps.
struct SampleState {
    gi::PairState between = gi::PairState::partial; // where the visibility database is in use
    std::vector<gi::VisibilityDatabase::Blocker> blockers;
    gi::MapState map;
};

struct PixelReport {
    ecs::Entity entity; // null: there is no surface
    vec3 position{0.0f};
    vec3 normal{0.0f}, geometric_normal{0.0f}; // on the side that is seen
    float distance = 0.0f;                     // from the camera, m
    scene::Material material;                  // at this place: with its textures
    bool moves = false;                        // it counts as a mover
    // By technique, in the order in which they add their light. Places are in the world.
    std::vector<gi::ExplainedLight> light;
    // The surface patch of the visibility database that it lies on, or the mover; none: the database is not in use, or
    // does not know the place.
    struct Patch {
        std::uint32_t node = 0;
        std::uint32_t level = 0;        // of subdivision
        gi::VisibilityCounters samples; // by state
    };
    std::optional<Patch> patch;
    std::vector<SampleState> samples; // by light sample

    vec3 irradiance() const; // W/m2: the sum of all shares
    // The material's fields with names, values and units, as texts.
    struct Value {
        std::string name, value, unit;
    };
    std::vector<Value> material_values() const;
};

// The same place, for gi::System::fill_listing; none: there is no surface.
std::optional<gi::ListedPlace> place_in_view(SceneRenderer& renderer, vec3 origin, vec3 direction);

// What the ray meets first, as of the renderer's last update. `direction`: of any length.
PixelReport report_pixel(SceneRenderer& renderer, vec3 origin, vec3 direction);

} // namespace sunfleck::viewer
