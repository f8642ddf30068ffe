// What a user can set about light samples (VPLs): how many there are and where they come from; how they become lights.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

// Flag of fields (Field::flags): a change of the field's value makes new samples. A test holds all fields to it.
inline constexpr std::uint32_t needs_new_samples = 1u << 0;

enum class Sequence : std::uint32_t { pseudo_random, sobol };
enum class Termination : std::uint32_t { bounce_limit, russian_roulette };

struct SamplingSettings {
    std::uint32_t source = 0;   // index into sample_sources() (sample_source.h)
    std::uint32_t lights = 300; // light samples, exactly
    float direct_share = 0.25f; // of the samples, for light from area emitters
    // Of the samples, for emitters that move or vary, if there are any; they divide it by flux.
    float dynamic_share = 0.15f;
    std::uint32_t bounces = 5; // reflections before the surface that is shown
    std::uint32_t seed = 1;
    Sequence sequence = Sequence::sobol;
    Termination termination = Termination::russian_roulette;
    // Reflected samples are chosen from so many times as many (sample_clusters.h); 1: as random walks leave them.
    std::uint32_t candidates = 64;
    float spread = 0.5f;

    static const TypeDescription& description();
};

// What is sampled: the settings, and which light anybody wants at all.
struct SampleRequest : SamplingSettings {
    bool direct = true;
    bool indirect = true;
    bool movers_are_static = false; // random walks meet movers as if they were static geometry

    SampleRequest() = default;
    explicit SampleRequest(const SamplingSettings& settings) : SamplingSettings(settings) {}
    // Whether both give the same samples in the same scene.
    bool same_samples(const SampleRequest& other) const;
};

// How samples are turned into lights. A change takes effect with the same samples.
struct LightSettings {
    bool mover_paths = true; // large boxes that move, as doors do, block the light that samples reflect
    float clamp_scale = 1.0f;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi
