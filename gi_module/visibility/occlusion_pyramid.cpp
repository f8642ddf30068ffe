#include "gi_module/visibility/occlusion_pyramid.h"

namespace sunfleck::gi {
namespace {

// Length of the prism of a directional light, m: longer than any scene that single precision can hold sensibly.
constexpr double far_away = 1e5;

void round_planes(OcclusionPyramid& pyramid) {
    pyramid.offsets.fill(1.0f); // lanes without a plane accept everything
    for (int i = 0; i < pyramid.plane_count; ++i) {
        const Plane& plane = pyramid.planes[std::size_t(pyramid.plane_count - 1 - i)];
        pyramid.normals_x[std::size_t(i)] = float(plane.normal.x);
        pyramid.normals_y[std::size_t(i)] = float(plane.normal.y);
        pyramid.normals_z[std::size_t(i)] = float(plane.normal.z);
        pyramid.offsets[std::size_t(i)] = float(plane.offset);
    }
}

void finish_bounds(OcclusionPyramid& pyramid) {
    for (const dvec3& point : pyramid.gate_points())
        pyramid.bounds.add(vec3(point));
    if (!pyramid.parallel) {
        pyramid.bounds.add(vec3(pyramid.apex));
    } else {
        const std::array<dvec3, 12> gate = pyramid.gate;
        for (int i = 0; i < pyramid.gate_count; ++i)
            pyramid.bounds.add(vec3(gate[std::size_t(i)] - pyramid.apex * far_away));
    }
    const vec3 slack(1e-4f);
    pyramid.bounds.minimum -= slack;
    pyramid.bounds.maximum += slack;
    round_planes(pyramid);
}

// Planes through the light and each edge of the gate.
void add_sides(OcclusionPyramid& pyramid) {
    dvec3 centre(0.0);
    for (const dvec3& point : pyramid.gate_points())
        centre += point / double(pyramid.gate_count);
    for (int i = 0; i < pyramid.gate_count; ++i) {
        const dvec3 a = pyramid.gate[std::size_t(i)], b = pyramid.gate[std::size_t((i + 1) % pyramid.gate_count)];
        dvec3 normal = glm::cross(b - a, pyramid.to_light(a));
        const double length = glm::length(normal);
        if (length < 1e-14)
            continue;
        normal /= length;
        if (glm::dot(normal, centre - a) < 0.0)
            normal = -normal;
        pyramid.add({normal, -glm::dot(normal, a)});
    }
}

bool has_front(const LightSample& sample) {
    return sample.kind == SampleKind::surface;
}

Plane front_of(const LightSample& sample) {
    const dvec3 normal(sample.normal);
    return {normal, -glm::dot(normal, dvec3(sample.position))};
}

void set_apex(OcclusionPyramid& pyramid, const LightSample& sample) {
    pyramid.parallel = sample.kind == SampleKind::directional;
    pyramid.apex = dvec3(pyramid.parallel ? sample.normal : sample.position);
}

// Whether a sphere lies outside a spot light's cone.
bool outside_cone(const LightSample& sample, dvec3 centre, double radius) {
    if (sample.kind != SampleKind::spot || sample.cone_scale <= 0.0f)
        return false;
    const double cosine = std::clamp(-double(sample.cone_offset) / double(sample.cone_scale), -1.0, 1.0);
    const dvec3 v = centre - dvec3(sample.position);
    const double distance = glm::length(v);
    if (distance <= radius)
        return false;
    const double angle = std::acos(std::clamp(glm::dot(v, dvec3(sample.normal)) / distance, -1.0, 1.0));
    return angle > std::acos(cosine) + std::asin(radius / distance) + 1e-6;
}

void bounding_sphere(std::span<const dvec3> points, dvec3& centre, double& radius) {
    centre = dvec3(0.0);
    for (const dvec3& point : points)
        centre += point / double(points.size());
    radius = 0.0;
    for (const dvec3& point : points)
        radius = std::max(radius, glm::length(point - centre));
}

// No direction separates the light from the box: all that can be said is that the region lies in the box around both.
OcclusionPyramid pyramid_around(const LightSample& sample, const OrientedBox& box) {
    OcclusionPyramid pyramid;
    set_apex(pyramid, sample);
    Bounds bounds;
    for (int i = 0; i < 8; ++i)
        bounds.add(vec3(box.corner(i)));
    bounds.add(sample.position);
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 normal(0.0);
        normal[axis] = 1.0;
        pyramid.add({normal, -double(bounds.minimum[axis]) + 1e-4});
        pyramid.add({-normal, double(bounds.maximum[axis]) + 1e-4});
    }
    pyramid.bounds = bounds;
    round_planes(pyramid);
    return pyramid; // without a gate nothing can block all of it
}

} // namespace

std::optional<OcclusionPyramid> pyramid_of_patch(const LightSample& sample, std::span<const dvec3> polygon,
                                                 dvec3 normal) {
    OcclusionPyramid pyramid;
    set_apex(pyramid, sample);
    const Plane patch{normal, -glm::dot(normal, polygon[0])};
    const double height = pyramid.parallel ? -glm::dot(normal, pyramid.apex) : patch.distance(pyramid.apex);
    if (height <= 1e-9)
        return std::nullopt;
    ClippedPolygon lit;
    lit.assign(polygon);
    if (has_front(sample) && !lit.clip(front_of(sample), 1e-9))
        return std::nullopt;
    dvec3 centre;
    double radius;
    bounding_sphere(lit.span(), centre, radius);
    if (outside_cone(sample, centre, radius))
        return std::nullopt;
    pyramid.gate_count = std::min(lit.count, int(pyramid.gate.size()));
    std::copy_n(lit.points.begin(), pyramid.gate_count, pyramid.gate.begin());
    pyramid.ends_at_gate = true;
    pyramid.add(patch);
    if (has_front(sample))
        pyramid.add(front_of(sample));
    add_sides(pyramid);
    finish_bounds(pyramid);
    return pyramid;
}

namespace {

// How a box lies before the light: a rectangle around it, at the depth where it begins.
struct BoxView {
    dvec3 origin{0.0}, axis{0.0}, x{0.0}, y{0.0};
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300}, nearest = 1e300, farthest = -1e300;
    bool parallel = false;

    dvec3 at(double u, double v, double depth) const {
        const double scale = parallel ? 1.0 : depth;
        return origin + axis * depth + (x * u + y * v) * scale;
    }
};

bool may_reach(const LightSample& sample, const OrientedBox& box) {
    return !(has_front(sample) && box.reach(front_of(sample)) <= 1e-9) &&
           !outside_cone(sample, box.centre, glm::length(box.corner(7) - box.centre));
}

// Nothing where no direction separates the light from the box.
std::optional<BoxView> view_of_box(const LightSample& sample, const OrientedBox& box) {
    BoxView view;
    view.parallel = sample.kind == SampleKind::directional;
    view.origin = view.parallel ? box.centre : dvec3(sample.position);
    view.axis = view.parallel ? dvec3(sample.normal) : box.centre - dvec3(sample.position);
    const double distance = glm::length(view.axis);
    if (distance < 1e-9)
        return std::nullopt;
    view.axis /= distance;
    vec3 tangent, bitangent;
    orthonormal_basis(vec3(view.axis), tangent, bitangent);
    view.x = glm::normalize(dvec3(tangent) - view.axis * glm::dot(view.axis, dvec3(tangent)));
    view.y = glm::cross(view.axis, view.x);
    for (int i = 0; i < 8; ++i) {
        const dvec3 v = box.corner(i) - view.origin;
        const double depth = glm::dot(v, view.axis);
        view.nearest = std::min(view.nearest, depth);
        view.farthest = std::max(view.farthest, depth);
        if (!view.parallel && depth <= 1e-3 * distance)
            return std::nullopt;
        const double scale = view.parallel ? 1.0 : 1.0 / depth;
        const double place[2] = {glm::dot(v, view.x) * scale, glm::dot(v, view.y) * scale};
        for (int k = 0; k < 2; ++k) {
            view.low[k] = std::min(view.low[k], place[k]);
            view.high[k] = std::max(view.high[k], place[k]);
        }
    }
    for (int k = 0; k < 2; ++k) { // a flat box still has a gate with an area
        const double slack = 1e-9 + 1e-6 * (view.high[k] - view.low[k]);
        view.low[k] -= slack;
        view.high[k] += slack;
    }
    return view;
}

void set_gate(OcclusionPyramid& pyramid, const BoxView& view) {
    pyramid.gate = {view.at(view.low[0], view.low[1], view.nearest), view.at(view.high[0], view.low[1], view.nearest),
                    view.at(view.high[0], view.high[1], view.nearest),
                    view.at(view.low[0], view.high[1], view.nearest)};
    pyramid.gate_count = 4;
}

} // namespace

std::optional<OcclusionPyramid> pyramid_of_box(const LightSample& sample, const OrientedBox& box) {
    if (!may_reach(sample, box))
        return std::nullopt;
    const std::optional<BoxView> view = view_of_box(sample, box);
    if (!view)
        return pyramid_around(sample, box);
    std::optional<OcclusionPyramid> result(std::in_place);
    OcclusionPyramid& pyramid = *result;
    set_apex(pyramid, sample);
    set_gate(pyramid, *view);
    add_sides(pyramid);
    pyramid.add({-view->axis, glm::dot(view->axis, view->origin) + view->farthest + 2.0 * touching});
    if (has_front(sample))
        pyramid.add(front_of(sample));
    finish_bounds(pyramid);
    for (const double u : {view->low[0], view->high[0]})
        for (const double v : {view->low[1], view->high[1]})
            pyramid.bounds.add(vec3(view->at(u, v, view->farthest)));
    return result;
}

std::optional<OcclusionPyramid> gate_of_box(const LightSample& sample, const OrientedBox& box) {
    if (!may_reach(sample, box))
        return std::nullopt;
    std::optional<OcclusionPyramid> result(std::in_place);
    set_apex(*result, sample);
    if (const std::optional<BoxView> view = view_of_box(sample, box))
        set_gate(*result, *view);
    return result;
}

bool enters(const OcclusionPyramid& pyramid, std::span<const dvec3> polygon) {
    if (polygon.size() > ClippedPolygon::capacity)
        return true; // errs on the side of yes
    // Most polygons lie outside one plane, or have a corner within all; only planes that cut the rest need clipping.
    std::array<int, OcclusionPyramid::max_planes> cutting;
    int cuts = 0;
    std::uint64_t within = ~std::uint64_t(0) >> (64 - polygon.size()); // corners, by bit
    for (int i = 0; i < pyramid.plane_count; ++i) {
        const Plane& plane = pyramid.planes[std::size_t(i)];
        std::uint64_t inside = 0;
        for (std::size_t k = 0; k < polygon.size(); ++k)
            inside |= std::uint64_t(plane.distance(polygon[k]) > touching) << k;
        if (inside == 0)
            return false;
        if (inside != ~std::uint64_t(0) >> (64 - polygon.size()))
            cutting[std::size_t(cuts++)] = i;
        within &= inside;
    }
    if (within != 0)
        return true;
    ClippedPolygon parts[2];
    parts[0].assign(polygon);
    for (int i = 0; i < cuts; ++i)
        if (!parts[i & 1].clip_to(pyramid.planes[std::size_t(cutting[std::size_t(i)])], touching, parts[~i & 1]))
            return false;
    return true;
}

bool may_enter(const OcclusionPyramid& pyramid, const OrientedBox& box) {
    for (int i = 0; i < pyramid.plane_count; ++i)
        if (box.reach(pyramid.planes[std::size_t(i)]) <= touching)
            return false;
    // The box's own faces as separating planes: all of the region on one face's outer side.
    if (!pyramid.ends_at_gate || pyramid.parallel)
        return true;
    for (const dvec3& half_axis : box.half_axes) {
        const double square = glm::dot(half_axis, half_axis);
        if (square < 1e-18)
            continue;
        double low = 1e300, high = -1e300;
        const auto add = [&](dvec3 point) {
            const double place = glm::dot(point - box.centre, half_axis) / square;
            low = std::min(low, place);
            high = std::max(high, place);
        };
        add(pyramid.apex);
        for (const dvec3& point : pyramid.gate_points())
            add(point);
        const double slack = touching / std::sqrt(square);
        if (low >= 1.0 - slack || high <= -1.0 + slack)
            return false;
    }
    return true;
}

namespace {

bool may_enter_exactly(const OcclusionPyramid& pyramid, const Bounds& bounds) {
    const dvec3 centre(bounds.centre()), half(0.5f * bounds.extent());
    for (int i = 0; i < pyramid.plane_count; ++i) {
        const Plane& plane = pyramid.planes[std::size_t(i)];
        if (plane.distance(centre) + glm::dot(glm::abs(plane.normal), half) <= touching)
            return false;
    }
    return true;
}

} // namespace

bool may_enter(const OcclusionPyramid& pyramid, const Bounds& bounds) {
    for (int axis = 0; axis < 3; ++axis)
        if (bounds.minimum[axis] > pyramid.bounds.maximum[axis] || bounds.maximum[axis] < pyramid.bounds.minimum[axis])
            return false;
    // Single precision decides, but where its error might.
    constexpr float error = 1e-6f; // of sums of terms, relative to their size: more than seven roundings of 2^-24
    const vec3 centre = bounds.centre(), half = 0.5f * bounds.extent();
    const float size = std::abs(centre.x) + std::abs(centre.y) + std::abs(centre.z) + half.x + half.y + half.z;
    constexpr int lanes = OcclusionPyramid::lanes;
    bool close = false;
    for (int first = 0; first < pyramid.plane_count; first += lanes) {
        float reach[lanes], slack[lanes];
        for (int lane = 0; lane < lanes; ++lane) {
            const std::size_t i = std::size_t(first) + std::size_t(lane);
            const float x = pyramid.normals_x[i], y = pyramid.normals_y[i], z = pyramid.normals_z[i];
            reach[lane] = x * centre.x + y * centre.y + z * centre.z + pyramid.offsets[i] + std::abs(x) * half.x +
                          std::abs(y) * half.y + std::abs(z) * half.z;
            slack[lane] = float(10.0 * touching) + error * (size + std::abs(pyramid.offsets[i]));
        }
        for (int lane = 0; lane < lanes; ++lane) {
            if (reach[lane] < -slack[lane])
                return false;
            close |= reach[lane] <= slack[lane];
        }
    }
    return !close || may_enter_exactly(pyramid, bounds);
}

bool may_enter_patch(const LightSample& sample, std::span<const dvec3, 4> corners, dvec3 normal,
                     const OrientedBox& box) {
    // Greatest distance of the box inside a plane through `point`, in lengths of `direction`.
    const auto reach = [&box](dvec3 direction, dvec3 point) {
        return glm::dot(direction, box.centre - point) + std::abs(glm::dot(direction, box.half_axes[0])) +
               std::abs(glm::dot(direction, box.half_axes[1])) + std::abs(glm::dot(direction, box.half_axes[2]));
    };
    if (reach(normal, corners[0]) <= touching)
        return false;
    const dvec3 position(sample.position), axis(sample.normal);
    if (has_front(sample) && reach(axis, position) <= touching)
        return false;
    const bool parallel = sample.kind == SampleKind::directional;
    for (std::size_t i = 0; i < 4; ++i) {
        const dvec3 to_light = parallel ? -axis : position - corners[i];
        if (reach(glm::cross(to_light, corners[(i + 1) % 4] - corners[i]), corners[i]) <= 0.0)
            return false;
    }
    if (parallel)
        return true;
    for (const dvec3& half_axis : box.half_axes) { // the box's faces as separating planes
        const double square = glm::dot(half_axis, half_axis);
        double low = glm::dot(position - box.centre, half_axis), high = low;
        for (const dvec3& corner : corners) {
            const double place = glm::dot(corner - box.centre, half_axis);
            low = std::min(low, place);
            high = std::max(high, place);
        }
        if (square > 1e-18 && (low >= square || high <= -square))
            return false;
    }
    return true;
}

} // namespace sunfleck::gi
