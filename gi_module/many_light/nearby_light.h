// Nearby light: what the bound of samples (VPLs; transport/clamping.h) takes from light in corners and under things,
// found by rays and given back (T. Kollig and A. Keller, "Illumination in the Presence of Weak Singularities", 2004).
//
// Of the light that a surface reflects, a sample's term G = cos cos / d^2 is bounded by b. What is missing at a point,
//     (1 / pi) * integral of albedo * E * max(0, 1 - b / G) * cos over the directions,
// comes from surfaces nearer than sqrt(1 / b), where E, the irradiance there, is what the samples give at the nearest
// texel of baked light. It is computed for the texels alone, in two rounds: the second adds what nearby surfaces
// themselves receive from nearby. What is there does not flicker or cost anything afterwards: it is a part of refined
// light. A third round looks for texels that hardly any of a frame's samples reaches, and finds the one of which they
// take most.
//
// Rays are few and the same for all texels, so that they leave no noise; what they meet is found once, on the CPU, a
// portion in a frame, and kept for the other rounds. Surfaces that have no texels are taken to be as bright as the
// texel that sees them. Emitters' own samples are not looked at: there are many of them on a small surface.
#pragma once

#include "gi_module/many_light/baked_light.h"
#include "gi_module/many_light/nearby_light_shared.h"

#include "engine/gpu/pipeline.h"
#include "gi_module/light_sampling/light_at_points.h"

#include <optional>

namespace sunfleck::gi {

struct NearbyLightScene {
    const VisibilityDatabase& database;
    const CurvedCharts& curved;
    const raytrace::RayScene& rays;
    Bounds bounds;                             // of all geometry
    std::span<const BakedLight::Piece> pieces; // of baked light
    std::uint64_t texels = 0;                  // of them all
    float inset = 0.0f;                        // columns that a patch's outermost texels are moved inwards
};

struct NearbyLightCause {
    float bound = 0.0f;       // of samples' terms, 1/m2; 0: nothing is given back
    float reflected = 1.0f;   // share of irradiance that is reflected once more: bounces are limited
    float fixed_point = 1.0f; // steps of sums, per W/m2
};

class NearbyLight {
public:
    // `others`: light that no texel of baked light holds, of suns, spots and points.
    void begin(const NearbyLightScene& scene, const NearbyLightCause& cause, std::vector<IncomingLight> others);
    // From now on there is nothing to do.
    void forget();
    // Whether light is still to be added to the sums, or sources to be found, which comes after ratios are made.
    bool light_waits() const { return round_ < sources; }
    bool sources_wait() const { return round_ == sources; }
    // Call it before the frame's update. What is no longer needed is dropped.
    void end_frame();
    // The next portion of the round: so many rays, more or less.
    void update(const NearbyLightScene& scene, std::uint64_t rays);
    bool has_work() const { return copies_ || portion_ != nullptr; }
    struct Target {
        const gpu::Buffer& sums;     // refined, by texel, in steps
        const gpu::Buffer& own_sums; // of the frame's samples; until those are summed, what the first round makes
        const gpu::Buffer& texels;   // RefinedLight::texels
        float own_steps = 1.0f;      // RefinedLightConstants
    };
    // Adds the passes of the frame's portion; nothing if it has none.
    Status add_passes(gpu::FrameGraph& graph, gpu::PipelineStore& pipelines, const Target& target,
                      gpu::FrameResources& resources) const;

private:
    struct Portion {
        std::vector<shared::NearbyRow> rows;
        std::vector<shared::NearbyEntry> entries;
        void append(const Portion& other);
    };
    struct Texel {
        vec3 position{0.0f}, normal{0.0f}, geometric_normal{0.0f};
        std::uint32_t index = 0; // of all
    };
    struct Seen {
        std::uint32_t texel = 0;
        vec3 weight{0.0f};
    };
    std::optional<Texel> texel_of(const NearbyLightScene& scene, const BakedLight::Piece& piece,
                                  std::uint32_t place) const;
    std::optional<std::uint32_t> texel_at(const NearbyLightScene& scene, const raytrace::SurfacePoint& point) const;
    void look(const NearbyLightScene& scene, const Texel& texel, Portion& portion) const;
    vec3 light_of_others(const NearbyLightScene& scene, vec3 point, vec3 normal, std::uint32_t turn) const;
    Portion find(const NearbyLightScene& scene, std::uint64_t texels);

    NearbyLightCause cause_;
    std::vector<IncomingLight> others_;
    std::vector<std::uint32_t> piece_of_; // by node, of flat ones
    std::vector<vec2> directions_;        // pairs of numbers in [0, 1)
    std::vector<Portion> portions_;       // all that is found
    enum Round : std::uint32_t { first_light, second_light, sources, finished };
    std::uint32_t round_ = finished;
    std::size_t next_ = 0;         // piece of the first round, portion of others
    std::uint32_t next_texel_ = 0; // of the piece
    // Of the frame.
    bool copies_ = false;
    std::uint32_t frame_round_ = finished;
    Portion found_;
    const Portion* portion_ = nullptr;
};

} // namespace sunfleck::gi
