#include "gi_module/harmonics/spherical_harmonics.h"

#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr int bands = 5;

// sqrt((2l + 1) / (4 pi) (l - m)! / (l + m)!), times sqrt(2) where m > 0; the same for m and -m.
std::array<std::array<float, bands>, bands> normalisation() {
    std::array<std::array<float, bands>, bands> result{};
    for (int l = 0; l < bands; ++l)
        for (int m = 0; m <= l; ++m) {
            double ratio = 1.0;
            for (int k = l - m + 1; k <= l + m; ++k)
                ratio /= double(k);
            const double both = m > 0 ? 2.0 : 1.0;
            result[std::size_t(l)][std::size_t(m)] =
                float(std::sqrt(both * double(2 * l + 1) / (4.0 * double(pi)) * ratio));
        }
    return result;
}

} // namespace

Harmonics spherical_harmonics(vec3 direction) {
    static const auto norm = normalisation();
    Harmonics result{};
    float cosine = 1.0f, sine = 0.0f; // real and imaginary part of (x + iy)^m
    float start = 1.0f;               // associated Legendre function P(m, m) without its power of the sine
    for (int m = 0; m < bands; ++m) {
        float before = 0.0f, now = start;
        for (int l = m; l < bands; ++l) {
            const float value = norm[std::size_t(l)][std::size_t(m)] * now;
            const std::size_t middle = std::size_t(l) * std::size_t(l + 1); // of the band: m = 0
            result[middle + std::size_t(m)] = value * cosine;
            if (m > 0)
                result[middle - std::size_t(m)] = value * sine;
            const float next = (float(2 * l + 1) * direction.z * now - float(l + m) * before) / float(l + 1 - m);
            before = now;
            now = next;
        }
        const float turned = cosine * direction.x - sine * direction.y;
        sine = cosine * direction.y + sine * direction.x;
        cosine = turned;
        start *= float(2 * m + 1);
    }
    return result;
}

} // namespace sunfleck::gi
