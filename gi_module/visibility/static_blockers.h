// What of static geometry stands between a sample and a receiver: a tree of its polygons. Thesis sec. 4.3.1.
#pragma once

#include "gi_module/visibility/coverage.h"

#include <algorithm>
#include <functional>

namespace sunfleck::gi {

// Polygons that were in the way of neighbouring pyramids, the last one first: they are likely to be in that of the
// next.
class LikelyBlockers {
public:
    template <typename Enters>
    bool any(const Enters& enters) {
        for (std::size_t i = 0; i < count_; ++i)
            if (enters(polygons_[i])) {
                std::rotate(polygons_.begin(), polygons_.begin() + std::ptrdiff_t(i),
                            polygons_.begin() + std::ptrdiff_t(i) + 1);
                return true;
            }
        return false;
    }
    void add(std::uint32_t polygon) {
        count_ = std::min(count_ + 1, polygons_.size());
        std::shift_right(polygons_.begin(), polygons_.end(), 1);
        polygons_[0] = polygon;
    }

private:
    std::array<std::uint32_t, 6> polygons_{};
    std::size_t count_ = 0;
};

// All static geometry: a tree of polygons.
class StaticBlockers {
public:
    static constexpr std::uint32_t no_body = 0xffffffffu;

    // Adds a mesh of static geometry; opaque on both sides, or porous: with holes, never all that blocks. Returns the
    // number of its body if it is convex and closed.
    std::uint32_t add(const FlatMesh& mesh, bool porous = false);
    // Builds the tree. Nothing can be tested before. `progress` is called with the share that is done; if it returns
    // false, the build stops, and there is nothing to test. False: it was stopped.
    bool build(const std::function<bool(float)>& progress = {});

    // `own_body`: that the receiver is a part of. It does not count: a convex body lies behind each of its faces that
    // the light can see. `likely` saves work and changes no result; of the same receiver, from call to call.
    Blocking test(const OcclusionPyramid& pyramid, std::uint32_t own_body = no_body,
                  LikelyBlockers* likely = nullptr) const;
    // Whether one polygon or body surely takes all light: what `test` calls full. It then takes the light to the middle
    // of the gate, so that only what a single segment crosses has to be looked at.
    bool covers(const OcclusionPyramid& pyramid) const;
    // Whether anything crosses the segment from `from` to `from + along`.
    bool crosses_segment(dvec3 from, dvec3 along) const;
    // Calls `visit` with all polygons near a box that are not porous.
    void visit_polygons(const Bounds& bounds, const std::function<void(std::span<const dvec3>)>& visit) const;
    std::size_t polygons() const { return bounds_.size(); }

private:
    struct Node {
        Bounds bounds;
        float largest = 0.0f;               // size of the largest polygon or its body
        std::uint32_t first = 0, count = 0; // of polygons in a leaf; in an inner node count is 0, first the left child
        std::uint32_t right = 0;
    };
    struct Watch {
        const std::function<bool(float)>& progress;
        std::size_t done = 0, asked = 0; // polygons that lie in leaves; when `progress` was called last
        bool stopped = false;
    };
    std::uint32_t build(std::uint32_t first, std::uint32_t count, std::uint32_t depth, Watch& watch);
    void place_leaf(Node& node, std::uint32_t first, std::uint32_t count, Watch& watch) const;
    std::uint32_t split(std::uint32_t first, std::uint32_t count, const Bounds& centres, std::uint32_t depth);
    bool any_enters(const OcclusionPyramid& pyramid, std::uint32_t own_body, LikelyBlockers* likely) const;
    std::uint32_t a_polygon_of(const Node& node) const;
    // Calls `visit` with the polygons of all leaves that `meets` accepts, as all nodes above them, until it returns
    // true.
    template <typename Meets, typename Visit>
    bool visit_leaves(const Meets& meets, const Visit& visit) const;
    // Calls `visit` with polygons that cross the segment, of nodes that matter, until it returns true.
    template <typename Matters, typename Visit>
    bool visit_crossing(dvec3 from, dvec3 along, const Matters& matters, const Visit& visit) const;

    // Its corners.
    std::span<const dvec3> polygon(std::uint32_t index) const {
        return {corners_.data() + ends_[index], corners_.data() + ends_[index + 1]};
    }

    std::vector<dvec3> corners_; // of all polygons, one after another: millions of vectors would be as many pieces
    std::vector<std::size_t> ends_ = {0};    // where each polygon begins in there, and the last one ends
    std::vector<std::vector<Plane>> bodies_; // convex closed bodies, by their planes (inside is positive)
    std::vector<std::uint32_t> body_of_;     // of a polygon; no_body: none
    std::vector<std::uint8_t> porous_;       // of polygons
    std::vector<float> sizes_;               // of polygons, or of the body that they belong to: a bound of the diameter
    std::vector<Bounds> bounds_;
    std::vector<dvec3> normals_; // of polygons, as long as their area is large
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

} // namespace sunfleck::gi
