// Pixel lights on the CPU: what a surface makes of light that meets it, and rows for shaders.
#pragma once

#include "gi_module/transport/light_row.h"
#include "gi_module/transport/pixel_light_shared.h"

namespace sunfleck::gi {

// Times what a pixel light's surface alone could give at most, which bounds its irradiance. In the mean over all places
// that a light could have, a bound of once that takes more from corners (arena, 1,024 lights: 0.3 % of the light).
inline constexpr float splat_clamp_scale = 2.0f;

struct PixelLight {
    vec3 position{0.0f};
    vec3 normal{0.0f, 1.0f, 0.0f}; // unit, on the side that the light comes from
    vec3 axis{0.0f, 1.0f, 0.0f};   // of the lobe, unit
    float exponent = 1.0f;         // 1: diffuse
    vec3 flux{0.0f};               // W
    float area = 0.0f;             // of the surface that it stands for, m2
    // Of the surface that it stands for: how place and axis change from edge to edge in two directions, m and rad.
    // All zero: not known, the lobe is that of eq. 3.
    vec3 wide[2]{vec3(0.0f), vec3(0.0f)}, turned[2]{vec3(0.0f), vec3(0.0f)};
    bool dynamic = false; // its emitter, or the surface that it lies on, moves or varies
};

// What a material reflects of light from one direction, as shares of its flux.
struct LobeReflectance {
    vec3 diffuse{0.0f};
    vec3 glossy{0.0f};
    float exponent = 1.0f; // of the glossy lobe, about the mirror direction
};

// `cosine`: of the angle of incidence. Lobes nearly as wide as a diffuse one count as diffuse.
LobeReflectance lobe_reflectance(const scene::Material& material, float cosine);

// The exponent of the lobe that a GGX distribution of this width reflects at normal incidence: near the mirror
// direction both fall as a Gaussian of the same width.
float lobe_exponent(float alpha);

// By how much a diffuse light of that area is softened (softened_term), m; best for a `clamp_scale` of 2.
float pixel_light_softness(float area, float clamp_scale);

// Rows of lights whose flux is not finite or not positive are dark. `clamp_scale`: see transport/clamping.h, with the
// light's own area. `least`: irradiance, W/m2, below which light may be cut; 0: nowhere.
shared::PixelLightRow make_pixel_light_row(const PixelLight& light, std::uint32_t slot, float clamp_scale, float least);

} // namespace sunfleck::gi
