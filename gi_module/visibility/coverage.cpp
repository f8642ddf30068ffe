#include "gi_module/visibility/coverage.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

// Blocked light must meet its blocker between these parts of its way: blockers that touch an end do not count as full.
constexpr double earliest = 2e-4, latest = 1.0 - 2e-4;
// But a polygon may stand on the gate's border, as a wall on the floor behind it. Both have corners in single
// precision: by so much of their coordinates, some spacings of floats, may the gate's corners there miss it.
constexpr double standing_share = 0x1p-21;

double largest_coordinate(dvec3 point) {
    return std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)});
}

bool is_inside(const std::vector<Plane>& body, dvec3 point) {
    return std::all_of(body.begin(), body.end(), [&](const Plane& plane) { return plane.distance(point) > -touching; });
}

// Whether one of the body's planes has all of the gate behind it.
bool lies_outside(const std::vector<Plane>& body, std::span<const dvec3> gate) {
    return std::any_of(body.begin(), body.end(), [&](const Plane& plane) {
        return std::all_of(gate.begin(), gate.end(), [&](dvec3 point) { return plane.distance(point) < 0.0; });
    });
}

} // namespace

bool covers_gate(const OcclusionPyramid& pyramid, std::span<const dvec3> polygon) {
    if (pyramid.gate_count == 0)
        return false;
    const dvec3 area = area_vector(polygon);
    const double length = glm::length(area);
    if (length < 1e-12)
        return false;
    const dvec3 normal = area / length;
    bool stands_before = false; // some corner; it then lies before all between them
    for (const dvec3& corner : pyramid.gate_points()) {
        const dvec3 direction = pyramid.to_light(corner);
        const double slope = glm::dot(normal, direction);
        if (std::abs(slope) < 1e-12)
            return false;
        const double t = glm::dot(normal, polygon[0] - corner) / slope,
                     standing = standing_share * largest_coordinate(corner);
        const bool touches = std::abs(t) * glm::length(direction) < standing;
        if ((t < earliest && !touches) || (!pyramid.parallel && t > latest))
            return false;
        stands_before = stands_before || !touches;
        const double inside = touches ? -standing : 1e-7;
        const dvec3 point = corner + t * direction;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const dvec3 a = polygon[i], edge = polygon[(i + 1) % polygon.size()] - a;
            if (glm::dot(glm::cross(normal, edge), point - a) < inside * glm::length(edge))
                return false;
        }
    }
    return stands_before;
}

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
    // Light within the body reaches what is within it, too: the floor that a pillar stands on. The gate's corners do
    // not tell.
    if (!pyramid.parallel && is_inside(body, pyramid.apex) && !lies_outside(body, pyramid.gate_points()))
        return false;
    for (const dvec3& corner : pyramid.gate_points())
        if (!crosses(body, corner, pyramid.to_light(corner), pyramid.parallel))
            return false;
    return true;
}

std::vector<Plane> planes_of_convex_body(const FlatMesh& mesh) {
    if (!mesh.closed || mesh.faces.size() < 4 || mesh.faces.size() > 64)
        return {};
    std::vector<Plane> planes;
    for (const PlanarFace& face : mesh.faces) {
        const dvec3 inward = -face.normal;
        planes.push_back({inward, -glm::dot(inward, mesh.corner(mesh.triangles(face)[0], 0))});
    }
    const double tolerance = 1e-6 * std::sqrt(mesh.area);
    for (const Plane& plane : planes)
        for (const dvec3& position : mesh.positions)
            if (plane.distance(position) < -tolerance)
                return {};
    return planes;
}

} // namespace sunfleck::gi
