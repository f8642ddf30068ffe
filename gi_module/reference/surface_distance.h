// How far a picture's surfaces are from other surfaces, for judging light samples where they are meant to be exact.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "engine/scene/camera_view.h"

#include <vector>

namespace sunfleck::gi::reference {

// For each pixel's centre the distance, m, from the surface that it shows to the nearest other surface, found by
// `directions` rays spread evenly over the hemisphere; 0 where nothing is seen. Multi-threaded.
std::vector<float> surface_distances(const raytrace::RayScene& rays, const scene::CameraView& camera,
                                     std::uint32_t width, std::uint32_t height, std::uint32_t directions = 512);

} // namespace sunfleck::gi::reference
