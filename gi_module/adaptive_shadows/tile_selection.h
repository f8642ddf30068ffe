// Which tiles of a light's shadow map a picture needs, so that its shadows have about a texel a pixel: adaptive shadow
// maps (R. Fernando, S. Fernandez, K. Bala, D. Greenberg, "Adaptive Shadow Maps", SIGGRAPH 2001), with the tiles chosen
// from boxes around the receivers instead of from pixels, so that a frame needs nothing that the GPU found out in an
// earlier one.
#pragma once

#include "gi_module/adaptive_shadows/adaptive_shadows_shared.h"
#include "gi_module/shadows/map_area.h"

#include <compare>
#include <optional>
#include <span>
#include <vector>

namespace sunfleck::gi {

struct TileKey {
    std::uint32_t light = 0;
    std::uint32_t level = 0; // the map has 2^level tiles along a side
    std::uint32_t x = 0, y = 0;
    auto operator<=>(const TileKey&) const = default;
};
MapTile tile_on_map(const TileKey& key);

// Where a receiver lies on a light's map.
struct ReceiverPlace {
    std::uint32_t receiver = 0;
    vec2 low{0.0f}, high{0.0f}; // in map coordinates, within [-1, 1]^2
    float texel = 0.0f;         // side of a texel of level 0 where the receiver is farthest from the light
};
// Appends the places of a receiver: one per face of the map that it may be lit through.
void add_places(const shared::LightRow& light, std::uint32_t light_class, std::uint32_t receiver, const Bounds& bounds,
                std::vector<ReceiverPlace>& places);

// What a camera sees, and how large its pixels are.
class TileView {
public:
    // `view_projection`: to clip, reverse depth without a far plane. `height`: of the picture, pixels.
    TileView(const mat4& view_projection, std::uint32_t height);
    // Side of a pixel where the box is nearest to the camera; nothing if the camera does not see it.
    std::optional<float> pixel_side(const Bounds& bounds) const;

private:
    vec4 planes_[5];     // of what is seen: dot(plane, (p, 1)) >= 0
    vec4 distance_;      // dot(distance, (p, 1)): along the axis, times along_
    float along_ = 0.0f; // 0: parallel projection
    float pixel_ = 0.0f; // side of a pixel where that is 1
};

struct TileDemand {
    std::span<const ReceiverPlace> places[2];     // of receivers, in two parts
    std::span<const std::optional<float>> pixels; // by receiver, TileView::pixel_side
    float detail = 1.0f;                          // texels a pixel
    bool whole_map = true;                        // in any case: for what a budget leaves undrawn
};
// Tiles of one light, coarse ones first. `coarser`: levels by which all are coarser than demanded.
std::vector<TileKey> needed_tiles(std::uint32_t light, const TileDemand& demand, float coarser);

} // namespace sunfleck::gi
