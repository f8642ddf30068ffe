// What light of reflective shadow maps does for the picture: of blocks of texels, how much of the light at some points
// that the camera sees is theirs, walls between them considered. The paper chooses pixel lights by what they emit;
// light that nobody sees counts as much there.
#pragma once

#include "gi_module/light_sampling/reflective_shadow_map.h"

#include <span>
#include <vector>

namespace sunfleck::gi {

struct SeenPoint {
    vec3 position{0.0f}; // above the surface
    vec3 normal{0.0f};   // unit, towards the camera
};

// On a regular grid of the picture. `view_projection`: world to clip, reverse depth without a far plane.
std::vector<SeenPoint> seen_points(const mat4& view_projection, const raytrace::RayScene& rays);

// Blocks of a map along a side, of `maps` maps that share the work.
std::uint32_t contribution_blocks(std::uint32_t side, std::size_t maps);

// What the blocks of a map give the points: W/m2, unless divided by the luminance of a block's flux.
struct BlockLight {
    std::uint32_t blocks = 0;     // along a side
    std::vector<float> per_flux;  // block by block, each with all points: 1/m2
    std::vector<float> at_points; // of all blocks, luminance
};
BlockLight trace_block_light(const ReflectiveShadowMap& map, std::uint32_t blocks, std::span<const SeenPoint> points,
                             const raytrace::RayScene& rays);

// For each block, the mean share that a flux of 1 W in it has of all light at the points (`all`, by point), 1/W. Dark
// points count as if they had a tenth of the mean.
std::vector<float> block_contributions(const BlockLight& light, std::span<const float> all);

} // namespace sunfleck::gi
