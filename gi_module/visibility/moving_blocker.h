// What of an object that moves can stand between a sample and a receiver, and how much of the light it takes. Thesis
// sec. 4.3.1: simple objects are tested polygon by polygon, complex ones by a bounding volume (a box here, which fits
// tighter than a sphere).
#pragma once

#include "gi_module/visibility/coverage.h"

namespace sunfleck::gi {

// A moving object. Simple ones (few polygons) are exact; of complex ones only the box is known, and they never block
// fully.
class MovingBlocker {
public:
    static constexpr std::size_t simple_polygons = 64;

    MovingBlocker() = default;
    // `solid`: it has no holes and keeps its shape; else it is taken as complex.
    explicit MovingBlocker(const scene::Mesh& mesh, bool solid = true);
    // Brings it to where it is now.
    void place(const mat4& matrix);

    Blocking test(const OcclusionPyramid& pyramid) const;
    // Only the box is known: it blocks partially or not at all.
    bool complex() const { return polygons_.empty(); }
    // The object is its box.
    bool is_box() const { return is_box_; }
    // Of a box: whether it may take all light from the sample to a patch with these corners. Cheap, and false for most.
    bool may_cover(const LightSample& sample, std::span<const dvec3, 4> corners) const;
    const OrientedBox& box() const { return box_; }
    const Bounds& bounds() const { return bounds_; }
    // Of the ball around the bounds.
    float radius() const { return radius_; }
    // A convex closed body does not shadow itself: what it hides faces away from the light.
    bool convex() const { return convex_; }

private:
    Bounds local_bounds_, bounds_;
    float radius_ = 0.0f;
    OrientedBox box_;
    std::vector<Polygon> local_polygons_, polygons_; // empty: complex
    std::vector<Plane> planes_;                      // of a box, inside is positive
    bool convex_ = false, is_box_ = false;
};

} // namespace sunfleck::gi
