#include "gi_module/transport/light_row.h"

#include "gi_module/transport/scene_sphere.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr float cone_margin = 1.02f; // for the texels beyond the cone's edge that a filtered look-up reads

// Scale of the map of a spot light's cone; 0 for half angles above 45 degrees, where a spherical map is as good.
float cone_map_scale(const LightSample& sample) {
    if (!(sample.cone_scale > 0.0f))
        return 0.0f;
    const float cosine = std::clamp(-sample.cone_offset / sample.cone_scale, -1.0f, 1.0f);
    if (cosine < 0.70710678f)
        return 0.0f;
    const float tangent = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f)) / cosine;
    return 1.0f / (cone_margin * std::max(tangent, 1e-3f));
}

} // namespace

std::uint32_t light_class(SampleKind kind) {
    switch (kind) {
    case SampleKind::surface:
        return shared::light_class_surface;
    case SampleKind::point:
    case SampleKind::spot:
        return shared::light_class_point;
    case SampleKind::directional:
        return shared::light_class_directional;
    }
    return shared::light_class_surface;
}

bool filters_maps(bool filter_requested, std::uint32_t light_class) {
    return filter_requested || light_class != shared::light_class_surface;
}

shared::LightRow make_light_row(const LightSample& sample, std::uint32_t slot, float geometry_bound,
                                const Bounds& scene) {
    shared::LightRow row{};
    vec3 tangent, bitangent;
    orthonormal_basis(sample.normal, tangent, bitangent);
    row.position_bound = vec4(sample.position, geometry_bound);
    row.normal_offset = vec4(sample.normal, 0.0f);
    row.tangent_scale = vec4(tangent, 0.0f);
    row.bitangent = vec4(bitangent, 0.0f);
    vec3 intensity(0.0f);
    switch (sample.kind) {
    case SampleKind::surface:
        intensity = sample.flux / pi;
        break;
    case SampleKind::point:
        intensity = sample.flux / (4.0f * pi);
        row.normal_offset.w = 1.0f; // no cone: clamp(0 * cos + 1)^2
        row.position_bound.w = 0.0f;
        break;
    case SampleKind::spot:
        intensity = sample.flux;
        row.normal_offset.w = sample.cone_offset;
        row.tangent_scale.w = sample.cone_scale;
        row.position_bound.w = cone_map_scale(sample);
        break;
    case SampleKind::directional: {
        intensity = sample.flux;
        const float radius = bounding_radius(scene) * 1.001f;
        row.position_bound = vec4(scene.centre() - radius * sample.normal, 0.0f);
        row.normal_offset.w = 0.5f / radius;
        row.tangent_scale.w = 1.0f / radius;
        break;
    }
    }
    row.intensity_slot = vec4(intensity, float(slot));
    return row;
}

} // namespace sunfleck::gi
