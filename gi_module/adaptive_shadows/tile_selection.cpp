#include "gi_module/adaptive_shadows/tile_selection.h"

#include "gi_module/shadows/octahedral_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sunfleck::gi {
namespace {

std::array<vec3, 8> corners_of(const Bounds& bounds) {
    std::array<vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i)
        corners[i] = vec3(i & 1 ? bounds.maximum.x : bounds.minimum.x, i & 2 ? bounds.maximum.y : bounds.minimum.y,
                          i & 4 ? bounds.maximum.z : bounds.minimum.z);
    return corners;
}

// The part of the map that a face of a sphere's map can cover: a quarter.
void clip_to_quarter(std::uint32_t face, vec2& low, vec2& high) {
    const vec3 s = shared::face_signs(face);
    for (int i = 0; i < 2; ++i) {
        low[i] = std::max(low[i], s[i] > 0.0f ? 0.0f : -1.0f);
        high[i] = std::min(high[i], s[i] > 0.0f ? 1.0f : 0.0f);
    }
}

// Whether light-space points reach the face's octant.
bool reaches_face(const std::array<vec3, 8>& points, std::uint32_t face) {
    const vec3 s = shared::face_signs(face);
    for (int i = 0; i < 3; ++i)
        if (std::none_of(points.begin(), points.end(), [&](vec3 p) { return p[i] * s[i] >= 0.0f; }))
            return false;
    return true;
}

// Projection of the points through one face; the whole square where one of them is beside or behind the light.
void project(const std::array<vec3, 8>& points, std::uint32_t face, float cone_scale, vec2& low, vec2& high) {
    low = vec2(1.0f);
    high = vec2(-1.0f);
    for (const vec3 p : points) {
        const vec3 clip =
            face == shared::cone_face ? shared::cone_clip(p, cone_scale) : shared::sphere_face_clip(p, face);
        if (!(clip.z > 1e-3f * glm::length(p))) {
            low = vec2(-1.0f);
            high = vec2(1.0f);
            return;
        }
        low = glm::min(low, vec2(clip) / clip.z);
        high = glm::max(high, vec2(clip) / clip.z);
    }
    low = glm::max(low, vec2(-1.0f));
    high = glm::min(high, vec2(1.0f));
}

bool empty(vec2 low, vec2 high) {
    return low.x > high.x || low.y > high.y;
}

// Tiles of one level that are needed.
class Marks {
public:
    void add(std::uint32_t level, vec2 low, vec2 high) {
        const std::uint32_t side = 1u << level;
        if (levels_[level].empty())
            levels_[level].resize(std::size_t(side) * side);
        const auto place = [&](float coordinate) {
            return std::min(std::uint32_t(std::max((coordinate * 0.5f + 0.5f) * float(side), 0.0f)), side - 1);
        };
        for (std::uint32_t y = place(low.y); y <= place(high.y); ++y)
            for (std::uint32_t x = place(low.x); x <= place(high.x); ++x)
                levels_[level][y * side + x] = 1;
    }
    std::vector<TileKey> keys(std::uint32_t light) const {
        std::vector<TileKey> result;
        for (std::uint32_t level = 0; level < shared::tile_levels; ++level)
            for (std::uint32_t i = 0; i < levels_[level].size(); ++i)
                if (levels_[level][i])
                    result.push_back({light, level, i & ((1u << level) - 1), i >> level});
        return result;
    }

private:
    std::array<std::vector<std::uint8_t>, shared::tile_levels> levels_;
};

} // namespace

MapTile tile_on_map(const TileKey& key) {
    const float side = float(1u << key.level);
    return {(vec2(float(key.x), float(key.y)) + 0.5f) * (2.0f / side) - 1.0f,
            side * float(shared::tile_inner) / float(shared::tile_side)};
}

void add_places(const shared::LightRow& light, std::uint32_t light_class, std::uint32_t receiver, const Bounds& bounds,
                std::vector<ReceiverPlace>& places) {
    std::array<vec3, 8> points = corners_of(bounds);
    const vec3 origin(light.position_bound);
    float farthest = 0.0f;
    for (vec3& p : points) {
        const vec3 v = p - origin;
        farthest = std::max(farthest, glm::length(v));
        p = vec3(glm::dot(vec3(light.tangent_scale), v), glm::dot(vec3(light.bitangent), v),
                 glm::dot(vec3(light.normal_offset), v));
    }
    constexpr float texel = 2.0f / float(shared::tile_inner); // of level 0, in map coordinates
    ReceiverPlace place{receiver, vec2(1.0f), vec2(-1.0f), 0.0f};
    if (light_class == shared::light_class_directional) {
        for (const vec3 p : points) {
            place.low = glm::min(place.low, vec2(p) * light.tangent_scale.w);
            place.high = glm::max(place.high, vec2(p) * light.tangent_scale.w);
        }
        place.texel = texel / light.tangent_scale.w;
        places.push_back(place);
        return;
    }
    const float cone_scale = light.position_bound.w;
    place.texel = texel * farthest / std::max(cone_scale, 1.0f);
    if (cone_scale > 0.0f) {
        if (std::none_of(points.begin(), points.end(), [](vec3 p) { return p.z > 0.0f; }))
            return;
        project(points, shared::cone_face, cone_scale, place.low, place.high);
        if (!empty(place.low, place.high))
            places.push_back(place);
        return;
    }
    for (std::uint32_t face = 0; face < 8; ++face) {
        if (!reaches_face(points, face))
            continue;
        project(points, face, 0.0f, place.low, place.high);
        clip_to_quarter(face, place.low, place.high);
        if (!empty(place.low, place.high))
            places.push_back(place);
    }
}

namespace {

vec4 row_of(const mat4& m, int row) {
    return {m[0][row], m[1][row], m[2][row], m[3][row]};
}

// Middle and half the width of what dot(v, (p, 1)) is over the box.
vec2 range_over(vec4 v, vec3 centre, vec3 half) {
    return {glm::dot(vec3(v), centre) + v.w, glm::dot(glm::abs(vec3(v)), half)};
}

} // namespace

TileView::TileView(const mat4& view_projection, std::uint32_t height) {
    const vec4 x = row_of(view_projection, 0), y = row_of(view_projection, 1);
    distance_ = row_of(view_projection, 3);
    planes_[0] = distance_ + x;
    planes_[1] = distance_ - x;
    planes_[2] = distance_ + y;
    planes_[3] = distance_ - y;
    planes_[4] = distance_;
    along_ = glm::length(vec3(distance_));
    pixel_ = 2.0f / (float(height) * std::max(glm::length(vec3(y)), 1e-30f));
}

std::optional<float> TileView::pixel_side(const Bounds& bounds) const {
    const vec3 centre = bounds.centre(), half = 0.5f * bounds.extent();
    for (const vec4& plane : planes_)
        if (const vec2 range = range_over(plane, centre, half); range.x + range.y < 0.0f)
            return std::nullopt;
    if (!(along_ > 0.0f))
        return pixel_;
    const vec2 range = range_over(distance_, centre, half);
    // A box around the camera is seen from some distance in most of its pixels.
    return std::max(range.x - range.y, 0.25f * along_ * glm::length(half)) * pixel_;
}

std::vector<TileKey> needed_tiles(std::uint32_t light, const TileDemand& demand, float coarser) {
    Marks marks;
    if (demand.whole_map)
        marks.add(0, vec2(-1.0f), vec2(1.0f));
    for (const std::span<const ReceiverPlace> places : demand.places)
        for (const ReceiverPlace& place : places) {
            const std::optional<float>& pixel = demand.pixels[place.receiver];
            if (!pixel)
                continue;
            const float texels = std::max(place.texel * demand.detail / std::max(*pixel, 1e-30f), 1e-6f);
            const float level = std::ceil(std::log2(texels) - coarser);
            marks.add(std::uint32_t(std::clamp(level, 0.0f, float(shared::tile_levels - 1))), place.low, place.high);
        }
    return marks.keys(light);
}

} // namespace sunfleck::gi
