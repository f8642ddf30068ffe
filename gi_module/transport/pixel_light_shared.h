// Pixel lights: the texels of a reflective shadow map as light sources, for shaders and C++ alike. C. Dachsbacher and
// M. Stamminger, "Splatting Indirect Illumination", I3D 2006, eq. 1 to 3, 7 and 8.
//
// A pixel light has a flux, a normal n and a lobe about a direction r: its radiant intensity is proportional to
// cos(angle to r)^exponent, and zero behind the surface that it lies on. A diffuse one has exponent 1 and r = n. The
// paper leaves out the lobe's norm; here the intensity integrates to the flux whatever exponent, tilt of the lobe and
// distance.
#ifndef SUNFLECK_GI_TRANSPORT_PIXEL_LIGHT_SHARED_H
#define SUNFLECK_GI_TRANSPORT_PIXEL_LIGHT_SHARED_H
#include "gi_module/transport/light_row_shared.h"
SHARED_BEGIN

SHARED_CONSTANT float pixel_light_pi = 3.14159265358979f;

// M. Abramowitz and I. Stegun, "Handbook of Mathematical Functions", 7.1.26; x >= 0, within 1.5e-7.
SHARED_FUNCTION float error_function(float x) {
    float t = 1.0f / (1.0f + 0.3275911f * x);
    float series =
        t * (0.254829592f + t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
    return 1.0f - series * exp(-x * x);
}

// The share of a lobe's flux that a plane through the light leaves on the lobe's side, where `cosine` is that of the
// angle between the lobe's axis and the plane's normal, 0 to 1.
//
// In the plane of both vectors the lobe is cos^n of one angle times a function of the other alone, so the share is an
// incomplete beta function: the distribution of Student's t with n + 1 degrees of freedom, t^2 = (n + 1) c^2 / (1 -
// c^2). D. Wallace's normal approximation of it (1959), corrected by its error at n = 1, where the share is (1 + c) /
// 2, is within 2e-4 for n >= 1.
SHARED_FUNCTION float lobe_share(float exponent, float cosine) {
    if (cosine >= 0.99999f)
        return 1.0f;
    float freedom = exponent + 1.0f;
    float c = max(cosine, 0.0f);
    float logarithm = -log(1.0f - c * c);
    float inner = error_function(sqrt(0.5f * freedom * logarithm) * (8.0f * freedom + 1.0f) / (8.0f * freedom + 3.0f));
    float lowest = error_function(sqrt(logarithm) * (17.0f / 19.0f));
    float weight = 4.0f / (freedom * freedom);
    return 0.5f + 0.5f * (inner + weight * (c - lowest));
}

// Radiant intensity along the lobe's axis of a flux of 1, 1/sr.
SHARED_FUNCTION float lobe_norm(float exponent, float cosine) {
    return (exponent + 1.0f) / (2.0f * pixel_light_pi * lobe_share(exponent, cosine));
}

// The exponent that a receiver at this distance sees: near the light the lobe widens, so that its peak is no spot of
// singular brightness. (Printed in the paper such that it would rise; it falls towards the light.) `reach`: distance
// below which it does, m; 0: nowhere. A lobe is never wider than a diffuse one.
SHARED_FUNCTION float widened_exponent(float exponent, float distance, float reach) {
    if (exponent <= 1.0f || distance >= reach)
        return exponent;
    return max(exponent * distance / reach, 1.0f);
}

// cos^exponent of the angle between two unit vectors. The difference of the vectors tells small angles that their
// scalar product no longer does, on which exponents of thousands depend.
SHARED_FUNCTION float power_of_cosine(vec3 a, vec3 b, float exponent) {
    vec3 difference = a - b;
    float h = 0.5f * dot(difference, difference); // 1 - cos
    if (h >= 1.0f)
        return 0.0f;
    float series = -h * (1.0f + h * (0.5f + h * (0.33333333f + h * (0.25f + h * 0.2f))));
    return exp(exponent * (h < 0.03f ? series : log(1.0f - h)));
}

// Radiant intensity of a flux of 1 towards `direction` (unit), 1/sr, at a distance. `axis`: of the lobe.
SHARED_FUNCTION float pixel_light_intensity(vec3 axis, vec3 normal, float exponent, float reach, vec3 direction,
                                            float distance) {
    if (dot(normal, direction) <= 0.0f)
        return 0.0f;
    float widened = widened_exponent(exponent, distance, reach);
    return lobe_norm(widened, dot(axis, normal)) * power_of_cosine(axis, direction, widened);
}

// What a diffuse light of intensity 1 gives a receiver, 1/m2. `along`: of the way to the receiver, along the light's
// normal, m, positive; `facing`: the same along the receiver's, towards the light; `squared`: its squared length.
//
// Eq. 1 and 2 are the case `softness` 0. A light stands for a piece of surface: near it, they give a receiver on an
// adjoining wall nothing, or far too much, where the surface gives it light as evenly as from afar. Softened by about
// the distance between lights, a grid of them does so, too: nearer than that distance, the squared error falls to a
// tenth and less of that of lights that are clamped.
SHARED_FUNCTION float softened_term(float along, float facing, float squared, float softness) {
    float soft = softness * softness;
    float inverse = 1.0f / max(squared + soft, 1e-12f);
    return sqrt(along * along + soft) * facing * inverse * inverse;
}

// Across a lobe's axis.
SHARED_FUNCTION vec3 lobe_tangent(vec3 axis) {
    return normalize(cross(axis, abs(axis.y) < 0.9f ? vec3(0.0f, 1.0f, 0.0f) : vec3(1.0f, 0.0f, 0.0f)));
}

// A narrow lobe as the beam that a piece of curved surface reflects: what crosses a plane at a distance along the axis
// is a Gaussian, whose covariance (xx, xy, yy, m2) is a polynomial of that distance: how wide the piece is, how its
// mirror directions turn from edge to edge, and how wide the lobe of each is. `way`: from the light. 1/m2: of a flux of
// 1, what crosses the plane at its end, which falls to zero nearer than the piece is wide. So lights join without gaps
// where eq. 3 draws a spot for each.
SHARED_FUNCTION float beam_density(vec3 axis, vec4 constant, vec4 linear, vec4 square, vec3 way) {
    float along = dot(axis, way);
    if (along <= 0.0f)
        return 0.0f;
    vec3 tangent = lobe_tangent(axis);
    float x = dot(tangent, way), y = dot(cross(axis, tangent), way);
    float xx = constant.x + along * (linear.x + along * square.x);
    float xy = constant.y + along * (linear.y + along * square.y);
    float yy = constant.z + along * (linear.z + along * square.z);
    float determinant = xx * yy - xy * xy;
    if (determinant <= 0.0f)
        return 0.0f;
    float exponent = (yy * x * x - 2.0f * xy * x * y + xx * y * y) / determinant;
    // The piece does not light itself.
    float outside = along * along / (along * along + 4.0f * (constant.x + constant.z));
    return outside * exp(-0.5f * exponent) / (2.0f * pixel_light_pi * sqrt(determinant));
}

// --- Bounds (appendix of the paper) ---------------------------------------------------------------------------------
// Irradiance is at most intensity / distance^2. Where that is a threshold E, in units of sqrt(I0 / E) with I0 the
// intensity on the axis, is a surface of revolution whose profile is eq. 7. An ellipsoid about the profile's widest
// place, which reaches over all its length, contains it for every exponent >= 1 (a test).

// Distance from the axis, at a place on it, 0 to 1. Eq. 7.
SHARED_FUNCTION float bound_profile(float place, float exponent) {
    return pow(place, exponent / (exponent + 2.0f)) * sqrt(max(1.0f - pow(place, 4.0f / (exponent + 2.0f)), 0.0f));
}

struct LobeBound {
    float centre; // place on the axis
    float along;  // half axis along it
    float across; // half axes across
};

// Eq. 8, whose power the paper prints as a factor.
SHARED_FUNCTION LobeBound lobe_bound(float exponent) {
    LobeBound bound;
    bound.centre = pow(exponent / (exponent + 2.0f), 0.25f * (exponent + 2.0f));
    bound.along = max(bound.centre, 1.0f - bound.centre);
    bound.across = bound_profile(bound.centre, exponent);
    return bound;
}

// A pixel light as shaders read it. `row` is the light sample with the same place, normal and map: its intensity is
// that on the lobe's axis, seen from afar.
struct PixelLightRow {
    LightRow row;
    vec4 lobe;   // 80: xyz: axis; w: exponent
    vec4 extent; // 96: x: of a lobe its widening reach, of a diffuse light its softness, m; y, z, w: of the
                 //     bound, m: centre on the axis, half axes along and across; centre < 0: unbounded
    vec4 beam0;  // 112: xyz: beam_density's constant; w: 1 / lobe_norm, 0: no beam
    vec4 beam1;  // 128: xyz: linear; w: 1 / lobe_norm
    vec4 beam2;  // 144: square
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::PixelLightRow) == 160);
#endif
#endif
