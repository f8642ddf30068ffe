// Settings of light samples (VPLs): how many there are, how they are generated, and how they become lights.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

// Flag of a field (Field::flags): when its value changes, samples are generated again. A test checks this for all
// fields.
inline constexpr std::uint32_t needs_new_samples = 1u << 0;

enum class Sequence : std::uint32_t { pseudo_random, sobol };
enum class Termination : std::uint32_t { bounce_limit, russian_roulette };
// used: direct samples only where a technique lights direct light, and reflected ones likewise, so that none is wasted.
// all: both, whatever the light plan says, so that plans can be compared by the same samples.
enum class SampledLight : std::uint32_t { used, all };

struct SamplingSettings {
    std::uint32_t source = 0;   // index into sample_sources() (sample_source.h)
    std::uint32_t lights = 300; // light samples, exactly
    // Further samples of static emitters: light that is baked is refined by them, and they cost frames nothing once it
    // is. 0: it is that of `lights`.
    std::uint32_t baked_samples = 0;
    float direct_share = 0.25f; // of the samples, for direct light
    // Of the samples, for dynamic emitters, if there are any; they divide it by flux.
    float dynamic_share = 0.15f;
    // Of the samples, for light that movers reflect, if there are any. A tenth is enough for a few movers and takes a
    // tenth to a fifth of the frame's time.
    float mover_share = 0.0f;
    std::uint32_t punctual_lights = 8; // suns, point lights and spots that count as punctual light, brightest first
    std::uint32_t bounces = 5;         // reflections before the visible surface
    std::uint32_t seed = 1;
    Sequence sequence = Sequence::sobol;
    Termination termination = Termination::russian_roulette;
    // So many times the reflected samples are drawn and then clustered (sample_clusters.h); 1: no clustering.
    std::uint32_t candidates = 64;
    float spread = 0.5f; // of the clusters: 0 by flux, 1 by surface
    SampledLight sampled_light = SampledLight::used;

    static const TypeDescription& description();
};

// What is sampled: the settings, and which light any technique needs.
struct SampleRequest : SamplingSettings {
    bool direct = true;
    bool indirect = true;
    bool movers_are_static = false; // random walks hit movers as if they were static geometry

    SampleRequest() = default;
    explicit SampleRequest(const SamplingSettings& settings) : SamplingSettings(settings) {}
    // Whether both give the same samples in the same scene.
    bool same_samples(const SampleRequest& other) const;
};

// How samples are turned into lights. A change takes effect with the same samples.
struct LightSettings {
    bool mover_paths = true; // large boxes that move, such as doors, block the paths of reflected samples
    float clamp_scale = 1.0f;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi
