#include "engine/scene/camera_projection.h"

#include "engine/scene/camera_view.h"

namespace sunfleck::scene {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

// Rays as shaders want them: their length along the unit vector `axis` is 1.
struct Frustum {
    dvec3 eye, axis, forward, right, down;
    double distance_per_w = 1.0; // of clip space
};

bool all_finite(const dmat4& matrix) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(matrix[c][r]))
                return false;
    return true;
}

// Clip x, y and w of a point at eye + t * ray are t * (A ray): the rays are columns of A's inverse, and the eye is
// where all three vanish.
Result<Frustum> frustum_of(const dvec4& x, const dvec4& y, const dvec4& w) {
    const double size = glm::length(dvec3(x)) * glm::length(dvec3(y));
    if (!(glm::length(dvec3(w)) > 1e-9 * std::abs(w.w)) || glm::length(dvec3(w)) == 0.0)
        return Error{"the camera's projection is orthographic; a perspective one is needed"};
    const dmat3 linear = glm::transpose(dmat3(dvec3(x), dvec3(y), dvec3(w)));
    if (!(std::abs(glm::determinant(linear)) > 1e-9 * size * glm::length(dvec3(w))))
        return Error{"the camera's matrix is singular"};
    const dmat3 rays = glm::inverse(linear);
    Frustum frustum;
    frustum.eye = -(rays * dvec3(x.w, y.w, w.w));
    const dvec3 across = glm::normalize(glm::cross(rays[0], rays[1]));
    frustum.axis = glm::dot(across, rays[2]) < 0.0 ? -across : across;
    frustum.distance_per_w = glm::dot(frustum.axis, rays[2]);
    frustum.right = rays[0] / frustum.distance_per_w;
    frustum.down = rays[1] / frustum.distance_per_w;
    frustum.forward = rays[2] / frustum.distance_per_w;
    return frustum;
}

} // namespace

Result<ProjectedCamera> camera_from_matrix(const dmat4& world_to_clip, std::uint32_t width, std::uint32_t height) {
    if (!all_finite(world_to_clip))
        return Error{"the camera's matrix is not finite"};
    const dmat4 rows = glm::transpose(world_to_clip);
    SUNFLECK_ASSIGN(const Frustum frustum, frustum_of(rows[0], rows[1], rows[3]));
    // Along a ray, depth is constant + inverse / distance; the constant may depend on the ray.
    const dvec3 z(rows[2]);
    const double inverse = (glm::dot(z, frustum.eye) + rows[2].w) * frustum.distance_per_w;
    const double constant = glm::dot(z, frustum.forward) * frustum.distance_per_w;
    const glm::dvec2 slope = glm::dvec2(glm::dot(z, frustum.right), glm::dot(z, frustum.down)) * frustum.distance_per_w;
    if (!(std::abs(inverse) > 1e-12))
        return Error{"the camera's matrix gives all distances the same depth"};
    ProjectedCamera camera;
    double near_distance = camera_near;
    if (constant == 0.0 && slope == glm::dvec2(0.0) && inverse > 0.0) {
        near_distance = inverse;
    } else {
        camera.depth.background = inverse > 0.0 ? 0.0f : 1.0f;
        camera.depth.offset = float(double(camera.depth.background) - constant);
        camera.depth.scale = float(near_distance / inverse);
        camera.depth.slope = -vec2(slope);
    }
    shared::CameraRow& row = camera.row;
    const dvec4 canonical_z(0.0, 0.0, 0.0, near_distance);
    row.view_projection = mat4(glm::transpose(dmat4(rows[0] * frustum.distance_per_w, rows[1] * frustum.distance_per_w,
                                                    canonical_z, rows[3] * frustum.distance_per_w)));
    row.previous_view_projection = row.view_projection;
    row.position = vec4(vec3(frustum.eye), float(near_distance));
    row.forward = vec4(vec3(frustum.forward), float(width));
    row.right = vec4(vec3(frustum.right), float(height));
    row.down = vec4(vec3(frustum.down), 0.0f);
    row.axis = vec4(vec3(frustum.axis), 0.0f);
    return camera;
}

} // namespace sunfleck::scene
