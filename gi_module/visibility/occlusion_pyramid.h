// The region that all light from one sample to one receiver passes through. Thesis sec. 4.3.1, fig. 4-5.
//
// For a planar receiver it is the skewed pyramid from the sample to the patch's corners; for any other, a pyramid
// widened until it encloses the receiver's box. Light without a position (a directional sample) gives a prism. What
// does not enter the region cannot shadow the receiver.
#pragma once

#include "gi_module/transport/light_sample.h"
#include "gi_module/visibility/convex.h"

#include <optional>

namespace sunfleck::gi {

// Touching is not entering: what reaches less deep than this (m) into a region does not count. Walls stand on the
// border of floors, and samples lie on surfaces. It must be tiny: light that grazes a surface passes through regions
// that are hardly thicker.
inline constexpr double touching = 1e-8;

struct OcclusionPyramid {
    static constexpr int max_planes = 12;
    std::array<Plane, max_planes> planes; // all points of the region are inside all of them
    int plane_count = 0;
    // Convex polygon that all the light passes on its last stretch: the patch itself, or a cross-section in front of
    // the receiver. If all segments from the sample to its corners are blocked by one convex body, all light is.
    std::array<dvec3, 12> gate;
    int gate_count = 0;
    dvec3 apex{0.0};           // position, or direction of travel
    bool parallel = false;     // the light is directional
    bool ends_at_gate = false; // the region is the hull of apex and gate
    Bounds bounds;
    // The planes again in single precision, component by component and in reverse (the sides, which reject most, come
    // last): four are tested at once.
    static constexpr int lanes = 4;
    std::array<float, max_planes> normals_x{}, normals_y{}, normals_z{}, offsets;

    void add(const Plane& plane) { planes[std::size_t(plane_count++)] = plane; }
    std::span<const dvec3> gate_points() const { return {gate.data(), std::size_t(gate_count)}; }
    // From a point towards the light, to its position or one unit of length.
    dvec3 to_light(dvec3 point) const { return parallel ? -apex : apex - point; }
};

// Of a planar patch with the corners `polygon` (convex, counter-clockwise about `normal`). Nothing if the patch cannot
// receive light from the sample: it faces away, or lies behind the sample's surface or outside its cone.
std::optional<OcclusionPyramid> pyramid_of_patch(const LightSample& sample, std::span<const dvec3> polygon,
                                                 dvec3 normal);

// Of whatever lies in a box. Nothing if the box lies behind the sample's surface.
std::optional<OcclusionPyramid> pyramid_of_box(const LightSample& sample, const OrientedBox& box);
// The same without planes and bounds: apex and gate are all that full occlusion (StaticBlockers::covers) looks at.
std::optional<OcclusionPyramid> gate_of_box(const LightSample& sample, const OrientedBox& box);

// Whether a polygon enters the region, and whether a box may (errs on the side of yes).
bool enters(const OcclusionPyramid& pyramid, std::span<const dvec3> polygon);
bool may_enter(const OcclusionPyramid& pyramid, const OrientedBox& box);
bool may_enter(const OcclusionPyramid& pyramid, const Bounds& bounds);

// The same as may_enter(pyramid_of_patch(sample, corners, normal), box) for a patch that the sample reaches, without
// making the pyramid.
bool may_enter_patch(const LightSample& sample, std::span<const dvec3, 4> corners, dvec3 normal,
                     const OrientedBox& box);

} // namespace sunfleck::gi
