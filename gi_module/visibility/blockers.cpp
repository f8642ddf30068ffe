#include "gi_module/visibility/blockers.h"

#include <algorithm>
#include <numeric>

namespace sunfleck::gi {
namespace {

// Blocked light must meet its blocker between these parts of its way: blockers that touch an end do not count as full.
constexpr double earliest = 2e-4, latest = 1.0 - 2e-4;

// Whether all segments from the gate to the light cross the convex polygon. Shadows of convex bodies are convex, so the
// gate's corners speak for all of it.
bool covers_gate(const OcclusionPyramid& pyramid, std::span<const dvec3> polygon) {
    if (pyramid.gate_count == 0)
        return false;
    const dvec3 area = area_vector(polygon);
    const double length = glm::length(area);
    if (length < 1e-12)
        return false;
    const dvec3 normal = area / length;
    for (const dvec3& corner : pyramid.gate_points()) {
        const dvec3 direction = pyramid.to_light(corner);
        const double slope = glm::dot(normal, direction);
        if (std::abs(slope) < 1e-12)
            return false;
        const double t = glm::dot(normal, polygon[0] - corner) / slope;
        if (t < earliest || (!pyramid.parallel && t > latest))
            return false;
        const dvec3 point = corner + t * direction;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const dvec3 a = polygon[i], edge = polygon[(i + 1) % polygon.size()] - a;
            if (glm::dot(glm::cross(normal, edge), point - a) < 1e-7 * glm::length(edge))
                return false;
        }
    }
    return true;
}

// Whether the segment from a corner to the light passes through a convex body that lies between them.
bool crosses(const std::vector<Plane>& body, dvec3 corner, dvec3 direction, bool parallel) {
    double enter = -1e300, leave = 1e300;
    for (const Plane& plane : body) {
        const double start = plane.distance(corner) - 1e-7, slope = glm::dot(plane.normal, direction);
        if (std::abs(slope) < 1e-14) {
            if (start < 0.0)
                return false;
            continue;
        }
        const double t = -start / slope;
        if (slope > 0.0)
            enter = std::max(enter, t);
        else
            leave = std::min(leave, t);
    }
    return enter < leave && enter >= earliest && (parallel || enter <= latest);
}

bool covers_gate(const OcclusionPyramid& pyramid, const std::vector<Plane>& body) {
    if (pyramid.gate_count == 0)
        return false;
    for (const dvec3& corner : pyramid.gate_points())
        if (!crosses(body, corner, pyramid.to_light(corner), pyramid.parallel))
            return false;
    return true;
}

} // namespace

std::vector<Plane> planes_of_convex_body(const FlatMesh& mesh) {
    if (!mesh.closed || mesh.faces.size() < 4 || mesh.faces.size() > 64)
        return {};
    std::vector<Plane> planes;
    for (const PlanarFace& face : mesh.faces) {
        const dvec3 inward = -face.normal;
        planes.push_back({inward, -glm::dot(inward, mesh.corner(face.triangles[0], 0))});
    }
    const double tolerance = 1e-6 * std::sqrt(mesh.area);
    for (const Plane& plane : planes)
        for (const dvec3& position : mesh.positions)
            if (plane.distance(position) < -tolerance)
                return {};
    return planes;
}

MovingBlocker::MovingBlocker(const scene::Mesh& mesh, bool solid) : local_bounds_(mesh.bounds()) {
    if (!solid) {
        place(mat4(1.0f));
        return;
    }
    const FlatMesh flat = find_planar_faces(mesh, mat4(1.0f));
    convex_ = !planes_of_convex_body(flat).empty();
    if (flat.faces.size() <= simple_polygons)
        for (const PlanarFace& face : flat.faces)
            for (Polygon& polygon : convex_pieces(flat, face))
                local_polygons_.push_back(std::move(polygon));
    if (local_polygons_.size() > simple_polygons)
        local_polygons_.clear();
    is_box_ = convex_ && local_polygons_.size() == 6;
    for (const Polygon& polygon : local_polygons_)
        for (const dvec3& point : polygon)
            for (int axis = 0; axis < 3 && is_box_; ++axis)
                is_box_ = std::abs(std::abs(point[axis] - double(local_bounds_.centre()[axis])) -
                                   0.5 * double(local_bounds_.extent()[axis])) < 1e-6;
    polygons_ = local_polygons_;
    place(mat4(1.0f));
}

void MovingBlocker::place(const mat4& matrix) {
    box_ = OrientedBox::of(local_bounds_, matrix);
    bounds_ = {};
    for (int i = 0; i < 8; ++i)
        bounds_.add(vec3(box_.corner(i)));
    for (std::size_t i = 0; i < polygons_.size(); ++i)
        for (std::size_t k = 0; k < polygons_[i].size(); ++k)
            polygons_[i][k] = dvec3(vec3(matrix * vec4(vec3(local_polygons_[i][k]), 1.0f)));
    planes_.clear();
    for (std::size_t i = 0; is_box_ && i < polygons_.size(); ++i) {
        const dvec3 area = area_vector(polygons_[i]), to_centre = box_.centre - polygons_[i][0];
        const double length = glm::length(area);
        if (!(length > 1e-12)) { // squeezed flat: nothing is inside
            planes_.assign(1, {dvec3(0.0), -1.0});
            break;
        }
        const dvec3 inward = (glm::dot(area, to_centre) < 0.0 ? -area : area) / length;
        planes_.push_back({inward, -glm::dot(inward, polygons_[i][0])});
    }
}

bool MovingBlocker::may_cover(const LightSample& sample, std::span<const dvec3, 4> corners) const {
    const bool parallel = sample.kind == SampleKind::directional;
    for (const dvec3& corner : corners) {
        const dvec3 direction = parallel ? -dvec3(sample.normal) : dvec3(sample.position) - corner;
        if (sample.kind == SampleKind::surface && glm::dot(dvec3(sample.normal), direction) >= 0.0)
            continue; // behind the sample's surface: not of the lit part
        if (!crosses(planes_, corner, direction, parallel))
            return false;
    }
    return true;
}

Blocking MovingBlocker::test(const OcclusionPyramid& pyramid) const {
    if (!may_enter(pyramid, box_))
        return Blocking::none;
    if (polygons_.empty())
        return Blocking::partial;
    if (is_box_)
        return covers_gate(pyramid, planes_) ? Blocking::full : Blocking::partial;
    bool any = false;
    for (const Polygon& polygon : polygons_) {
        if (!enters(pyramid, polygon))
            continue;
        any = true;
        if (covers_gate(pyramid, polygon))
            return Blocking::full;
    }
    return any ? Blocking::partial : Blocking::none;
}

void StaticBlockers::add(const FlatMesh& mesh, bool porous) {
    std::uint32_t body = 0xffffffffu;
    if (std::vector<Plane> planes = planes_of_convex_body(mesh); !planes.empty() && !porous) {
        body = std::uint32_t(bodies_.size());
        bodies_.push_back(std::move(planes));
    }
    Bounds whole;
    for (const dvec3& position : mesh.positions)
        whole.add(vec3(position));
    for (const PlanarFace& face : mesh.faces)
        for (Polygon& polygon : convex_pieces(mesh, face)) {
            Bounds bounds;
            for (const dvec3& point : polygon)
                bounds.add(vec3(point));
            bounds_.push_back(bounds);
            normals_.push_back(area_vector(polygon));
            polygons_.push_back(std::move(polygon));
            body_of_.push_back(body);
            porous_.push_back(porous ? 1 : 0);
            sizes_.push_back(porous ? 0.0f : glm::length((body != 0xffffffffu ? whole : bounds).extent()));
        }
}

void StaticBlockers::build() {
    order_.resize(polygons_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.clear();
    if (!order_.empty())
        build(0, std::uint32_t(order_.size()));
}

std::uint32_t StaticBlockers::build(std::uint32_t first, std::uint32_t count) {
    const std::uint32_t index = std::uint32_t(nodes_.size());
    nodes_.push_back({});
    Bounds bounds, centres;
    for (std::uint32_t i = first; i < first + count; ++i) {
        bounds.add(bounds_[order_[i]]);
        centres.add(bounds_[order_[i]].centre());
        nodes_[index].largest = std::max(nodes_[index].largest, sizes_[order_[i]]);
    }
    nodes_[index].bounds = bounds;
    if (count <= 4) {
        nodes_[index].first = first;
        nodes_[index].count = count;
        return index;
    }
    const vec3 extent = centres.extent();
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
                     [&](std::uint32_t a, std::uint32_t b) {
                         const float ca = bounds_[a].centre()[axis], cb = bounds_[b].centre()[axis];
                         return ca != cb ? ca < cb : a < b;
                     });
    const std::uint32_t left = build(first, half);
    const std::uint32_t right = build(first + half, count - half);
    nodes_[index].first = left;
    nodes_[index].right = right;
    return index;
}

template <typename Meets, typename Visit>
bool StaticBlockers::visit_leaves(const Meets& meets, const Visit& visit) const {
    if (nodes_.empty())
        return false;
    std::array<std::uint32_t, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        if (!meets(node))
            continue;
        if (node.count == 0) {
            stack[depth++] = node.first;
            stack[depth++] = node.right;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
            if (visit(order_[i]))
                return true;
    }
    return false;
}

namespace {

// How large something must be to hide the gate from the sample: as wide as the gate if the light is parallel, else a
// multiple of its distance (the chord between the directions to the gate's points that are furthest apart).
double least_cover(const OcclusionPyramid& pyramid) {
    double largest = 0.0;
    for (const dvec3& a : pyramid.gate_points())
        for (const dvec3& b : pyramid.gate_points()) {
            if (pyramid.parallel) {
                const dvec3 apart = b - a;
                largest = std::max(largest, glm::length(apart - glm::dot(apart, pyramid.apex) * pyramid.apex));
                continue;
            }
            const dvec3 to_a = a - pyramid.apex, to_b = b - pyramid.apex;
            const double lengths = glm::length(to_a) * glm::length(to_b);
            if (lengths > 0.0) // half the angle's sine, from its cosine
                largest = std::max(largest, std::sqrt(std::max(0.0, 2.0 - 2.0 * glm::dot(to_a, to_b) / lengths)));
        }
    return 0.999 * largest;
}

// The whole box is deeper in the region than what merely touches it.
bool is_inside(const OcclusionPyramid& pyramid, const Bounds& bounds) {
    for (int i = 0; i < pyramid.plane_count; ++i) {
        const Plane& plane = pyramid.planes[std::size_t(i)];
        dvec3 nearest;
        for (int axis = 0; axis < 3; ++axis)
            nearest[axis] = double(plane.normal[axis] > 0.0 ? bounds.minimum[axis] : bounds.maximum[axis]);
        if (glm::dot(plane.normal, nearest) + plane.offset <= 2.0 * touching)
            return false;
    }
    return pyramid.plane_count > 0;
}

} // namespace

Blocking StaticBlockers::test(const OcclusionPyramid& pyramid) const {
    bool any = false;
    std::uint32_t last_body = 0xffffffffu;
    const double least = least_cover(pyramid);
    const vec3 apex(pyramid.apex);
    // Nothing of that size inside the bounds hides the gate. Two points of it, `size` apart and no nearer to the apex
    // than `distance`, are seen under a chord of size / distance at most.
    const auto too_small = [&](float size, const Bounds& bounds) {
        if (pyramid.parallel)
            return double(size) < least;
        const double distance = double(glm::length(glm::clamp(apex, bounds.minimum, bounds.maximum) - apex));
        return double(size) < least * distance * 0.999;
    };
    const auto takes_all = [&](std::uint32_t polygon) {
        const bool small = too_small(sizes_[polygon], bounds_[polygon]);
        if ((any && small) || !enters(pyramid, polygons_[polygon]))
            return false;
        any = true;
        if (small || porous_[polygon])
            return false;
        if (covers_gate(pyramid, polygons_[polygon]))
            return true;
        const std::uint32_t body = body_of_[polygon];
        if (body != 0xffffffffu && body != last_body && covers_gate(pyramid, bodies_[body]))
            return true;
        last_body = body;
        return false;
    };
    // Once something takes part of the light, only what could take all of it matters.
    const auto matters = [&](const Node& node) {
        if ((any && too_small(node.largest, node.bounds)) || !may_enter(pyramid, node.bounds))
            return false;
        // What lies inside the region altogether enters it, without a look at its polygons.
        if (!any && is_inside(pyramid, node.bounds)) {
            any = true;
            return !too_small(node.largest, node.bounds);
        }
        return true;
    };
    if (visit_leaves(matters, takes_all))
        return Blocking::full;
    return any ? Blocking::partial : Blocking::none;
}

template <typename Visit>
bool StaticBlockers::visit_crossing(dvec3 from, dvec3 along, const Visit& visit) const {
    // Slabs, a little widened: in single precision, which errs by less. Along an axis that the segment does not follow,
    // its inverse is large, not infinite.
    constexpr float wider = 1e-4f;
    const vec3 start(from);
    vec3 inverse;
    for (int axis = 0; axis < 3; ++axis)
        inverse[axis] = float(1.0 / (std::abs(along[axis]) > 1e-9 ? along[axis] : std::copysign(1e-9, along[axis])));
    const auto meets = [&](const Node& node) {
        const Bounds& bounds = node.bounds;
        float enter = 0.0f, leave = 1.0f;
        for (int axis = 0; axis < 3; ++axis) {
            const float a = (bounds.minimum[axis] - wider - start[axis]) * inverse[axis];
            const float b = (bounds.maximum[axis] + wider - start[axis]) * inverse[axis];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter <= leave;
    };
    return visit_leaves(meets, [&](std::uint32_t index) {
        const Polygon& polygon = polygons_[index];
        const dvec3 normal = normals_[index];
        const double slope = glm::dot(normal, along);
        if (std::abs(slope) < 1e-14)
            return false;
        const double t = glm::dot(normal, polygon[0] - from) / slope;
        if (t < 0.0 || t > 1.0)
            return false;
        const dvec3 point = from + t * along;
        for (std::size_t k = 0; k < polygon.size(); ++k)
            if (glm::dot(glm::cross(normal, polygon[(k + 1) % polygon.size()] - polygon[k]), point - polygon[k]) < 0.0)
                return false;
        return bool(visit(index));
    });
}

bool StaticBlockers::crosses_segment(dvec3 from, dvec3 along) const {
    return visit_crossing(from, along, [](std::uint32_t) { return true; });
}

// What takes all light takes that to the middle of the gate.
bool StaticBlockers::covers(const OcclusionPyramid& pyramid) const {
    if (pyramid.gate_count == 0)
        return false;
    dvec3 middle(0.0);
    for (const dvec3& point : pyramid.gate_points())
        middle += point / double(pyramid.gate_count);
    const dvec3 along = pyramid.parallel ? -1e4 * pyramid.apex : pyramid.apex - middle;
    return visit_crossing(middle, along, [&](std::uint32_t polygon) {
        const std::uint32_t body = body_of_[polygon];
        return !porous_[polygon] && (covers_gate(pyramid, polygons_[polygon]) ||
                                     (body != 0xffffffffu && covers_gate(pyramid, bodies_[body])));
    });
}

} // namespace sunfleck::gi
