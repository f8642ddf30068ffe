#include "gi_module/shadows/shadow_jobs.h"

#include "gi_module/shadows/octahedral_map.h"

#include <glm/gtc/type_precision.hpp>

namespace sunfleck::gi {
namespace {

using glm::dvec3;
using glm::dvec4;

// dot(result, (p, 1)) = dot(axis, model * p - origin).
dvec4 along(const vec4& axis, const shared::DrawConstants& occluder, dvec3 origin) {
    const dvec3 a(axis);
    dvec4 result = a.x * dvec4(occluder.model[0]) + a.y * dvec4(occluder.model[1]) + a.z * dvec4(occluder.model[2]);
    result.w -= glm::dot(a, origin);
    return result;
}

} // namespace

// The projections of octahedral_map.h, applied to points in the occluder's space.
shared::ShadowJob make_shadow_job(const shared::LightRow& light, std::uint32_t light_class, const MapFace& place,
                                  const shared::DrawConstants& occluder, std::uint32_t row) {
    const dvec3 origin(light.position_bound);
    const dvec4 one(0.0, 0.0, 0.0, 1.0);
    const dvec4 x = along(light.tangent_scale, occluder, origin), y = along(light.bitangent, occluder, origin),
                z = along(light.normal_offset, occluder, origin);
    const vec4 part(place.tile.centre, place.tile.scale, 0.5f / (float(place.resolution) * place.tile.scale));
    const std::uint32_t layer_face = place.layer | (place.face << 16) | (light_class << 20);
    if (light_class == shared::light_class_directional) {
        const double inverse_radius = double(light.tangent_scale.w);
        return {vec4(x * inverse_radius),
                vec4(y * inverse_radius),
                vec4(one),
                vec4(one - z * double(light.normal_offset.w)),
                part,
                layer_face,
                row};
    }
    if (place.face == shared::cone_face) {
        const double scale = double(light.position_bound.w);
        return {vec4(x * scale), vec4(y * scale), vec4(z), vec4(z), part, layer_face, row};
    }
    const dvec3 s(shared::face_signs(place.face));
    const dvec4 w = s.x * x + s.y * y + s.z * z;
    if (light_class == shared::light_class_surface)
        return {vec4(x + y), vec4(x - y), vec4(w), vec4(z), part, layer_face, row};
    if (s.z > 0.0)
        return {vec4(x), vec4(y), vec4(w), vec4(z), part, layer_face, row};
    return {vec4(s.x * (w - s.y * y)), vec4(s.y * (w - s.x * x)), vec4(w), vec4(z), part, layer_face, row};
}

} // namespace sunfleck::gi
