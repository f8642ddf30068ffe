// The GGX distribution of microfacets, isotropic, in the local frame of the normal (z up). `alpha`: its width.
#pragma once

#include "engine/core/maths.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {

// B. Walter et al., "Microfacet Models for Refraction", 2007, eq. 33; of the half vector, whose x and y say how far it
// is from the normal where 1 - z no longer does.
inline float ggx_distribution(vec3 half, float alpha) {
    const float a2 = alpha * alpha, t = a2 * half.z * half.z + half.x * half.x + half.y * half.y;
    return a2 / (pi * t * t);
}

// Smith's Lambda (E. Heitz, "Understanding the Masking-Shadowing Function", JCGT 2014, eq. 72).
inline float ggx_lambda(vec3 v, float alpha) {
    const float cos2 = v.z * v.z;
    if (cos2 <= 0.0f)
        return 1e10f;
    return 0.5f * (std::sqrt(1.0f + alpha * alpha * (1.0f - cos2) / cos2) - 1.0f);
}

// E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 2018. u, v in [0, 1).
inline vec3 ggx_visible_normal(vec3 view, float alpha, float u, float v) {
    const vec3 stretched = glm::normalize(vec3(alpha * view.x, alpha * view.y, view.z));
    const float across = stretched.x * stretched.x + stretched.y * stretched.y;
    const vec3 t1 = across > 0.0f ? vec3(-stretched.y, stretched.x, 0.0f) / std::sqrt(across) : vec3(1.0f, 0.0f, 0.0f);
    const vec3 t2 = glm::cross(stretched, t1);
    const float r = std::sqrt(u), angle = 2.0f * pi * v;
    const float p1 = r * std::cos(angle);
    const float s = 0.5f * (1.0f + stretched.z);
    const float p2 = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - p1 * p1)) + s * r * std::sin(angle);
    const vec3 n = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0f, 1.0f - p1 * p1 - p2 * p2)) * stretched;
    return glm::normalize(vec3(alpha * n.x, alpha * n.y, std::max(1e-6f, n.z)));
}

} // namespace sunfleck::gi
