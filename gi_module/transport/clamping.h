// The bound of the geometry term cos*cos/d^2.
//
// One of N surface samples stands for an area A/N of the scene's surface A, a disc of radius r = sqrt(A / (pi N)).
// Nearer than r the point light misjudges the disc that it stands for, so the term is held below 1/r^2 = pi N / A. The
// bound grows in proportion to N: the picture converges, which it does not with a fixed bound. It has no unit of length
// of its own: scaling the scene scales it along.
//
// A sample that stands for a cluster of walks (light_sampling/sample_clusters.h) has a disc of its own, which is wide
// where little light comes from. At a distance of its radius a disc shines half as brightly along its axis as the point
// does, pi L r^2 / (d^2 + r^2): such a sample's term is held below 1 / (2 r^2), where that is less. What the bound
// removes is counted (see BruteForce) and reported as clamped_flux.
#pragma once

#include <algorithm>
#include <cstdint>

namespace sunfleck::gi {

// 1/m2. `scale` 1 is the bound above; larger clamps less. `area`: static surface of the scene, m2.
inline float geometry_bound(std::uint32_t surface_samples, float area, float scale) {
    if (area <= 0.0f)
        return 1e30f;
    return scale * 3.14159265f * float(surface_samples) / area;
}

// Of a sample whose disc has this radius, m; 0: `bound`, that of all.
inline float geometry_bound_of(float radius, float bound, float scale) {
    return radius > 0.0f ? std::min(bound, scale / (2.0f * radius * radius)) : bound;
}

} // namespace sunfleck::gi
