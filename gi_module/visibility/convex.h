// Convex polygons and planes in double precision: what visibility is decided with.
#pragma once

#include "engine/core/maths.h"

#include <glm/gtc/type_precision.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace sunfleck::gi {

using glm::dvec3;

// Points with dot(normal, x) + offset > 0 are inside.
struct Plane {
    dvec3 normal{0.0};
    double offset = 0.0;
    double distance(dvec3 point) const { return glm::dot(normal, point) + offset; }
};

// A planar convex polygon, counter-clockwise about its normal.
using Polygon = std::vector<dvec3>;

// A polygon on the stack, for clipping. Polygons that would grow beyond the capacity stay as they were, which errs on
// the side of "something is left".
struct ClippedPolygon {
    static constexpr int capacity = 40;
    std::array<dvec3, capacity> points;
    int count = 0;

    void assign(std::span<const dvec3> polygon) {
        count = int(std::min<std::size_t>(polygon.size(), capacity));
        std::copy_n(polygon.begin(), count, points.begin());
    }
    std::span<const dvec3> span() const { return {points.data(), std::size_t(count)}; }

    // Into `result` what is farther than `margin` inside the plane (Sutherland and Hodgman). False if nothing is left.
    bool clip_to(const Plane& plane, double margin, ClippedPolygon& result) const {
        result.count = 0;
        double da = count > 0 ? plane.distance(points[0]) - margin : 0.0;
        const double first = da;
        for (int i = 0; i < count; ++i) {
            const bool last = i + 1 == count;
            const dvec3 &a = points[i], &b = points[last ? 0 : i + 1];
            const double db = last ? first : plane.distance(b) - margin;
            if (result.count + 2 > capacity) {
                result = *this;
                return true;
            }
            if (da > 0.0)
                result.points[result.count++] = a;
            if ((da > 0.0) != (db > 0.0))
                result.points[result.count++] = a + (b - a) * (da / (da - db));
            da = db;
        }
        return result.count >= 3;
    }
    // The same in place.
    bool clip(const Plane& plane, double margin) {
        ClippedPolygon result;
        const bool left = clip_to(plane, margin, result);
        count = left ? result.count : 0;
        std::copy_n(result.points.begin(), count, points.begin());
        return left;
    }
};

// Newell's normal; its length is twice the area.
inline dvec3 area_vector(std::span<const dvec3> polygon) {
    dvec3 sum(0.0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const dvec3 a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
        sum += glm::cross(a, b);
    }
    return sum;
}

// An oriented box.
struct OrientedBox {
    dvec3 centre{0.0};
    std::array<dvec3, 3> half_axes{dvec3(0.0), dvec3(0.0), dvec3(0.0)};

    dvec3 corner(int index) const {
        return centre + (index & 1 ? half_axes[0] : -half_axes[0]) + (index & 2 ? half_axes[1] : -half_axes[1]) +
               (index & 4 ? half_axes[2] : -half_axes[2]);
    }
    // Greatest distance of a point of the box inside the plane.
    double reach(const Plane& plane) const {
        return plane.distance(centre) + std::abs(glm::dot(plane.normal, half_axes[0])) +
               std::abs(glm::dot(plane.normal, half_axes[1])) + std::abs(glm::dot(plane.normal, half_axes[2]));
    }
    static OrientedBox of(const Bounds& bounds, const mat4& matrix = mat4(1.0f)) {
        OrientedBox box;
        const vec3 half = 0.5f * bounds.extent();
        box.centre = dvec3(vec3(matrix * vec4(bounds.centre(), 1.0f)));
        for (int i = 0; i < 3; ++i)
            box.half_axes[std::size_t(i)] = dvec3(vec3(matrix[i])) * double(half[i]);
        return box;
    }
};

} // namespace sunfleck::gi
