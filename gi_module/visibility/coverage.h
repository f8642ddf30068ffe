// When one convex polygon or body takes all light from a sample to a receiver. Thesis sec. 4.3.1, full occlusion.
#pragma once

#include "gi_module/visibility/occlusion_pyramid.h"
#include "gi_module/visibility/planar_faces.h"

namespace sunfleck::gi {

// How much of the light from a sample to a receiver something blocks.
enum class Blocking : std::uint8_t { none, partial, full };

// The planes of a closed convex body with few faces; empty if it is not one.
std::vector<Plane> planes_of_convex_body(const FlatMesh& mesh);

// Whether all segments from the gate to the light cross the convex polygon, or the convex body. Shadows of convex
// things are convex, so the gate's corners speak for all of it.
bool covers_gate(const OcclusionPyramid& pyramid, std::span<const dvec3> polygon);
bool covers_gate(const OcclusionPyramid& pyramid, const std::vector<Plane>& body);
// Whether the segment from a corner to the light passes through a convex body that lies between them.
bool crosses(const std::vector<Plane>& body, dvec3 corner, dvec3 direction, bool parallel);

} // namespace sunfleck::gi
