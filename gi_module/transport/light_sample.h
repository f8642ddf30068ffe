// A light sample (virtual point light, VPL): the common currency of all techniques. Thesis sec. 4.1.
#pragma once

#include "engine/scene/components.h"

#include <array>

namespace sunfleck::gi {

enum class SampleKind : std::uint32_t {
    surface,     // a point of a Lambertian surface: radiates flux / pi * cos(theta) about `normal`, one side only
    point,       // radiates flux / (4 pi) in all directions
    spot,        // radiates `flux` (here: intensity on the axis, W/sr) in a cone about `normal`
    directional, // parallel light along `normal`; `flux` is the irradiance on a facing plane, W/m2
};

// `flux` is already divided by the number of samples that share an emitter or a set of random walks: the irradiance at
// a point is the plain sum over all samples. Nothing else is folded in (no pi, no albedo of the receiver).
struct LightSample {
    SampleKind kind = SampleKind::surface;
    vec3 position{0.0f};
    vec3 normal{0.0f, 1.0f, 0.0f}; // unit; axis of spot and directional lights (direction of travel)
    vec3 flux{0.0f};               // W; see the kinds above for spot and directional
    std::uint32_t bounce = 0;      // reflections so far: 0 is direct light
    float cone_scale = 0.0f;       // spot: intensity factor is clamp(cos * scale + offset, 0, 1)^2
    float cone_offset = 0.0f;
    float radius = 0.0f;     // of the disc of surface that it represents, m; 0: the same for all samples (clamping.h)
    std::uint32_t index = 0; // stable: shadow map slot, GPU row and random sequence follow it
    ecs::Entity emitter;
    // Reflected light of static emitters: the vertices of its path, from the emitter on; of a long path, the last ones.
    // The last segment ends in `position`.
    static constexpr std::uint32_t max_path_vertices = 6;
    std::array<vec3, max_path_vertices> path{};
    std::uint32_t path_vertex_count = 0;
    // All light of a sun, point light or spot that the light plan counts as punctual.
    bool punctual = false;
    // Its emitter moves or varies: it is never in light maps, and its visibility is computed for whole charts only.
    bool dynamic = false;
    // It lies on a mover, `emitter`, and follows some frames behind, or within one that shines: the mover casts no
    // shadow in this light.
    bool on_mover = false;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi
