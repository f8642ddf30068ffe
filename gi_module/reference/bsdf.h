// The scattering functions of the reference path tracer, in the local frame of the shading normal (z up). glTF 2.0
// appendix B: a Lambertian base under an optional dielectric GGX coat, metals as GGX alone, and mixes of the two; all
// with the energy that transport/reflectance.h has. And smooth glass.
#pragma once

#include "gi_module/transport/reflectance.h"

#include <optional>

namespace sunfleck::gi::reference {

struct BsdfSample {
    vec3 direction{0.0f}; // local, in which the path continues
    vec3 weight{0.0f};    // f * |cos| / pdf
    float pdf = 0.0f;     // solid angle; 0 for delta scattering
    bool delta = false;
    bool diffuse = false; // chosen by the diffuse part
    // Squared index of refraction of the side that the path goes to over that of the side it came from; 1 for
    // reflections.
    float index_ratio2 = 1.0f;
};

class Bsdf {
public:
    // A material that transmits a part of the light is glass by chance: `choice`, in [0, 1), decides.
    explicit Bsdf(const scene::Material& material, float choice = 0.0f);
    // A Lambertian surface of albedo 1, in place of a material where irradiance is measured.
    static Bsdf white();

    bool is_glass() const { return glass_; }

    // f(outgoing, incoming), without the cosine. Both unit, above the surface (z > 0). Reciprocal.
    vec3 evaluate(vec3 outgoing, vec3 incoming) const;
    // The Lambertian part of it.
    vec3 evaluate_diffuse(vec3 outgoing, vec3 incoming) const;
    // Density of sample() for `incoming`, per solid angle.
    float density(vec3 outgoing, vec3 incoming) const;
    // numbers: three in [0, 1). False: the path ends here.
    bool sample(vec3 outgoing, const float numbers[3], BsdfSample& result) const;

    // Share of samples whose direction is a facet's reflection; the others are cosine-distributed.
    float microfacet_probability(vec3 outgoing) const;

    // Glass: reflection or refraction chosen by Fresnel. `entering`: outgoing is on the outer side.
    BsdfSample sample_glass(vec3 outgoing, bool entering, float number) const;

private:
    Bsdf() = default;
    vec3 microfacets(vec3 outgoing, vec3 incoming) const;
    vec3 diffuse(vec3 outgoing, vec3 incoming) const;

    std::optional<GgxLayer> coat_, metal_; // of equal width
    float metallic_ = 0.0f;
    vec3 base_{0.0f};
    bool glass_ = false;
    vec3 tint_{1.0f};
    float index_of_refraction_ = 1.5f;
};

} // namespace sunfleck::gi::reference
