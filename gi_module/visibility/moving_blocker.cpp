#include "gi_module/visibility/moving_blocker.h"

#include <algorithm>

namespace sunfleck::gi {

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
    radius_ = 0.5f * glm::length(bounds_.extent());
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

} // namespace sunfleck::gi
