// The bound that clamps the geometry term cos*cos/d^2 of surface samples (VPLs).
//
// One of N surface samples represents an area A/N of the scene's surface A, a disc of radius r = sqrt(A / (pi N)).
// Nearer than r the point light misrepresents its disc, so the term is clamped to 1/r^2 = pi N / A. The bound grows in
// proportion to N, so the picture converges, which it does not with a fixed bound. The bound has no unit of length of
// its own: it scales with the scene.
//
// The medoid of a cluster of random walks (light_sampling/sample_clusters.h) has a disc of its own, which is wide where
// little light comes from. At a distance of its radius a disc is half as bright along its axis as the point is,
// pi L r^2 / (d^2 + r^2): such a sample's term is clamped to 1 / (2 r^2), where that is less. The energy that clamping
// removes (its bias) is reported: as a share of all light for any technique (light_sampling/clamping_loss.h,
// clamped_share), and where it shows by BruteForce (clamped_flux).
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

// For a sample whose disc has this radius, m; 0: `bound`, which all other samples have.
inline float geometry_bound_of(float radius, float bound, float scale) {
    return radius > 0.0f ? std::min(bound, scale / (2.0f * radius * radius)) : bound;
}

// For a sample on an emitter that moves or varies: of N, each stands for the area A/N of the emitter, a disc of
// `radius`, however large the scene is; 0: `bound`, which all other samples have, and which is never undercut.
inline float emitter_bound_of(float radius, float bound, float scale) {
    return radius > 0.0f ? std::max(bound, scale / (2.0f * radius * radius)) : bound;
}

} // namespace sunfleck::gi
