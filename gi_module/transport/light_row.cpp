#include "gi_module/transport/light_row.h"

namespace sunfleck::gi {
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

bool filters_maps(bool wished, std::uint32_t light_class) {
    return wished || light_class == shared::light_class_point;
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
        break;
    case SampleKind::spot:
        intensity = sample.flux;
        row.normal_offset.w = sample.cone_offset;
        row.tangent_scale.w = sample.cone_scale;
        break;
    case SampleKind::directional: {
        intensity = sample.flux;
        const float radius = std::max(0.5f * glm::length(scene.extent()), 1e-3f) * 1.001f;
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
