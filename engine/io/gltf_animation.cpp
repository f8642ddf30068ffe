#include "engine/io/gltf_animation.h"

#include "engine/io/gltf_writer.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::io {
namespace {

constexpr int type_float = TINYGLTF_COMPONENT_TYPE_FLOAT;
// Rotations and weights may be normalised integers.
const std::vector<int> packed_types = {type_float, TINYGLTF_COMPONENT_TYPE_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                                       TINYGLTF_COMPONENT_TYPE_SHORT, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};

Result<std::vector<float>> read_times(const tinygltf::Model& model, int accessor) {
    SUNFLECK_ASSIGN(const FloatElements elements, read_floats(model, accessor, {{TINYGLTF_TYPE_SCALAR}, {type_float}}));
    const std::vector<float>& times = elements.values;
    for (std::size_t i = 0; i < times.size(); ++i)
        if (times[i] < 0.0f || (i > 0 && times[i] < times[i - 1]))
            return Error{"key times must increase from 0"};
    return times;
}

Result<scene::AnimationInterpolation> interpolation_of(const std::string& name) {
    if (name == "STEP")
        return scene::AnimationInterpolation::step;
    if (name == "CUBICSPLINE")
        return scene::AnimationInterpolation::cubic_spline;
    if (name.empty() || name == "LINEAR")
        return scene::AnimationInterpolation::linear;
    return Error{"interpolation '" + name + "' does not exist"};
}

Status read_values(const tinygltf::Model& model, int accessor, scene::AnimationCurve& curve) {
    const bool rotation = curve.target == scene::AnimationTarget::rotation;
    SUNFLECK_ASSIGN(const FloatElements elements,
                    read_floats(model, accessor,
                                {{rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3},
                                 rotation ? packed_types : std::vector<int>{type_float}}));
    const bool cubic = curve.interpolation == scene::AnimationInterpolation::cubic_spline;
    if (elements.count() != curve.times.size() * (cubic ? 3 : 1))
        return Error{"it does not have one value per key"};
    for (std::size_t i = 0; i < elements.count(); ++i) {
        vec4 value(0.0f);
        for (std::size_t c = 0; c < elements.width; ++c)
            value[int(c)] = elements[i][c];
        const bool is_tangent = cubic && i % 3 != 1;
        if (rotation && !is_tangent) {
            const float length = glm::length(value);
            if (length < 1e-6f)
                return Error{"a rotation is zero"};
            if (std::abs(length - 1.0f) > 1e-6f) // else it stays to the bit, however often it is saved
                value /= length;
        }
        curve.values.push_back(value);
    }
    return {};
}

Status read_weights(const tinygltf::Model& model, int accessor, scene::WeightCurve& curve) {
    SUNFLECK_ASSIGN(FloatElements elements, read_floats(model, accessor, {{TINYGLTF_TYPE_SCALAR}, packed_types}));
    const std::size_t sets =
        curve.times.size() * (curve.interpolation == scene::AnimationInterpolation::cubic_spline ? 3 : 1);
    if (elements.count() % sets != 0)
        return Error{"it does not have the same number of weights for each key"};
    curve.width = std::uint32_t(elements.count() / sets);
    curve.values = std::move(elements.values);
    return {};
}

Status read_channel(const tinygltf::Model& model, const tinygltf::AnimationChannel& channel,
                    const tinygltf::AnimationSampler& sampler, scene::Animation& animation) {
    SUNFLECK_ASSIGN(const scene::AnimationInterpolation interpolation, interpolation_of(sampler.interpolation));
    SUNFLECK_ASSIGN(std::vector<float> times, read_times(model, sampler.input));
    animation.duration = std::max(animation.duration, times.back());
    if (channel.target_path == "weights") {
        animation.weights = {interpolation, std::move(times), {}, 0};
        return read_weights(model, sampler.output, animation.weights);
    }
    scene::AnimationCurve curve;
    curve.interpolation = interpolation;
    curve.times = std::move(times);
    if (channel.target_path == "rotation")
        curve.target = scene::AnimationTarget::rotation;
    else if (channel.target_path == "scale")
        curve.target = scene::AnimationTarget::scale;
    else if (channel.target_path != "translation")
        return Error{"it moves '" + channel.target_path + "', which is not a glTF animation target"};
    SUNFLECK_TRY(read_values(model, sampler.output, curve));
    animation.curves.push_back(std::move(curve));
    return {};
}

// The file of this program says where an entity repeats later than the rest of the animation does.
void read_duration(const tinygltf::AnimationChannel& channel, float& stated) {
    if (!channel.extras.IsObject() || !channel.extras.Has(duration_key) || !channel.extras.Get(duration_key).IsNumber())
        return;
    const double seconds = channel.extras.Get(duration_key).GetNumberAsDouble();
    if (std::isfinite(seconds) && seconds < 1e6)
        stated = std::max(stated, float(seconds));
}

} // namespace

Result<std::map<int, scene::Animation>> read_animation(const tinygltf::Model& model, int index) {
    std::map<int, scene::Animation> result;
    if (!in_range(index, model.animations))
        return result;
    const tinygltf::Animation& source = model.animations[std::size_t(index)];
    float duration = 0.0f;
    std::map<int, float> stated;
    for (std::size_t i = 0; i < source.channels.size(); ++i) {
        const tinygltf::AnimationChannel& channel = source.channels[i];
        if (channel.target_node < 0 || channel.target_path == "pointer")
            continue;
        const auto failure = [&](const std::string& why) {
            return Error{"animation " + std::to_string(index) + ", channel " + std::to_string(i) + ": " + why};
        };
        if (!in_range(channel.target_node, model.nodes) || !in_range(channel.sampler, source.samplers))
            return failure("it names a node or sampler that does not exist");
        scene::Animation& animation = result[channel.target_node];
        if (const Status status =
                read_channel(model, channel, source.samplers[std::size_t(channel.sampler)], animation);
            !status)
            return failure(status.error().message);
        duration = std::max(duration, animation.duration);
        read_duration(channel, stated[channel.target_node]);
    }
    for (auto& [node, animation] : result) {
        // An own one may be shorter than what is longest, but not than the entity's curves.
        animation.duration = stated[node] > 0.0f ? std::max(stated[node], animation.duration) : duration;
        animation.name = source.name;
        animation.number = std::uint32_t(index);
    }
    return result;
}

} // namespace sunfleck::io
