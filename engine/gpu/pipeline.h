// Compute and graphics pipelines. Each has one descriptor set and one range of push constants, both laid out as its
// shaders declare them (see spirv_reflection.h).
#pragma once

#include "engine/gpu/device.h"
#include "engine/gpu/shader_library.h"
#include "engine/gpu/spirv_reflection.h"

#include <memory>
#include <vector>

namespace sunfleck::gpu {

// Values of the constant ids 0, 1, ..., as Vulkan takes them.
struct SpecializationValues {
    explicit SpecializationValues(const std::vector<std::uint32_t>& values);
    SpecializationValues(const SpecializationValues&) = delete;
    SpecializationValues& operator=(const SpecializationValues&) = delete;
    std::vector<VkSpecializationMapEntry> entries;
    VkSpecializationInfo info{};
};

struct ComputeDescription {
    std::string shader;                        // path in the shader library
    std::vector<std::uint32_t> specialization; // values of constant_id 0, 1, ...
    std::string name;                          // for validation messages; empty takes the shader's path
};

struct VertexAttribute {
    std::uint32_t buffer = 0; // attributes of one buffer have one stride and rate
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::uint32_t stride = 0;
    std::uint32_t offset = 0;
    bool per_instance = false;
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
};

class Pipeline {
public:
    VkPipeline handle() const { return handle_; }
    VkPipelineLayout layout() const { return layout_; }
    VkDescriptorSetLayout set_layout() const { return set_layout_; }
    VkPipelineBindPoint bind_point() const { return bind_point_; }
    // What its shaders declare.
    const std::vector<ShaderBinding>& bindings() const { return interface_.bindings; }
    std::uint32_t push_constant_bytes() const { return interface_.push_constant_bytes; }
    VkShaderStageFlags push_stages() const { return interface_.push_stages; }
    // Its shaders' names, for messages.
    const std::string& name() const { return name_; }

private:
    friend class PipelineStore;
    VkPipeline handle_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineBindPoint bind_point_ = VK_PIPELINE_BIND_POINT_COMPUTE;
    ShaderInterface interface_;
    std::string name_;
};

// Owns pipelines; the pointers it returns stay valid, and change their content at refresh.
class PipelineStore {
public:
    PipelineStore(Device& device, ShaderLibrary& shaders) : device_(device), shaders_(shaders) {}
    ~PipelineStore();
    PipelineStore(const PipelineStore&) = delete;
    PipelineStore& operator=(const PipelineStore&) = delete;

    // The same shader with the same values is made once.
    Result<const Pipeline*> compute(const ComputeDescription& description);
    Result<const Pipeline*> graphics(const GraphicsDescription& description);

    // Makes all pipelines again from the library's current code, whose bindings and push constants must be those of the
    // code before. On failure every pipeline stays as it was. The GPU must be idle.
    Status refresh();

private:
    struct Entry {
        Pipeline pipeline;
        ComputeDescription compute;
        GraphicsDescription graphics;
    };
    Result<ShaderInterface> read_interface(const Entry& entry) const;
    Status make_layout(Pipeline& pipeline);
    Result<VkPipeline> build(const Entry& entry);
    Result<VkPipeline> rebuild(const Entry& entry);
    Result<VkPipeline> build_compute(const Entry& entry);
    Result<VkPipeline> build_graphics(const Entry& entry);
    Result<VkShaderModule> make_module(const std::string& path);
    Result<const Pipeline*> finish(std::unique_ptr<Entry> entry);
    void destroy(Entry& entry);

    Device& device_;
    ShaderLibrary& shaders_;
    std::vector<std::unique_ptr<Entry>> entries_;
};

} // namespace sunfleck::gpu
