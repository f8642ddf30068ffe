// What a surface of microfacets reflects, for shaders and C++ alike: the layers of transport/reflectance.h, seen from
// one direction. Lights are summed by the lobe of single reflections; whatever else the surface reflects is diffuse
// enough to be a share of its irradiance.
#ifndef SUNFLECK_GI_TRANSPORT_FACETS_SHARED_H
#define SUNFLECK_GI_TRANSPORT_FACETS_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// The table of what single reflections reflect (facet_table() in reflectance.h): a row for each roughness, a column for
// each square root of the cosine, then the mean over all directions. Value: what a surface of reflectance F at normal
// incidence reflects is F * x + y.
SHARED_CONSTANT uint facet_roughnesses = 32u;
SHARED_CONSTANT uint facet_cosines = 48u;
SHARED_CONSTANT uint facet_columns = facet_cosines + 1u;

// Share that reflections after the first give back of what single ones lose. C. Kulla and A. Conty, "Revisiting
// Physically Based Shading at Imageworks", 2017. `reflectance`: at normal incidence; `mean`: of the table.
SHARED_FUNCTION vec3 facets_given_back(vec3 reflectance, vec2 mean) {
    vec3 average = reflectance + (vec3(1.0f) - reflectance) / 21.0f; // Schlick's term in the mean over all directions
    float whole = mean.x + mean.y;
    return average * average * whole / (vec3(1.0f) - average * (1.0f - whole));
}

// A surface as it is seen from one direction.
struct Facets {
    vec3 at_normal;   // reflectance of its facets at normal incidence
    float at_grazing; // and at grazing incidence
    vec3 repeated;    // share of the irradiance that leaves after more than one reflection
    float base;       // share of the diffuse base's light that leaves it
};

// `coat`: reflectance of the dielectric at normal incidence; negative: there is none. `seen`, `mean`: of the table.
SHARED_FUNCTION Facets make_facets(vec3 base_colour, float metallic, float coat, vec2 seen, vec2 mean) {
    Facets facets;
    float dielectric = coat >= 0.0f ? 1.0f - metallic : 0.0f, reflectance = max(coat, 0.0f);
    float lost = 1.0f - seen.x - seen.y;
    vec3 of_coat = facets_given_back(vec3(reflectance), mean) * lost;
    facets.at_normal = vec3(dielectric * reflectance) + metallic * base_colour;
    facets.at_grazing = dielectric + metallic;
    facets.repeated = dielectric * of_coat + metallic * lost * facets_given_back(base_colour, mean);
    facets.base = 1.0f - metallic - dielectric * (reflectance * seen.x + seen.y + of_coat.x);
    return facets;
}

// Single reflections: the scattering function, 1/sr, without the cosine. All directions unit and away from the surface;
// `alpha_squared`: of the width of the distribution. GGX with Smith's correlated masking (B. Walter et al., 2007; E.
// Heitz, 2014).
SHARED_FUNCTION vec3 facet_lobe(Facets facets, float alpha_squared, vec3 normal, vec3 to_eye, vec3 to_light) {
    vec3 both = to_eye + to_light;
    vec3 half_way = both * inversesqrt(max(dot(both, both), 1e-12f));
    vec3 across = cross(normal, half_way);
    float along = dot(normal, half_way);
    float seen = max(dot(normal, to_eye), 1e-3f), lit = max(dot(normal, to_light), 1e-3f);
    // The square of the sine from the cross product: 1 - cos^2 has no digits left where lobes are narrow.
    float spread = alpha_squared * along * along + dot(across, across);
    float rest = 1.0f - alpha_squared;
    float masking = lit * sqrt(seen * seen * rest + alpha_squared) + seen * sqrt(lit * lit * rest + alpha_squared);
    float m = clamp(1.0f - dot(half_way, to_eye), 0.0f, 1.0f);
    vec3 fresnel = facets.at_normal + (vec3(facets.at_grazing) - facets.at_normal) * (m * m * m * m * m);
    return fresnel * (alpha_squared / (3.14159265358979f * spread * spread) * 0.5f / masking);
}

// A light that is a disc of this size (radius over distance) widens the lobe of a point: half vectors spread by half of
// the angle, and the squares of widths add up.
SHARED_CONSTANT float facet_light_spread = 0.25f;
SHARED_FUNCTION float widened_alpha_squared(float alpha_squared, float size_squared) {
    return min(alpha_squared + facet_light_spread * size_squared, 1.0f);
}

SHARED_END
#endif
