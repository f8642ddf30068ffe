#include "gi_module/transport/pixel_light.h"

#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr float widest_glossy_lobe = 2.0f; // exponent
constexpr float largest_exponent = 1e5f;
// Of the part where a lobe widens: distances and angles at which it is measured, and what may lie between them.
constexpr int widening_steps = 16, arc_steps = 6;
constexpr float widening_margin = 1.03f;

float finite_or_zero(float value) {
    return std::isfinite(value) && value > 0.0f ? value : 0.0f;
}

// The ellipsoid outside of which the light is below `least`. Where it widens, it may reach farther to the sides: the
// ellipsoid is made larger by what it takes to hold arcs of that part.
void set_bound(shared::PixelLightRow& row, float norm, float least) {
    const float peak = std::max({row.row.intensity_slot.x, row.row.intensity_slot.y, row.row.intensity_slot.z});
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
    const float reach = exponent > 1.0f ? radius * std::sqrt(0.5f * (exponent + 1.0f)) : 0.0f;
    row.extent = vec4(reach, -1.0f, 0.0f, 0.0f);
    if (least > 0.0f)
        set_bound(row, norm, least);
    return row;
}

} // namespace sunfleck::gi
