// What a shader's SPIR-V says about its resources: descriptor bindings and push constants. Pipeline layouts are made
// from this, so that bindings are stated in GLSL and where a pass binds them, and nowhere else.
#pragma once

#include "engine/gpu/vulkan.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sunfleck::gpu {

// How a shader sees a binding.
enum class BindingKind { uniform_buffer, storage_buffer, texel_buffer, storage_image, sampled_image };

const char* name_of(BindingKind kind);
VkDescriptorType descriptor_type(BindingKind kind);

struct ShaderBinding {
    std::uint32_t number = 0;
    BindingKind kind{};
    bool may_read = true, may_write = false; // `writeonly` and `readonly` in GLSL
    VkShaderStageFlags stages = 0;
    bool operator==(const ShaderBinding&) const = default;
};

struct ShaderInterface {
    std::vector<ShaderBinding> bindings; // of descriptor set 0, by ascending number
    std::uint32_t push_constant_bytes = 0;
    VkShaderStageFlags push_stages = 0;
    VkShaderStageFlags stages = 0;
    bool operator==(const ShaderInterface&) const = default;
};

// Reads a module with one entry point. `name` is for error messages. Any words at all are safe to pass.
Result<ShaderInterface> reflect(std::span<const std::uint32_t> words, const std::string& name);

// Adds the bindings of a pipeline's next stage; an error if both use one binding in different ways.
Status merge(ShaderInterface& interface, const ShaderInterface& stage, const std::string& name);

} // namespace sunfleck::gpu
