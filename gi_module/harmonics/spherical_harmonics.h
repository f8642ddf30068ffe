// Real spherical harmonics up to order 5: 25 functions, as the thesis uses (sec. 4.4.1).
#pragma once

#include "engine/core/maths.h"

#include <array>

namespace sunfleck::gi {

inline constexpr std::size_t harmonics = 25;
// Rows of coefficients are padded with zeros, so that sums over them run in whole vectors.
inline constexpr std::size_t harmonics_padded = 28;
using Harmonics = std::array<float, harmonics_padded>;

// Orthonormal over the sphere; function l, m is at l * l + l + m. `direction`: unit.
Harmonics spherical_harmonics(vec3 direction);

} // namespace sunfleck::gi
