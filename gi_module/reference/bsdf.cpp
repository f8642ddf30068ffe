#include "gi_module/reference/bsdf.h"

#include "gi_module/light_sampling/emitters.h"

#include <algorithm>

namespace sunfleck::gi::reference {
namespace {

// B. Walter et al., "Microfacet Models for Refraction", 2007, eq. 33 and 34, isotropic.
float ggx_distribution(float cosine, float alpha) {
    const float a2 = alpha * alpha, t = cosine * cosine * (a2 - 1.0f) + 1.0f;
    return a2 / (pi * t * t);
}

// Smith's Lambda for GGX.
float ggx_lambda(vec3 v, float alpha) {
    const float cos2 = v.z * v.z;
    if (cos2 <= 0.0f)
        return 1e10f;
    return 0.5f * (std::sqrt(1.0f + alpha * alpha * (1.0f - cos2) / cos2) - 1.0f);
}

// E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 2018.
vec3 sample_visible_normal(vec3 view, float alpha, float u, float v) {
    const vec3 stretched = glm::normalize(vec3(alpha * view.x, alpha * view.y, view.z));
    const float across = stretched.x * stretched.x + stretched.y * stretched.y;
    const vec3 t1 = across > 0.0f ? vec3(-stretched.y, stretched.x, 0.0f) / std::sqrt(across) : vec3(1.0f, 0.0f, 0.0f);
    const vec3 t2 = glm::cross(stretched, t1);
    const float r = std::sqrt(u), angle = 2.0f * pi * v;
    const float p1 = r * std::cos(angle);
    const float s = 0.5f * (1.0f + stretched.z);
    const float p2 = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - p1 * p1)) + s * r * std::sin(angle);
    const vec3 n = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0f, 1.0f - p1 * p1 - p2 * p2)) * stretched;
    return glm::normalize(vec3(alpha * n.x, alpha * n.y, std::max(1e-6f, n.z)));
}

} // namespace

float fresnel_dielectric(float cosine, float eta) {
    const float c = std::clamp(cosine, 0.0f, 1.0f);
    const float transmitted2 = 1.0f - (1.0f - c * c) / (eta * eta);
    if (transmitted2 <= 0.0f)
        return 1.0f;
    const float t = std::sqrt(transmitted2);
    const float parallel = (eta * c - t) / (eta * c + t), perpendicular = (c - eta * t) / (c + eta * t);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

Bsdf::Bsdf(const scene::Material& material) {
    const vec3 base_colour = material.base_colour;
    const float root = (material.index_of_refraction - 1.0f) / (material.index_of_refraction + 1.0f);
    diffuse_ = base_colour * (1.0f - material.metallic);
    has_specular_ = material.specular || material.metallic > 0.0f;
    normal_reflectance_ = glm::mix(vec3(material.specular ? root * root : 0.0f), base_colour, material.metallic);
    alpha_ = std::max(material.roughness * material.roughness, 1e-3f);
    glass_ = material.transmission > 0.0f;
    tint_ = base_colour;
    index_of_refraction_ = material.index_of_refraction;
}

Bsdf Bsdf::white() {
    Bsdf bsdf;
    bsdf.diffuse_ = vec3(1.0f);
    return bsdf;
}

vec3 Bsdf::fresnel(float cosine) const {
    // C. Schlick, 1994.
    const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
    return normal_reflectance_ + (vec3(1.0f) - normal_reflectance_) * (m * m * m * m * m);
}

float Bsdf::specular_probability(vec3 outgoing) const {
    if (!has_specular_)
        return 0.0f;
    const float specular = luminance(fresnel(outgoing.z)), diffuse = luminance(diffuse_);
    return diffuse > 0.0f ? std::clamp(specular / (specular + diffuse), 0.1f, 0.9f) : 1.0f;
}

vec3 Bsdf::evaluate(vec3 outgoing, vec3 incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f)
        return vec3(0.0f);
    if (!has_specular_)
        return diffuse_ / pi;
    const vec3 half = glm::normalize(outgoing + incoming);
    const vec3 reflected = fresnel(glm::dot(half, outgoing));
    const float masking = 1.0f / (1.0f + ggx_lambda(outgoing, alpha_) + ggx_lambda(incoming, alpha_));
    const vec3 specular = reflected * (ggx_distribution(half.z, alpha_) * masking / (4.0f * outgoing.z * incoming.z));
    // Light that the layer reflects on entry and exit does not reach the base. This is reciprocal and conserves energy
    // (glTF's own mix by the half vector does not at grazing angles).
    const vec3 in = fresnel(incoming.z), out = fresnel(outgoing.z);
    const float passed = (1.0f - std::max({in.x, in.y, in.z})) * (1.0f - std::max({out.x, out.y, out.z}));
    return diffuse_ / pi * passed + specular;
}

float Bsdf::density(vec3 outgoing, vec3 incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f)
        return 0.0f;
    const float probability = specular_probability(outgoing);
    float result = (1.0f - probability) * incoming.z / pi;
    if (probability > 0.0f) {
        const vec3 half = glm::normalize(outgoing + incoming);
        const float visible = ggx_distribution(half.z, alpha_) / (1.0f + ggx_lambda(outgoing, alpha_));
        result += probability * visible / (4.0f * outgoing.z);
    }
    return result;
}

bool Bsdf::sample(vec3 outgoing, const float numbers[3], BsdfSample& result) const {
    if (outgoing.z <= 0.0f)
        return false;
    if (!has_specular_) {
        result.direction = sample_cosine_direction(vec3(0.0f, 0.0f, 1.0f), numbers[0], numbers[1]);
        result.pdf = result.direction.z / pi;
        result.weight = diffuse_;
        return result.pdf > 0.0f;
    }
    if (numbers[2] < specular_probability(outgoing)) {
        const vec3 half = sample_visible_normal(outgoing, alpha_, numbers[0], numbers[1]);
        result.direction = 2.0f * glm::dot(outgoing, half) * half - outgoing;
    } else {
        result.direction = sample_cosine_direction(vec3(0.0f, 0.0f, 1.0f), numbers[0], numbers[1]);
    }
    result.pdf = density(outgoing, result.direction);
    if (result.pdf <= 0.0f)
        return false;
    result.weight = evaluate(outgoing, result.direction) * (result.direction.z / result.pdf);
    return true;
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
    return result;
}

} // namespace sunfleck::gi::reference
