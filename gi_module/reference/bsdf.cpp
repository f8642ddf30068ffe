#include "gi_module/reference/bsdf.h"

#include "gi_module/light_sampling/emitters.h"
#include "gi_module/transport/ggx.h"

#include <algorithm>

namespace sunfleck::gi::reference {

Bsdf::Bsdf(const scene::Material& material, float choice)
    : metallic_(material.metallic), base_(material.base_colour), glass_(choice < material.transmission),
      tint_(material.base_colour), index_of_refraction_(material.index_of_refraction) {
    if (material.specular && metallic_ < 1.0f)
        coat_.emplace(vec3(dielectric_reflectance(material.index_of_refraction)), material.roughness);
    if (metallic_ > 0.0f)
        metal_.emplace(material.base_colour, material.roughness);
}

Bsdf Bsdf::white() {
    Bsdf bsdf;
    bsdf.base_ = vec3(1.0f);
    return bsdf;
}

// Both layers have the same facets: they differ by what each reflects.
vec3 Bsdf::microfacets(vec3 outgoing, vec3 incoming) const {
    const float alpha = coat_ ? coat_->alpha() : metal_->alpha();
    const vec3 half = glm::normalize(outgoing + incoming);
    const float towards = glm::dot(half, outgoing);
    const float masking = 1.0f / (1.0f + ggx_lambda(outgoing, alpha) + ggx_lambda(incoming, alpha));
    const float facets = ggx_distribution(half, alpha) * masking / (4.0f * outgoing.z * incoming.z);
    vec3 result(0.0f);
    if (coat_)
        result += (1.0f - metallic_) * (coat_->fresnel(towards) * facets + coat_->multiple(outgoing.z, incoming.z));
    if (metal_)
        result += metallic_ * (metal_->fresnel(towards) * facets + metal_->multiple(outgoing.z, incoming.z));
    return result;
}

// The base, by what the coat lets through on the way in and on the way out.
vec3 Bsdf::diffuse(vec3 outgoing, vec3 incoming) const {
    const vec3 base = (1.0f - metallic_) / pi * base_;
    if (!coat_)
        return base;
    return base * (vec3(1.0f) - coat_->albedo(outgoing.z)) * (vec3(1.0f) - coat_->albedo(incoming.z)) /
           (vec3(1.0f) - coat_->mean_albedo());
}

// Facets are sampled by their share of what single reflections and everything else reflect; that is near a cosine.
float Bsdf::microfacet_probability(vec3 outgoing) const {
    if (!coat_ && !metal_)
        return 0.0f;
    float single = 0.0f, whole = 0.0f;
    if (coat_) {
        const vec3 albedo = coat_->albedo(outgoing.z);
        single += (1.0f - metallic_) * luminance(coat_->single_albedo(outgoing.z));
        whole += (1.0f - metallic_) * luminance(albedo + base_ * (vec3(1.0f) - albedo));
    } else {
        whole += (1.0f - metallic_) * luminance(base_);
    }
    if (metal_) {
        single += metallic_ * luminance(metal_->single_albedo(outgoing.z));
        whole += metallic_ * luminance(metal_->albedo(outgoing.z));
    }
    return whole > 0.0f ? std::clamp(single / whole, 0.0f, 1.0f) : 1.0f;
}

vec3 Bsdf::evaluate(vec3 outgoing, vec3 incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f)
        return vec3(0.0f);
    if (!coat_ && !metal_)
        return base_ / pi;
    return diffuse(outgoing, incoming) + microfacets(outgoing, incoming);
}

float Bsdf::density(vec3 outgoing, vec3 incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f)
        return 0.0f;
    const float probability = microfacet_probability(outgoing);
    float result = (1.0f - probability) * incoming.z / pi;
    if (probability > 0.0f) {
        const float alpha = coat_ ? coat_->alpha() : metal_->alpha();
        const vec3 half = glm::normalize(outgoing + incoming);
        const float visible = ggx_distribution(half, alpha) / (1.0f + ggx_lambda(outgoing, alpha));
        result += probability * visible / (4.0f * outgoing.z);
    }
    return result;
}

bool Bsdf::sample(vec3 outgoing, const float numbers[3], BsdfSample& result) const {
    if (outgoing.z <= 0.0f)
        return false;
    if (!coat_ && !metal_) {
        result.direction = sample_cosine_direction(vec3(0.0f, 0.0f, 1.0f), numbers[0], numbers[1]);
        result.pdf = result.direction.z / pi;
        result.weight = base_;
        result.diffuse = true;
        return result.pdf > 0.0f;
    }
    if (numbers[2] < microfacet_probability(outgoing)) {
        const float alpha = coat_ ? coat_->alpha() : metal_->alpha();
        const vec3 half = ggx_visible_normal(outgoing, alpha, numbers[0], numbers[1]);
        result.direction = 2.0f * glm::dot(outgoing, half) * half - outgoing;
    } else {
        result.direction = sample_cosine_direction(vec3(0.0f, 0.0f, 1.0f), numbers[0], numbers[1]);
        result.diffuse = true;
    }
    result.pdf = density(outgoing, result.direction);
    if (result.pdf <= 0.0f)
        return false;
    result.weight = evaluate(outgoing, result.direction) * (result.direction.z / result.pdf);
    return true;
}

vec3 Bsdf::evaluate_diffuse(vec3 outgoing, vec3 incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f)
        return vec3(0.0f);
    return coat_ || metal_ ? diffuse(outgoing, incoming) : base_ / pi;
}

BsdfSample Bsdf::sample_glass(vec3 outgoing, bool entering, float number) const {
    const float eta = entering ? index_of_refraction_ : 1.0f / index_of_refraction_;
    const float reflectance = fresnel_dielectric(outgoing.z, eta);
    BsdfSample result;
    result.delta = true;
    if (number < reflectance) {
        result.direction = vec3(-outgoing.x, -outgoing.y, outgoing.z);
        result.weight = vec3(1.0f);
        return result;
    }
    const vec3 across = vec3(outgoing.x, outgoing.y, 0.0f) / -eta;
    result.direction = across - vec3(0.0f, 0.0f, std::sqrt(std::max(0.0f, 1.0f - glm::dot(across, across))));
    // Radiance scales with 1/eta^2 when it enters and back when it leaves. Paths start and end outside of closed glass,
    // so the factors cancel and are left out.
    result.weight = tint_;
    result.index_ratio2 = eta * eta;
    return result;
}

} // namespace sunfleck::gi::reference
