// The bound of the geometry term cos*cos/d^2.
//
// One of N surface samples stands for an area A/N of the scene's surface A, a disc of radius r = sqrt(A / (pi N)).
// Nearer than r the point light misjudges the disc that it stands for, so the term is held below 1/r^2 = pi N / A. The
// bound grows in proportion to N: the picture converges, which it does not with a fixed bound. It has no unit of length
// of its own: scaling the scene scales it along. What it removes is counted (see BruteForce) and reported as
// clamped_flux.
#pragma once

#include <cstdint>

namespace sunfleck::gi {

// 1/m2. `scale` 1 is the bound above; larger clamps less. `area`: static surface of the scene, m2.
inline float geometry_bound(std::uint32_t surface_samples, float area, float scale) {
    if (area <= 0.0f)
        return 1e30f;
    return scale * 3.14159265f * float(surface_samples) / area;
}

} // namespace sunfleck::gi
