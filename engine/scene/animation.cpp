#include "engine/scene/animation.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::scene {
namespace {

// Along the shorter arc.
vec4 blend_rotations(vec4 a, vec4 b, float t) {
    const quat from(a.w, a.x, a.y, a.z), to(b.w, b.x, b.y, b.z);
    const quat result = glm::slerp(from, to, t);
    return {result.x, result.y, result.z, result.w};
}

// Position of a time between two keys: on one of them (next == key), or a fraction `t` of an interval `length` seconds
// long.
struct Between {
    std::size_t key = 0, next = 0;
    float t = 0.0f, length = 0.0f;
};

Between find_keys(const std::vector<float>& times, float seconds) {
    const std::size_t last = times.size() - 1;
    if (seconds <= times.front())
        return {};
    if (seconds >= times.back())
        return {last, last, 0.0f, 0.0f};
    Between place;
    place.next = std::size_t(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
    place.key = place.next - 1;
    place.length = times[place.next] - times[place.key];
    place.t = place.length > 0.0f ? (seconds - times[place.key]) / place.length : 0.0f;
    return place;
}

// glTF 2.0, appendix C. `in_tangent` and `out_tangent` are per second.
template <typename T>
T cubic(const Between& place, T from, T out_tangent, T in_tangent, T to) {
    const float t = place.t, t2 = t * t, t3 = t2 * t;
    return (2.0f * t3 - 3.0f * t2 + 1.0f) * from + (t3 - 2.0f * t2 + t) * (place.length * out_tangent) +
           (3.0f * t2 - 2.0f * t3) * to + (t3 - t2) * (place.length * in_tangent);
}

} // namespace

// glTF 2.0, appendix C.
vec4 AnimationCurve::at(float seconds) const {
    if (times.empty())
        return vec4(0.0f, 0.0f, 0.0f, 1.0f);
    const bool is_cubic = interpolation == AnimationInterpolation::cubic_spline;
    const auto value = [&](std::size_t key) { return values[is_cubic ? 3 * key + 1 : key]; };
    const Between place = find_keys(times, seconds);
    if (place.key == place.next || interpolation == AnimationInterpolation::step)
        return value(place.key);
    if (!is_cubic)
        return target == AnimationTarget::rotation ? blend_rotations(value(place.key), value(place.next), place.t)
                                                   : glm::mix(value(place.key), value(place.next), place.t);
    const vec4 result =
        cubic(place, value(place.key), values[3 * place.key + 2], values[3 * place.next], value(place.next));
    return target == AnimationTarget::rotation ? glm::normalize(result) : result;
}

std::vector<float> WeightCurve::at(float seconds) const {
    std::vector<float> result(width);
    if (times.empty())
        return result;
    const bool is_cubic = interpolation == AnimationInterpolation::cubic_spline;
    const Between place = find_keys(times, seconds);
    for (std::size_t i = 0; i < width; ++i) {
        // A cubic key stores all in-tangents, then all values, then all out-tangents.
        const auto number = [&](std::size_t key, std::size_t part) {
            return values[is_cubic ? (3 * key + part) * width + i : key * width + i];
        };
        if (place.key == place.next || interpolation == AnimationInterpolation::step)
            result[i] = number(place.key, 1);
        else if (is_cubic)
            result[i] =
                cubic(place, number(place.key, 1), number(place.key, 2), number(place.next, 0), number(place.next, 1));
        else
            result[i] = glm::mix(number(place.key, 1), number(place.next, 1), place.t);
    }
    return result;
}

std::vector<float> Animation::weights_at(double seconds) const {
    if (weights.times.empty())
        return {};
    return weights.at(duration > 0.0f ? float(std::fmod(seconds, double(duration))) : 0.0f);
}

void Animation::apply(double seconds, Transform& transform) const {
    const float time = duration > 0.0f ? float(std::fmod(seconds, double(duration))) : 0.0f;
    for (const AnimationCurve& curve : curves) {
        const vec4 value = curve.at(time);
        switch (curve.target) {
        case AnimationTarget::position:
            transform.position = vec3(value);
            break;
        case AnimationTarget::rotation:
            transform.rotation = quat(value.w, value.x, value.y, value.z);
            break;
        case AnimationTarget::scale:
            transform.scale = vec3(value);
            break;
        }
    }
}

} // namespace sunfleck::scene
