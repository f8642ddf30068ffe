// Pipelines of one device, by what they are made of: whoever asks for the same gets the same. A level that is loaded,
// or a second renderer, then waits for no driver: on a CPU device the lighting's pipelines take half a second.
#pragma once

#include "engine/gpu/device.h"
#include "engine/gpu/spirv_reflection.h"

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sunfleck::gpu {

// A pipeline with its layouts; they go when the last owner goes.
struct BuiltPipeline {
    explicit BuiltPipeline(Device& owner) : device(owner) {}
    ~BuiltPipeline();
    BuiltPipeline(const BuiltPipeline&) = delete;
    BuiltPipeline& operator=(const BuiltPipeline&) = delete;

    Device& device;
    VkPipeline handle = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
    ShaderInterface interface;
};

struct ComputeDescription {
    std::string shader;                        // path in the shader library
    std::vector<std::uint32_t> specialization; // values of constant_id 0, 1, ...
    std::string name;                          // for validation messages; empty takes the shader's path
    bool operator==(const ComputeDescription&) const = default;
};

struct VertexAttribute {
    std::uint32_t buffer = 0; // attributes of one buffer have one stride and rate
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::uint32_t stride = 0;
    std::uint32_t offset = 0;
    bool per_instance = false;
    bool operator==(const VertexAttribute&) const = default;
};

struct GraphicsDescription {
    std::string vertex_shader;
    std::string fragment_shader; // empty: depth only
    std::vector<std::uint32_t> specialization;
    std::vector<VertexAttribute> attributes;
    std::vector<VkFormat> colour_formats;
    VkFormat depth_format = VK_FORMAT_UNDEFINED;
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkCullModeFlags cull = VK_CULL_MODE_NONE;
    bool dynamic_cull = false;                         // vkCmdSetCullMode and vkCmdSetFrontFace say, in place of `cull`
    VkCompareOp depth_compare = VK_COMPARE_OP_GREATER; // reverse Z
    bool depth_write = true;
    bool depth_clamp = false;
    bool blend = false; // colours over what is there, by their alpha
    bool colour_write = true;
    std::uint32_t samples = 1; // of a pixel of the attachments (ImageDescription::samples)
    bool operator==(const GraphicsDescription&) const = default;
};

// What a pipeline is made of.
struct PipelineKey {
    // Code by its length and a hash of 64 bits: the path in the description tells apart all but versions of one shader.
    void add_code(std::span<const std::uint32_t> words);

    ComputeDescription compute; // or
    GraphicsDescription graphics;
    std::vector<std::uint64_t> code;
    bool operator==(const PipelineKey&) const = default;
};

// Any thread may call it.
class PipelineCache {
public:
    // Null if there is none.
    std::shared_ptr<const BuiltPipeline> find(const PipelineKey& key) const;
    // Keeps the pipeline until the device goes, and returns it; if another thread was first, that thread's.
    std::shared_ptr<const BuiltPipeline> keep(const PipelineKey& key, std::shared_ptr<const BuiltPipeline> pipeline);
    // Lets go of those that nobody else holds. The GPU must not be using them.
    void drop_unused();
    std::size_t size() const;

private:
    mutable std::mutex mutex_;
    std::vector<std::pair<PipelineKey, std::shared_ptr<const BuiltPipeline>>> pipelines_; // some dozens
};

} // namespace sunfleck::gpu
