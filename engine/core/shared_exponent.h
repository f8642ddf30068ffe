// Three values from 0 up in 32 bits: 9 bits each and a common exponent (the format of EXT_texture_shared_exponent). The
// largest is off by at most 1/512 of itself; values are at least 2^-24 and less than 2^16.
#ifndef SUNFLECK_ENGINE_CORE_SHARED_EXPONENT_H
#define SUNFLECK_ENGINE_CORE_SHARED_EXPONENT_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_FUNCTION uint pack_shared_exponent(vec3 value) {
    vec3 bounded = clamp(value, vec3(0.0f), vec3(65408.0f)); // NaN becomes one of the bounds
    float largest = max(max(bounded.x, bounded.y), bounded.z);
    float exponent = max(floor(log2(max(largest, 1e-30f))), -16.0f) + 16.0f;
    if (largest * exp2(24.0f - exponent) >= 511.5f)
        exponent += 1.0f;
    vec3 mantissa = min(floor(bounded * exp2(24.0f - exponent) + 0.5f), vec3(511.0f));
    return uint(mantissa.x) | (uint(mantissa.y) << 9u) | (uint(mantissa.z) << 18u) | (uint(exponent) << 27u);
}

SHARED_FUNCTION vec3 unpack_shared_exponent(uint bits) {
    return vec3(float(bits & 511u), float((bits >> 9u) & 511u), float((bits >> 18u) & 511u)) *
           exp2(float(bits >> 27u) - 24.0f);
}

SHARED_END
#endif
