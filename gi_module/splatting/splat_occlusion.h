// What blocks the light of pixel lights: a small shadow map of each, made by rays with movers in them, or a factor of
// its flux (ambient occlusion, paper, sec. 3.6).
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/transport/pixel_light_shared.h"

#include <cstdint>
#include <span>
#include <vector>

namespace sunfleck::gi {

// Hemisphere maps (shadows/octahedral_map.h) of all lights, one after the other, `side` x `side` texels of 16 bits
// each; `side` is a multiple of 4. All rays of a map start at its light.
void trace_pixel_light_maps(std::span<const shared::PixelLightRow> lights, std::uint32_t side,
                            const raytrace::RayScene& rays, std::vector<std::uint16_t>& texels);

// Share of the cosine-weighted hemisphere above a light that is blocked nearer than `reach`, units of the scene; by 16
// rays.
float ambient_occlusion(const shared::PixelLightRow& light, float reach, const raytrace::RayScene& rays);

// The largest side of maps, at most `wanted`, with which `lights` of them stay within the memory that is allowed for
// them.
std::uint32_t side_of_pixel_light_maps(std::uint32_t wanted, std::size_t lights);

} // namespace sunfleck::gi
