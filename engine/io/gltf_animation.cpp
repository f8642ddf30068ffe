#include "engine/io/gltf_animation.h"

#include <cmath>
#include <cstring>

namespace sunfleck::io {
namespace {

// glTF 2.0, 3.11: normalised integers stand for -1 to 1.
float component(const unsigned char* address, int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return std::max(float(static_cast<std::int8_t>(address[0])) / 127.0f, -1.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return float(address[0]) / 255.0f;
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
        std::int16_t value;
        std::memcpy(&value, address, sizeof value);
        return std::max(float(value) / 32767.0f, -1.0f);
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
        std::uint16_t value;
        std::memcpy(&value, address, sizeof value);
        return float(value) / 65535.0f;
    }
    default: {
        float value;
        std::memcpy(&value, address, sizeof value);
        return value;
    }
    }
}

Status read_times(const tinygltf::Model& model, int accessor, scene::AnimationCurve& curve) {
    SUNFLECK_TRY(each_element(model, accessor, TINYGLTF_TYPE_SCALAR, {TINYGLTF_COMPONENT_TYPE_FLOAT},
                              [&](std::size_t, const unsigned char* address, int) {
                                  float time;
                                  std::memcpy(&time, address, sizeof time);
                                  curve.times.push_back(time);
                              }));
    for (std::size_t i = 0; i < curve.times.size(); ++i)
        if (!std::isfinite(curve.times[i]) || curve.times[i] < 0.0f || (i > 0 && curve.times[i] < curve.times[i - 1]))
            return Error{"key times must be finite and rise"};
    if (curve.times.empty())
        return Error{"a curve has no keys"};
    return {};
}

Status read_values(const tinygltf::Model& model, int accessor, scene::AnimationCurve& curve) {
    const bool rotation = curve.target == scene::AnimationTarget::rotation;
    std::vector<int> types = {TINYGLTF_COMPONENT_TYPE_FLOAT};
    if (rotation)
        types = {TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                 TINYGLTF_COMPONENT_TYPE_SHORT, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};
    SUNFLECK_TRY(each_element(model, accessor, rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3, types,
                              [&](std::size_t, const unsigned char* address, int type) {
                                  const int size = tinygltf::GetComponentSizeInBytes(std::uint32_t(type));
                                  vec4 value(0.0f);
                                  for (int c = 0; c < (rotation ? 4 : 3); ++c)
                                      value[c] = component(address + c * size, type);
                                  curve.values.push_back(value);
                              }));
    const bool cubic = curve.interpolation == scene::AnimationInterpolation::cubic_spline;
    if (curve.values.size() != curve.times.size() * (cubic ? 3 : 1))
        return Error{"a curve has not one value for each key"};
    for (std::size_t i = 0; i < curve.values.size(); ++i) {
        vec4& value = curve.values[i];
        if (!is_finite(vec3(value)) || !std::isfinite(value.w))
            return Error{"a key is not finite"};
        const bool is_tangent = cubic && i % 3 != 1;
        if (!rotation || is_tangent)
            continue;
        const float length = glm::length(value);
        if (length < 1e-6f)
            return Error{"a rotation is zero"};
        value /= length;
    }
    return {};
}

} // namespace

Result<std::map<int, scene::Animation>> read_animations(const tinygltf::Model& model) {
    std::map<int, scene::Animation> result;
    if (model.animations.empty())
        return result;
    const tinygltf::Animation& source = model.animations.front();
    float duration = 0.0f;
    for (const tinygltf::AnimationChannel& channel : source.channels) {
        if (channel.target_node < 0 || channel.target_path == "weights")
            continue;
        scene::AnimationCurve curve;
        if (channel.target_path == "rotation")
            curve.target = scene::AnimationTarget::rotation;
        else if (channel.target_path == "scale")
            curve.target = scene::AnimationTarget::scale;
        else if (channel.target_path != "translation")
            return Error{"animation '" + source.name + "' moves '" + channel.target_path +
                         "', which glTF does not know"};
        if (!in_range(channel.target_node, model.nodes) || !in_range(channel.sampler, source.samplers))
            return Error{"animation '" + source.name + "' names a node or sampler that does not exist"};
        const tinygltf::AnimationSampler& sampler = source.samplers[std::size_t(channel.sampler)];
        if (sampler.interpolation == "STEP")
            curve.interpolation = scene::AnimationInterpolation::step;
        else if (sampler.interpolation == "CUBICSPLINE")
            curve.interpolation = scene::AnimationInterpolation::cubic_spline;
        Status status = read_times(model, sampler.input, curve);
        if (status)
            status = read_values(model, sampler.output, curve);
        if (!status)
            return Error{"animation '" + source.name + "': " + status.error().message};
        duration = std::max(duration, curve.times.back());
        result[channel.target_node].curves.push_back(std::move(curve));
    }
    for (auto& [node, animation] : result)
        animation.duration = duration;
    return result;
}

} // namespace sunfleck::io
