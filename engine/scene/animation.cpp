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

} // namespace

// glTF 2.0, appendix C.
vec4 AnimationCurve::at(float seconds) const {
    const std::size_t keys = times.size();
    const bool cubic = interpolation == AnimationInterpolation::cubic_spline;
    const auto value = [&](std::size_t key) { return values[cubic ? 3 * key + 1 : key]; };
    if (keys == 0)
        return vec4(0.0f, 0.0f, 0.0f, 1.0f);
    if (keys == 1 || seconds <= times.front())
        return value(0);
    if (seconds >= times.back())
        return value(keys - 1);
    const std::size_t next = std::size_t(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
    const std::size_t key = next - 1;
    const float length = times[next] - times[key];
    const float t = length > 0.0f ? (seconds - times[key]) / length : 0.0f;
    if (interpolation == AnimationInterpolation::step)
        return value(key);
    if (!cubic)
        return target == AnimationTarget::rotation ? blend_rotations(value(key), value(next), t)
                                                   : glm::mix(value(key), value(next), t);
    const vec4 out_tangent = length * values[3 * key + 2], in_tangent = length * values[3 * next];
    const float t2 = t * t, t3 = t2 * t;
    const vec4 result = (2.0f * t3 - 3.0f * t2 + 1.0f) * value(key) + (t3 - 2.0f * t2 + t) * out_tangent +
                        (3.0f * t2 - 2.0f * t3) * value(next) + (t3 - t2) * in_tangent;
    return target == AnimationTarget::rotation ? glm::normalize(result) : result;
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
