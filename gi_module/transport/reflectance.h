// How much light a material reflects: what light walks, which know no direction of view, reflect diffusely, and what
// the path tracer's scattering functions are normalised by. Said here once, so that both have the same energy.
//
// A material is glTF 2.0's (appendix B): a mix, by `metallic`, of a metal and of a Lambertian base under a dielectric
// coat. Metal and coat are GGX microfacets. A single reflection at those loses what meets a second facet, up to 54 % at
// a roughness of 1; it is given back as C. Kulla and A. Conty have it ("Revisiting Physically Based Shading at
// Imageworks", 2017), and the base receives and returns what the coat lets through, by the same reciprocal form
// (C. Kelemen and L. Szirmay-Kalos, 2001). A white surface in a white surrounding is then exactly as bright as that.
#pragma once

#include "engine/scene/components.h"
#include "gi_module/transport/facets_shared.h"

#include <span>

namespace sunfleck::gi {

// A GGX layer with Schlick's Fresnel term. All angles as the cosine to the normal, in [0, 1].
class GgxLayer {
public:
    // `reflectance`: at normal incidence. `roughness`: as in glTF; its square is the width of the distribution.
    GgxLayer(vec3 reflectance, float roughness);

    float alpha() const { return alpha_; }
    vec3 fresnel(float cosine) const;
    // Share of light from `cosine` that single reflections reflect in all directions.
    vec3 single_albedo(float cosine) const;
    // The same for any number of reflections.
    vec3 albedo(float cosine) const;
    // Of light that comes from all directions alike.
    vec3 mean_albedo() const { return mean_albedo_; }
    // The scattering function of reflections after the first, 1/sr, without the cosine.
    vec3 multiple(float outgoing, float incoming) const;

private:
    vec3 reflectance_;
    float alpha_;
    float mean_lost_; // share of light that leaves unperturbed mirrors' single reflections out, in the mean
    vec3 given_back_; // of what single reflections lose
    vec3 mean_albedo_;
};

// What GgxLayer looks up, for shaders; facets_shared.h says how it is laid out. Made at the first call, in any thread.
std::span<const vec2> facet_table();

// Reflectance of a dielectric at normal incidence.
float dielectric_reflectance(float index_of_refraction);

// Unpolarised Fresnel reflectance of a dielectric; eta: index on the far side over that on the near side.
float fresnel_dielectric(float cosine, float eta);

// Share of light from all directions alike that the material reflects, colour by colour. Transmission counts as
// reflection by the base: light walks do not enter glass.
vec3 mean_reflectance(const scene::Material& material);

// Smallest width of the distribution: smoother surfaces are lit as this one.
inline constexpr float smallest_alpha = 1e-3f;

} // namespace sunfleck::gi
