#include "gi_module/transport/pixel_light.h"

#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr float widest_glossy_lobe = 2.0f; // exponent
constexpr float largest_exponent = 1e5f;
constexpr float narrowest_as_beam = 20.0f; // exponent from which a lobe is near enough to a Gaussian
// Of the part where a lobe widens: distances and angles at which it is measured, and what may lie between them.
constexpr int widening_steps = 16, arc_steps = 8;
constexpr float widening_margin = 1.03f;
constexpr int halvings = 12;
// Of the distance between lights on a square grid, which are as far apart as a square of their area is wide. An
// adjoining wall is lit most evenly at 0.9, but what is near gets less in the mean: in arena, with 1,024 shadowed
// lights, -6 % at 0.9 and -3 % at 0.6, where the error to the path tracer is least, too.
constexpr float softness_of_spacing = 0.6f;

float finite_or_zero(float value) {
    return std::isfinite(value) && value > 0.0f ? value : 0.0f;
}

// How far a softened light of intensity 1 is at least `least`, m, in a direction at an angle to its normal. Beyond a
// distance of its softness its light falls.
float soft_reach(float cosine, float softness, float least) {
    const auto light = [&](float distance) {
        return shared::softened_term(distance * cosine, distance, distance * distance, softness);
    };
    float low = softness, high = 1.1f * std::sqrt(1.0f / least) + softness;
    if (light(low) < least)
        return low;
    for (int i = 0; i < halvings; ++i) {
        const float middle = 0.5f * (low + high);
        (light(middle) < least ? high : low) = middle;
    }
    return high;
}

// The same of a diffuse light. To the sides, softened light reaches farther.
void set_soft_bound(shared::PixelLightRow& row, float peak, float least) {
    const shared::LobeBound shape = shared::lobe_bound(1.0f);
    const float size = std::sqrt(peak / least), softness = row.extent.x;
    float larger = 1.0f;
    for (int k = 0; k <= arc_steps && softness > 0.0f && size > 0.0f; ++k) {
        const float angle = 0.5f * pi * float(k) / float(arc_steps), cosine = std::max(std::cos(angle), 0.0f);
        const vec2 place = soft_reach(cosine, softness, least / peak) / size * vec2(cosine, std::sin(angle));
        larger = std::max(larger, widening_margin * glm::length((place - vec2(shape.centre, 0.0f)) /
                                                                vec2(shape.along, shape.across)));
    }
    row.extent = vec4(softness, size * shape.centre, larger * size * shape.along, larger * size * shape.across);
}

// Of Gaussians on a square grid, in steps of the grid: their sum is even within 2 %.
constexpr float beam_deviation = 0.5f;

// Covariance across the axis of what a piece of surface reflects (beam_density).
void set_beam(shared::PixelLightRow& row, const PixelLight& light, float norm) {
    const vec3 x = shared::lobe_tangent(light.axis), y = glm::cross(light.axis, x);
    const auto add = [](vec4& sum, vec2 a, vec2 b) { // symmetric part of the outer product
        sum += vec4(a.x * b.x, 0.5f * (a.x * b.y + a.y * b.x), a.y * b.y, 0.0f);
    };
    for (int i = 0; i < 2; ++i) {
        const vec2 wide = beam_deviation * vec2(glm::dot(x, light.wide[i]), glm::dot(y, light.wide[i])),
                   turned = beam_deviation * vec2(glm::dot(x, light.turned[i]), glm::dot(y, light.turned[i]));
        add(row.beam0, wide, wide);
        add(row.beam1, 2.0f * wide, turned);
        add(row.beam2, turned, turned);
    }
    // A piece that is seen edge-on is still as wide as a hundredth of it; a lobe is a Gaussian near its axis.
    const float least = 1e-4f * light.area, lobe = 1.0f / row.lobe.w;
    row.beam0 += vec4(least, 0.0f, least, 0.0f);
    row.beam2 += vec4(lobe, 0.0f, lobe, 0.0f);
    row.beam0.w = norm > 0.0f && is_finite(vec3(row.beam0) + vec3(row.beam1) + vec3(row.beam2)) ? 1.0f / norm : 0.0f;
}

// The ellipsoid outside of which the light is below `least`. Where it widens, it may reach farther to the sides: the
// ellipsoid is made larger by what it takes to hold arcs of that part.
void set_bound(shared::PixelLightRow& row, float norm, float least) {
    const float peak = std::max({row.row.intensity_slot.x, row.row.intensity_slot.y, row.row.intensity_slot.z});
    if (row.lobe.w <= 1.0f)
        return set_soft_bound(row, peak, least);
    const float flux = peak / norm, exponent = row.lobe.w, reach = row.extent.x;
    const shared::LobeBound shape = shared::lobe_bound(exponent);
    const float size = std::sqrt(peak / least), tilt = glm::dot(vec3(row.lobe), vec3(row.row.normal_offset));
    float larger = 1.0f;
    for (int i = 1; i <= widening_steps && reach > 0.0f && size > 0.0f; ++i) {
        const float distance = reach * float(i) / float(widening_steps);
        const float widened = shared::widened_exponent(exponent, distance, reach);
        const float left = least * distance * distance / (flux * shared::lobe_norm(widened, tilt));
        const float widest = left < 1.0f ? std::acos(std::pow(left, 1.0f / widened)) : 0.0f;
        for (int k = 0; k <= arc_steps && left < 1.0f; ++k) {
            const float angle = widest * float(k) / float(arc_steps);
            const vec2 place = distance / size * vec2(std::cos(angle), std::sin(angle));
            larger = std::max(larger, widening_margin * glm::length((place - vec2(shape.centre, 0.0f)) /
                                                                    vec2(shape.along, shape.across)));
        }
    }
    row.extent = vec4(reach, size * shape.centre, larger * size * shape.along, larger * size * shape.across);
}

} // namespace

float lobe_exponent(float alpha) {
    return std::clamp(0.5f / (alpha * alpha), 1.0f, largest_exponent);
}

LobeReflectance lobe_reflectance(const scene::Material& material, float cosine) {
    LobeReflectance result;
    const float opaque = 1.0f - std::clamp(material.transmission, 0.0f, 1.0f), metal = material.metallic;
    result.diffuse = (1.0f - metal) * opaque * material.base_colour;
    if (metal < 1.0f && material.specular) {
        const vec3 coat =
            GgxLayer(vec3(dielectric_reflectance(material.index_of_refraction)), material.roughness).albedo(cosine);
        result.glossy = (1.0f - metal) * coat;
        result.diffuse *= vec3(1.0f) - coat;
    }
    if (metal > 0.0f)
        result.glossy += metal * GgxLayer(material.base_colour, material.roughness).albedo(cosine);
    result.exponent = lobe_exponent(material.roughness * material.roughness);
    if (result.exponent < widest_glossy_lobe) {
        result.diffuse += result.glossy;
        result.glossy = vec3(0.0f);
    }
    return result;
}

float pixel_light_softness(float area, float clamp_scale) {
    return softness_of_spacing * std::sqrt(2.0f * std::max(area, 0.0f) / clamp_scale);
}

shared::PixelLightRow make_pixel_light_row(const PixelLight& light, std::uint32_t slot, float clamp_scale,
                                           float least) {
    LightSample sample;
    sample.position = light.position;
    sample.normal = light.normal;
    const float radius = std::sqrt(std::max(light.area, 0.0f) / pi);
    const float exponent =
        std::isfinite(light.exponent) ? std::clamp(light.exponent, 1.0f, largest_exponent) : largest_exponent;
    const float norm = shared::lobe_norm(exponent, glm::dot(light.axis, light.normal));
    // What a surface of this area, all of whose light meets a receiver, gives it: flux / area.
    const float bound = radius > 0.0f ? clamp_scale / (pi * radius * radius * norm) : 1e30f;
    shared::PixelLightRow row{};
    row.row = make_light_row(sample, slot, bound, {});
    for (int c = 0; c < 3; ++c)
        row.row.intensity_slot[c] = norm * finite_or_zero(light.flux[c]);
    row.lobe = vec4(light.axis, exponent);
    // Nearer than where the lobe is as wide as the surface, it would be a brighter spot than the surface can make.
    const float reach =
        exponent > 1.0f ? radius * std::sqrt(0.5f * (exponent + 1.0f)) : pixel_light_softness(light.area, clamp_scale);
    row.extent = vec4(reach, -1.0f, 0.0f, 0.0f);
    const bool beam = exponent >= narrowest_as_beam && light.area > 0.0f &&
                      glm::dot(light.wide[0], light.wide[0]) + glm::dot(light.wide[1], light.wide[1]) > 0.0f;
    if (beam)
        set_beam(row, light, norm);
    else if (least > 0.0f)
        set_bound(row, norm, least);
    row.beam1.w = 1.0f / norm;
    return row;
}

} // namespace sunfleck::gi
