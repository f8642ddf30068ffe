// Which faces of a map see a box.
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_maps.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

// Largest value of dot(axis, p - origin) over the box.
float support(const Bounds& bounds, vec3 origin, vec3 axis) {
    const vec3 corner(axis.x > 0 ? bounds.maximum.x : bounds.minimum.x,
                      axis.y > 0 ? bounds.maximum.y : bounds.minimum.y,
                      axis.z > 0 ? bounds.maximum.z : bounds.minimum.z);
    return glm::dot(axis, corner - origin);
}

} // namespace

std::uint32_t ShadowMaps::faces_that_see(const ShadowRequest& request, const Bounds& bounds) {
    const shared::LightRow& light = request.light;
    if (request.light_class == shared::light_class_directional)
        return 1;
    const vec3 origin(light.position_bound);
    const vec3 axes[3] = {vec3(light.tangent_scale), vec3(light.bitangent), vec3(light.normal_offset)};
    if (request.has_cone_map()) {
        for (const vec3 side : {axes[0], -axes[0], axes[1], -axes[1]})
            if (support(bounds, origin, axes[2] - light.position_bound.w * side) <= 0.0f)
                return 0;
        return support(bounds, origin, axes[2]) > 0.0f ? 1u << shared::cone_face : 0;
    }
    // Whether the box reaches the negative and the positive side of each axis.
    bool reaches[3][2];
    for (int i = 0; i < 3; ++i) {
        reaches[i][0] = support(bounds, origin, axes[i]) > 0.0f;
        reaches[i][1] = support(bounds, origin, -axes[i]) > 0.0f;
    }
    std::uint32_t faces = 0;
    const std::uint32_t count = request.light_class == shared::light_class_surface ? 4 : 8;
    for (std::uint32_t face = 0; face < count; ++face)
        if (reaches[0][face & 1] && reaches[1][(face >> 1) & 1] && reaches[2][(face >> 2) & 1])
            faces |= 1u << face;
    return faces;
}

namespace {

// Clip coordinates of a point light's face, each as a functional of the light-space direction: they are linear.
mat3 clip_functionals(std::uint32_t face, float cone_scale) {
    mat3 columns; // of clip coordinates, by axis of light space
    for (int axis = 0; axis < 3; ++axis) {
        vec3 d(0.0f);
        d[axis] = 1.0f;
        columns[axis] =
            face == shared::cone_face ? shared::cone_clip(d, cone_scale) : shared::sphere_face_clip(d, face);
    }
    return glm::transpose(columns);
}

// Whether a box may have a part in the tile through a face: not if it lies outside of one of the planes that bound the
// tile there, seen from the light, or outside of the face's octant.
bool reaches_tile(const ShadowRequest& request, std::uint32_t face, const Bounds& bounds) {
    const shared::LightRow& light = request.light;
    const mat3 to_world(vec3(light.tangent_scale), vec3(light.bitangent), vec3(light.normal_offset));
    const vec3 origin(light.position_bound);
    const mat3 clip = clip_functionals(face, light.position_bound.w);
    vec2 low = request.tile.centre - 1.0f / request.tile.scale, high = request.tile.centre + 1.0f / request.tile.scale;
    const float border = 0.01f / request.tile.scale; // faces are drawn a quarter of a texel wider
    if (face != shared::cone_face) {
        const vec3 s = shared::face_signs(face);
        for (int i = 0; i < 2; ++i) {
            low[i] = std::max(low[i], s[i] > 0.0f ? -border : -1.0f - border);
            high[i] = std::min(high[i], s[i] > 0.0f ? 1.0f + border : border);
        }
        if (support(bounds, origin, to_world * vec3(0.0f, 0.0f, s.z) + border * (to_world * clip[2])) <= 0.0f)
            return false;
    }
    for (int i = 0; i < 2; ++i)
        if (support(bounds, origin, to_world * (clip[i] - low[i] * clip[2])) <= 0.0f ||
            support(bounds, origin, to_world * (high[i] * clip[2] - clip[i])) <= 0.0f)
            return false;
    return support(bounds, origin, to_world * clip[2]) > 0.0f;
}

} // namespace

// Of a tile only those faces are drawn in which the box reaches the tile; of whole maps, where most boxes do, all that
// see it.
ShadowMaps::MapPart ShadowMaps::part_covered(const ShadowRequest& request, const Bounds& bounds,
                                             bool wants_area) const {
    MapPart part{faces_that_see(request, bounds) & faces_in_tile(request.light_class, request.tile), {}};
    const auto area = [&](std::uint32_t faces) {
        return covered_area(request.light, request.light_class, faces, bounds, resolution_, request.tile);
    };
    if (request.tile.is_whole_map()) {
        if (wants_area)
            part.area = area(part.faces);
        return part;
    }
    std::uint32_t reached = 0;
    for (std::uint32_t face = 0; part.faces >> face; ++face)
        if (((part.faces >> face) & 1u) != 0 &&
            (request.light_class != shared::light_class_point || reaches_tile(request, face, bounds)) &&
            !area(1u << face).empty())
            reached |= 1u << face;
    part.faces = reached;
    part.area = reached != 0 ? area(reached) : MapArea();
    return part;
}

} // namespace sunfleck::gi
