// Everything about the lighting that a user can set, described once: the command line's --set, scene files and editors
// read the descriptions.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::gi {

enum class DirectTechnique : std::uint32_t { brute_force, none };
enum class IndirectTechnique : std::uint32_t { brute_force, none };
enum class Sequence : std::uint32_t { pseudo_random, sobol };
enum class Termination : std::uint32_t { bounce_limit, russian_roulette };
enum class MoverHandling : std::uint32_t { per_pixel, as_static };

struct Settings {
    DirectTechnique direct = DirectTechnique::brute_force;
    IndirectTechnique indirect = IndirectTechnique::brute_force;
    MoverHandling movers = MoverHandling::per_pixel;

    std::uint32_t lights = 300; // light samples, exactly
    float direct_share = 0.25f; // of the samples, for light from area emitters
    std::uint32_t bounces = 5;  // reflections before the surface that is shown
    std::uint32_t seed = 1;
    Sequence sequence = Sequence::sobol;
    Termination termination = Termination::russian_roulette;

    std::uint32_t shadow_map_resolution = 256;
    std::uint32_t shadow_map_bits = 16;
    float shadow_memory = 512.0f; // MiB
    bool shadow_filter = false;
    bool shadows = true;
    float clamp_scale = 1.0f;
    bool count_clamped = false;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi
