// A texel of refined light: how bright it is, compared with the frame's samples' light at a texel of baked light, which
// is itself or, where hardly any of these samples arrives, one that it sees.
#include "engine/core/shared_exponent.h"

struct RefinedTexel {
    vec3 ratio;
    int source;
};

const float largest_ratio = 64.0;
const float few_steps = 4.0; // of either sum: less is rounding

// `own`, of the source, and `refined` in steps; `own_steps`: RefinedLightConstants.
uvec2 refined_texel(ivec3 own, ivec3 refined, float own_steps, uint source) {
    const float rounding = few_steps * max(own_steps, 1.0);
    const vec3 ratio = (vec3(refined) * own_steps + rounding) / (vec3(own) + rounding);
    return uvec2(pack_shared_exponent(min(ratio, largest_ratio)), source);
}

RefinedTexel to_refined_texel(uvec2 bits) { return RefinedTexel(unpack_shared_exponent(bits.x), int(bits.y)); }
