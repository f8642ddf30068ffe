// Filmic tone curve and sRGB transfer, shared by shaders and C++ (the reference writes PNGs too).
#ifndef SUNFLECK_ENGINE_RENDER_TONE_MAP_H
#define SUNFLECK_ENGINE_RENDER_TONE_MAP_H
#include "engine/core/srgb.h"
SHARED_BEGIN

// Factor from scene radiance, W/(sr m2), to the exposed value that the tone curve takes: luminous efficacy 683 lm/W
// over the saturation luminance 1.2 * 2^EV100 (ISO 12232 with q = 0.65).
SHARED_FUNCTION float exposure_factor(float ev100) {
    return 683.0f / (1.2f * exp2(ev100));
}

// Rational fit of the ACES filmic curve: K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2016.
SHARED_FUNCTION vec3 filmic_curve(vec3 x) {
    return clamp((x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f), vec3(0.0f), vec3(1.0f));
}

// IEC 61966-2-1, per channel: 1.055 x^(1/2.4) - 0.055, from 0.0031308 to 1 as the best polynomial in the fourth root,
// which is off by at most 3.5e-5 (a hundredth of an 8-bit step) and costs a third of the power.
SHARED_FUNCTION float srgb_from_linear(float x) {
    const float t = sqrt(sqrt(max(x, 0.0f)));
    const float curve =
        -0.0646115374f + t * (0.196135863f + t * (1.12268163f + t * (-0.335501569f + t * 0.081329981f)));
    return x <= 0.0031308f ? 12.92f * x : curve;
}

SHARED_FUNCTION vec3 srgb_from_linear_colour(vec3 c) {
    return vec3(srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z));
}

SHARED_FUNCTION vec3 linear_from_srgb_colour(vec3 c) {
    return vec3(linear_from_srgb(c.x), linear_from_srgb(c.y), linear_from_srgb(c.z));
}

SHARED_FUNCTION vec3 shown_from_radiance(vec3 radiance, float exposure) {
    return filmic_curve(max(radiance, vec3(0.0f)) * exposure);
}

SHARED_FUNCTION vec3 display_from_radiance(vec3 radiance, float exposure) {
    return srgb_from_linear_colour(shown_from_radiance(radiance, exposure));
}

// Of a display colour, by which anti-aliasing tells edges: every primary counts enough for one beside black to be one.
SHARED_FUNCTION float display_brightness(vec3 colour) {
    return 0.3f * colour.x + 0.5f * colour.y + 0.2f * colour.z;
}

// The radiance that a picture shows as the linear colour `shown`, 0 to 1.
SHARED_FUNCTION vec3 radiance_from_display(vec3 shown, float exposure) {
    const vec3 y = clamp(shown, vec3(0.0f), vec3(0.999f));
    const vec3 a = vec3(2.51f) - 2.43f * y, b = vec3(0.03f) - 0.59f * y;
    return (sqrt(b * b + 0.56f * a * y) - b) / (2.0f * a) / exposure;
}

SHARED_END
#endif
