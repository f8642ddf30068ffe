// Unit vectors as two numbers: the octahedral map of Q. Meyer et al., "On Floating-Point Normal Vectors", 2010.
#ifndef SUNFLECK_ENGINE_CORE_OCTAHEDRAL_H
#define SUNFLECK_ENGINE_CORE_OCTAHEDRAL_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// Unit vector to the square [-1, 1]^2.
SHARED_FUNCTION vec2 octahedral_encode(vec3 n) {
    float scale = 1.0f / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 p = vec2(n.x, n.y) * scale;
    if (n.z < 0.0f)
        p = vec2((1.0f - abs(p.y)) * (p.x >= 0.0f ? 1.0f : -1.0f), (1.0f - abs(p.x)) * (p.y >= 0.0f ? 1.0f : -1.0f));
    return p;
}

SHARED_FUNCTION vec3 octahedral_decode(vec2 p) {
    vec3 n = vec3(p.x, p.y, 1.0f - abs(p.x) - abs(p.y));
    float fold = max(-n.z, 0.0f);
    n.x += n.x >= 0.0f ? -fold : fold;
    n.y += n.y >= 0.0f ? -fold : fold;
    return normalize(n);
}

// 16 bits per component: half a step of 1/32767 in both, times sqrt(3/2) along z, over the octahedron's inradius
// sqrt(1/3): the direction is off by less than 7e-5 rad.
SHARED_FUNCTION uint pack_normal(vec3 n) {
    return packSnorm2x16(octahedral_encode(n));
}
SHARED_FUNCTION vec3 unpack_normal(uint bits) {
    return octahedral_decode(unpackSnorm2x16(bits));
}

SHARED_END
#endif
