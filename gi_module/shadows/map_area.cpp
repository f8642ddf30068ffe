#include "gi_module/shadows/map_area.h"

#include "gi_module/shadows/octahedral_map.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

// Map coordinates, in [-1, 1]^2 if the point is on the map; false if it is behind the projection centre.
bool project_to_map(const shared::LightRow& light, std::uint32_t light_class, std::uint32_t face, vec3 point,
                    vec2& uv) {
    const vec3 v = point - vec3(light.position_bound);
    const vec3 d(glm::dot(vec3(light.tangent_scale), v), glm::dot(vec3(light.bitangent), v),
                 glm::dot(vec3(light.normal_offset), v));
    if (light_class == shared::light_class_directional) {
        uv = vec2(d) * light.tangent_scale.w;
        return true;
    }
    const vec3 clip = light_class == shared::light_class_surface ? shared::hemisphere_face_clip(d, face)
                      : face == shared::cone_face                ? shared::cone_clip(d, light.position_bound.w)
                                                                 : shared::sphere_face_clip(d, face);
    uv = vec2(clip) / clip.z;
    return clip.z > 1e-3f;
}

} // namespace

namespace {

// Least and greatest |x| over [low, high].
vec2 range_of_magnitude(float low, float high) {
    const float greatest = std::max(std::abs(low), std::abs(high));
    return {low <= 0.0f && high >= 0.0f ? 0.0f : std::min(std::abs(low), std::abs(high)), greatest};
}

bool reaches_sign(float low, float high, float sign) {
    return sign > 0.0f ? high >= 0.0f : low <= 0.0f;
}

} // namespace

// Faces of a sphere's map are told apart by the signs of map coordinates, upper and lower ones by |u| + |v|.
std::uint32_t faces_in_tile(std::uint32_t light_class, const MapTile& tile) {
    if (tile.is_whole_map() || light_class != shared::light_class_point)
        return ~0u;
    const float half = 1.01f / tile.scale; // texels beyond an edge of faces are drawn, too
    const vec2 low = tile.centre - half, high = tile.centre + half;
    const vec2 u = range_of_magnitude(low.x, high.x), v = range_of_magnitude(low.y, high.y);
    std::uint32_t faces = 1u << shared::cone_face;
    for (std::uint32_t face = 0; face < 8; ++face) {
        const vec3 s = shared::face_signs(face);
        const bool sides = reaches_sign(low.x, high.x, s.x) && reaches_sign(low.y, high.y, s.y);
        const bool half_space = s.z > 0.0f ? u.x + v.x <= 1.0f : u.y + v.y >= 1.0f;
        if (sides && half_space)
            faces |= 1u << face;
    }
    return faces;
}

bool MapArea::overlaps(const MapArea& other) const {
    return glm::all(glm::lessThan(low, other.high)) && glm::all(glm::lessThan(other.low, high));
}

void MapAreas::add(MapArea area) {
    if (area.empty())
        return;
    for (std::size_t i = 0; i < areas_.size();) {
        if (!areas_[i].overlaps(area)) {
            ++i;
            continue;
        }
        // The merged area may overlap others.
        area = {glm::min(area.low, areas_[i].low), glm::max(area.high, areas_[i].high)};
        areas_.erase(areas_.begin() + std::ptrdiff_t(i));
        i = 0;
    }
    areas_.push_back(area);
}

void MapAreas::add(const MapAreas& other) {
    for (const MapArea& area : other.areas_)
        add(area);
}

MapArea covered_area(const shared::LightRow& light, std::uint32_t light_class, std::uint32_t faces,
                     const Bounds& bounds, std::uint32_t resolution, const MapTile& tile) {
    vec2 low(1e30f), high(-1e30f);
    for (std::uint32_t face = 0; faces >> face; ++face) {
        if (((faces >> face) & 1u) == 0)
            continue;
        for (int corner = 0; corner < 8; ++corner) {
            const vec3 point(corner & 1 ? bounds.maximum.x : bounds.minimum.x,
                             corner & 2 ? bounds.maximum.y : bounds.minimum.y,
                             corner & 4 ? bounds.maximum.z : bounds.minimum.z);
            vec2 uv;
            if (!project_to_map(light, light_class, face, point, uv))
                return MapArea::all(resolution);
            uv = (uv - tile.centre) * tile.scale;
            low = glm::min(low, uv);
            high = glm::max(high, uv);
        }
    }
    const auto texel = [&](float coordinate, float margin) {
        return std::clamp((coordinate * 0.5f + 0.5f) * float(resolution) + margin, 0.0f, float(resolution));
    };
    const glm::uvec2 first(std::uint32_t(texel(low.x, -1.0f)) & ~1u, std::uint32_t(texel(low.y, -1.0f)));
    const glm::uvec2 end((std::uint32_t(std::ceil(texel(high.x, 1.0f))) + 1u) & ~1u,
                         std::uint32_t(std::ceil(texel(high.y, 1.0f))));
    return {first, glm::min(end, glm::uvec2(resolution))};
}

} // namespace sunfleck::gi
