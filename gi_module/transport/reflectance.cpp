#include "gi_module/transport/reflectance.h"

#include "engine/core/random.h"
#include "gi_module/transport/ggx.h"

#include <algorithm>
#include <array>
#include <vector>

namespace sunfleck::gi {
namespace {

// Single reflections of light from one direction in all directions, split by Fresnel term: a surface with reflectance F
// at normal incidence reflects F * at_normal + at_grazing (B. Karis, "Real Shading in Unreal Engine 4", 2013).
struct Split {
    float at_normal = 0.0f, at_grazing = 0.0f;
    float whole() const { return at_normal + at_grazing; } // of mirrors
};

Split mix(Split a, Split b, float t) {
    return {glm::mix(a.at_normal, b.at_normal, t), glm::mix(a.at_grazing, b.at_grazing, t)};
}

float schlick_weight(float cosine) {
    const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
    return m * m * m * m * m;
}

constexpr std::uint32_t samples = 1024;
using Numbers = std::array<vec2, samples>;

// By sampling visible normals, the mean of G2 / G1.
Split integrate(float cosine, float alpha, const Numbers& numbers) {
    const vec3 outgoing(std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine);
    double at_normal = 0.0, at_grazing = 0.0;
    const float lambda = ggx_lambda(outgoing, alpha);
    for (const vec2 number : numbers) {
        const vec3 half = ggx_visible_normal(outgoing, alpha, number.x, number.y);
        const float towards = glm::dot(outgoing, half);
        const vec3 incoming = 2.0f * towards * half - outgoing;
        if (incoming.z <= 0.0f)
            continue;
        const double seen = double((1.0f + lambda) / (1.0f + lambda + ggx_lambda(incoming, alpha)));
        const double weight = double(schlick_weight(towards));
        at_normal += seen * (1.0 - weight);
        at_grazing += seen * weight;
    }
    return {float(at_normal / samples), float(at_grazing / samples)};
}

// Tables by roughness and by the square root of the cosine: finer where light grazes.
class Tables {
public:
    static const Tables& get() {
        static const Tables tables;
        return tables;
    }
    Split directional(float cosine, float alpha) const {
        const Place row = place(std::sqrt(alpha), roughnesses), column = place(std::sqrt(cosine), cosines);
        const auto at = [&](std::size_t r, std::size_t c) { return directional_[r * cosines + c]; };
        return mix(mix(at(row.low, column.low), at(row.low, column.low + 1), column.rest),
                   mix(at(row.low + 1, column.low), at(row.low + 1, column.low + 1), column.rest), row.rest);
    }
    Split mean(float alpha) const {
        const Place row = place(std::sqrt(alpha), roughnesses);
        return mix(mean_[row.low], mean_[row.low + 1], row.rest);
    }

    std::vector<vec2> rows() const {
        std::vector<vec2> result;
        result.reserve(roughnesses * shared::facet_columns);
        for (std::size_t r = 0; r < roughnesses; ++r) {
            for (std::size_t c = 0; c < cosines; ++c)
                result.emplace_back(directional_[r * cosines + c].at_normal, directional_[r * cosines + c].at_grazing);
            result.emplace_back(mean_[r].at_normal, mean_[r].at_grazing);
        }
        return result;
    }

private:
    static constexpr std::size_t roughnesses = shared::facet_roughnesses, cosines = shared::facet_cosines;
    struct Place {
        std::size_t low;
        float rest;
    };
    static Place place(float value, std::size_t count) {
        const float scaled = std::clamp(value, 0.0f, 1.0f) * float(count - 1);
        const std::size_t low = std::min(std::size_t(scaled), count - 2);
        return {low, scaled - float(low)};
    }
    static float node(std::size_t i, std::size_t count) {
        const float root = float(i) / float(count - 1);
        return root * root;
    }

    // On one thread: it runs when a walk first needs it, and a thread that waited here for others might take up another
    // walk, which needs it, too.
    Tables() {
        Numbers numbers;
        for (std::uint32_t i = 0; i < samples; ++i) {
            const SobolGroup group(1, i, 0);
            numbers[i] = {to_unit_float(group.bits(0)), to_unit_float(group.bits(1))};
        }
        for (std::size_t r = 0; r < roughnesses; ++r)
            for (std::size_t c = 0; c < cosines; ++c)
                directional_[r * cosines + c] = integrate(std::max(node(c, cosines), 1e-4f),
                                                          std::max(node(r, roughnesses), smallest_alpha), numbers);
        // What directions receive from all around is as their cosine: 2 * integral of E(m) m dm.
        constexpr std::size_t steps = 4096;
        for (std::size_t r = 0; r < roughnesses; ++r)
            for (std::size_t i = 0; i < steps; ++i) {
                const float cosine = (float(i) + 0.5f) / float(steps), weight = 2.0f * cosine / float(steps);
                const Split here = directional(cosine, node(r, roughnesses));
                mean_[r].at_normal += weight * here.at_normal;
                mean_[r].at_grazing += weight * here.at_grazing;
            }
    }

    std::array<Split, roughnesses * cosines> directional_;
    std::array<Split, roughnesses> mean_;
};

} // namespace

GgxLayer::GgxLayer(vec3 reflectance, float roughness)
    : reflectance_(reflectance), alpha_(std::max(roughness * roughness, smallest_alpha)) {
    const Split mean = Tables::get().mean(alpha_);
    mean_lost_ = 1.0f - mean.whole();
    given_back_ = shared::facets_given_back(reflectance_, vec2(mean.at_normal, mean.at_grazing));
    mean_albedo_ = reflectance_ * mean.at_normal + mean.at_grazing + given_back_ * mean_lost_;
}

vec3 GgxLayer::fresnel(float cosine) const {
    return reflectance_ + (vec3(1.0f) - reflectance_) * schlick_weight(cosine);
}

vec3 GgxLayer::single_albedo(float cosine) const {
    const Split split = Tables::get().directional(cosine, alpha_);
    return reflectance_ * split.at_normal + split.at_grazing;
}

vec3 GgxLayer::albedo(float cosine) const {
    const Split split = Tables::get().directional(cosine, alpha_);
    return reflectance_ * split.at_normal + split.at_grazing + given_back_ * (1.0f - split.whole());
}

vec3 GgxLayer::multiple(float outgoing, float incoming) const {
    if (!(mean_lost_ > 0.0f))
        return vec3(0.0f);
    const Tables& tables = Tables::get();
    const float lost =
        (1.0f - tables.directional(outgoing, alpha_).whole()) * (1.0f - tables.directional(incoming, alpha_).whole());
    return given_back_ * (lost / (pi * mean_lost_));
}

std::span<const vec2> facet_table() {
    static const std::vector<vec2> table = Tables::get().rows();
    return table;
}

float fresnel_dielectric(float cosine, float eta) {
    const float c = std::clamp(cosine, 0.0f, 1.0f);
    const float transmitted2 = 1.0f - (1.0f - c * c) / (eta * eta);
    if (transmitted2 <= 0.0f)
        return 1.0f;
    const float t = std::sqrt(transmitted2);
    const float parallel = (eta * c - t) / (eta * c + t), perpendicular = (c - eta * t) / (c + eta * t);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

float dielectric_reflectance(float index_of_refraction) {
    const float root = (index_of_refraction - 1.0f) / (index_of_refraction + 1.0f);
    return root * root;
}

vec3 mean_reflectance(const scene::Material& material) {
    vec3 dielectric = material.base_colour;
    if (material.metallic >= 1.0f) {
        dielectric = vec3(0.0f);
    } else if (material.specular) {
        const vec3 coat =
            GgxLayer(vec3(dielectric_reflectance(material.index_of_refraction)), material.roughness).mean_albedo();
        dielectric = coat + material.base_colour * (vec3(1.0f) - coat);
    }
    if (material.metallic <= 0.0f)
        return dielectric;
    const vec3 metal = GgxLayer(material.base_colour, material.roughness).mean_albedo();
    return glm::mix(dielectric, metal, material.metallic);
}

} // namespace sunfleck::gi
