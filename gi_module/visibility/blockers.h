// What can stand between a sample and a receiver, and how much of the light it takes. Thesis sec. 4.3.1: simple objects
// are tested polygon by polygon, complex ones by a bounding volume (a box here, which fits tighter than a sphere).
#pragma once

#include "gi_module/visibility/occlusion_pyramid.h"
#include "gi_module/visibility/planar_faces.h"

namespace sunfleck::gi {

// How much of the light from a sample to a receiver something blocks.
enum class Blocking : std::uint8_t { none, partial, full };

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
    // A convex closed body does not shadow itself: what it hides faces away from the light.
    bool convex() const { return convex_; }

private:
    Bounds local_bounds_, bounds_;
    OrientedBox box_;
    std::vector<Polygon> local_polygons_, polygons_; // empty: complex
    std::vector<Plane> planes_;                      // of a box, inside is positive
    bool convex_ = false, is_box_ = false;
};

// All static geometry: a tree of polygons.
class StaticBlockers {
public:
    // Adds a mesh of static geometry; opaque on both sides, or porous: with holes, never all that blocks.
    void add(const FlatMesh& mesh, bool porous = false);
    // Builds the tree. Nothing can be tested before.
    void build();

    Blocking test(const OcclusionPyramid& pyramid) const;
    // Whether one polygon or body surely takes all light: what `test` calls full, found in less time.
    bool covers(const OcclusionPyramid& pyramid) const;
    // Whether anything crosses the segment from `from` to `from + along`.
    bool crosses_segment(dvec3 from, dvec3 along) const;
    std::size_t polygons() const { return polygons_.size(); }

private:
    struct Node {
        Bounds bounds;
        float largest = 0.0f;               // size of the largest polygon or its body
        std::uint32_t first = 0, count = 0; // of polygons in a leaf; in an inner node count is 0, first the left child
        std::uint32_t right = 0;
    };
    std::uint32_t build(std::uint32_t first, std::uint32_t count);
    // Calls `visit` with the polygons of all leaves that `meets` accepts, as all nodes above them, until it returns
    // true.
    template <typename Meets, typename Visit>
    bool visit_leaves(const Meets& meets, const Visit& visit) const;
    // Calls `visit` with polygons that cross the segment until it returns true.
    template <typename Visit>
    bool visit_crossing(dvec3 from, dvec3 along, const Visit& visit) const;

    std::vector<Polygon> polygons_;
    std::vector<std::vector<Plane>> bodies_; // convex closed bodies, by their planes (inside is positive)
    std::vector<std::uint32_t> body_of_;     // of a polygon; 0xffffffff: none
    std::vector<std::uint8_t> porous_;       // of polygons
    std::vector<float> sizes_;               // of polygons, or of the body that they belong to: a bound of the diameter
    std::vector<Bounds> bounds_;
    std::vector<dvec3> normals_; // of polygons, as long as their area is large
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

// The planes of a closed convex body with few faces; empty if it is not one.
std::vector<Plane> planes_of_convex_body(const FlatMesh& mesh);

} // namespace sunfleck::gi
