// How far a picture's surfaces are from other surfaces, to compare light samples (VPLs) only where they are meant to be
// accurate.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "engine/scene/camera_view.h"

#include <vector>

namespace sunfleck::gi::reference {

// For each pixel's centre the distance, m, from the visible surface to the nearest other surface, found by `directions`
// rays spread evenly over the hemisphere; 0 for background. Multi-threaded.
std::vector<float> surface_distances(const raytrace::RayScene& rays, const scene::CameraView& camera,
                                     std::uint32_t width, std::uint32_t height, std::uint32_t directions = 512);

} // namespace sunfleck::gi::reference
