// Real spherical harmonics of 5 bands: 25 functions, as in the thesis (sec. 4.4.1).
#pragma once

#include "engine/core/maths.h"

#include <array>

namespace sunfleck::gi {

inline constexpr std::size_t harmonics = 25;
// Coefficients are padded with zeros, so that sums over them use whole SIMD vectors.
inline constexpr std::size_t harmonics_padded = 28;
using Harmonics = std::array<float, harmonics_padded>;

// Orthonormal over the sphere; the function of band l and order m is at l * l + l + m. `direction`: unit length.
Harmonics spherical_harmonics(vec3 direction);

} // namespace sunfleck::gi
