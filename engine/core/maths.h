// GLM with this project's conventions: right-handed, Y up, clip depth 0..1, radians.
#pragma once

#define GLM_FORCE_DEPTH_ZERO_TO_ONE
#define GLM_FORCE_RADIANS
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/packing.hpp>

#include <cmath>

namespace sunfleck {

using glm::ivec2;
using glm::mat3;
using glm::mat4;
using glm::quat;
using glm::uvec2;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float pi = 3.14159265358979323846f;

// An axis-aligned box. Empty until something is added.
struct Bounds {
    vec3 minimum{1e30f};
    vec3 maximum{-1e30f};

    bool empty() const { return minimum.x > maximum.x; }
    void add(vec3 point) {
        minimum = glm::min(minimum, point);
        maximum = glm::max(maximum, point);
    }
    void add(const Bounds& other) {
        minimum = glm::min(minimum, other.minimum);
        maximum = glm::max(maximum, other.maximum);
    }
    vec3 centre() const { return 0.5f * (minimum + maximum); }
    vec3 extent() const { return empty() ? vec3(0.0f) : maximum - minimum; }
};

// The bounding box of the transformed corners of `bounds`.
inline Bounds transform_bounds(const mat4& matrix, const Bounds& bounds) {
    Bounds result;
    if (bounds.empty())
        return result;
    for (int corner = 0; corner < 8; ++corner) {
        const vec3 point(corner & 1 ? bounds.maximum.x : bounds.minimum.x,
                         corner & 2 ? bounds.maximum.y : bounds.minimum.y,
                         corner & 4 ? bounds.maximum.z : bounds.minimum.z);
        result.add(vec3(matrix * vec4(point, 1.0f)));
    }
    return result;
}

// The matrix for normals: the inverse transpose up to a positive factor. Made of cofactors, so that singular matrices
// work too; under mirroring matrices normals keep their side.
inline mat3 normal_matrix(const mat4& matrix) {
    const mat3 m(matrix);
    const mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0.0f ? -cofactors : cofactors;
}

// Two unit vectors orthogonal to the unit vector `n`, right-handed with it. T. Duff et al., "Building an Orthonormal
// Basis, Revisited", JCGT 2017.
inline void orthonormal_basis(vec3 n, vec3& tangent, vec3& bitangent) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    tangent = vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    bitangent = vec3(b, sign + n.y * n.y * a, -n.y);
}

inline bool is_finite(vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Rec. 709 luminance of a linear colour.
inline float luminance(vec3 colour) {
    return glm::dot(colour, vec3(0.2126f, 0.7152f, 0.0722f));
}

} // namespace sunfleck
