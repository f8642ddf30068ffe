// Key frames that move an entity (glTF's node animation). Its pose is a function of the simulation step alone.
#pragma once

#include "engine/scene/components.h"

#include <string>
#include <vector>

namespace sunfleck::scene {

enum class AnimationTarget : std::uint32_t { position, rotation, scale };
enum class AnimationInterpolation : std::uint32_t { step, linear, cubic_spline };

// One property over time.
struct AnimationCurve {
    AnimationTarget target = AnimationTarget::position;
    AnimationInterpolation interpolation = AnimationInterpolation::linear;
    std::vector<float> times; // s, ascending
    // One per key: xyz, or a quaternion's xyzw; cubic_spline: three per key (in-tangent, value, out-tangent).
    std::vector<vec4> values;

    // Clamped to the first and the last key.
    vec4 at(float seconds) const;
};

// Weights of morph targets over time: `width` numbers per key; cubic_spline: three times as many.
struct WeightCurve {
    AnimationInterpolation interpolation = AnimationInterpolation::linear;
    std::vector<float> times; // s, ascending; empty: no curve
    std::vector<float> values;
    std::uint32_t width = 0;

    std::vector<float> at(float seconds) const;
};

// Curves of one entity; they repeat after `duration`, which is the same for all entities of a clip.
struct Animation {
    std::vector<AnimationCurve> curves;
    WeightCurve weights;
    float duration = 0.0f; // s
    // Of the clip in its file.
    std::string name;
    std::uint32_t number = 0;

    // Sets the animated properties; the rest of `transform` is unchanged.
    void apply(double seconds, Transform& transform) const;
    // Weights of morph targets at that time; empty if they are not animated.
    std::vector<float> weights_at(double seconds) const;
};

// What clips of the entity's file that are not played do to it. Nothing plays them: they are kept for files.
struct OtherAnimations {
    std::vector<Animation> clips;
};

} // namespace sunfleck::scene
