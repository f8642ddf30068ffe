// Compute and graphics pipelines. Each has one descriptor set and one range of push constants, both laid out as its
// shaders declare them (see spirv_reflection.h).
#pragma once

#include "engine/gpu/device.h"
#include "engine/gpu/pipeline_cache.h"
#include "engine/gpu/shader_library.h"
#include "engine/gpu/spirv_reflection.h"

#include <memory>
#include <utility>
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

class Pipeline {
public:
    VkPipeline handle() const { return built_->handle; }
    VkPipelineLayout layout() const { return built_->layout; }
    VkDescriptorSetLayout set_layout() const { return built_->set_layout; }
    VkPipelineBindPoint bind_point() const { return bind_point_; }
    // What its shaders declare.
    const std::vector<ShaderBinding>& bindings() const { return built_->interface.bindings; }
    std::uint32_t push_constant_bytes() const { return built_->interface.push_constant_bytes; }
    VkShaderStageFlags push_stages() const { return built_->interface.push_stages; }
    // Its shaders' names, for messages.
    const std::string& name() const { return name_; }

private:
    friend class PipelineStore;
    std::shared_ptr<const BuiltPipeline> built_;
    VkPipelineBindPoint bind_point_ = VK_PIPELINE_BIND_POINT_COMPUTE;
    std::string name_;
};

// Destroyed with the object: pipelines do not need it once they are made.
struct ShaderModule {
    explicit ShaderModule(Device& owner) : device(&owner) {}
    ShaderModule(ShaderModule&& other) noexcept
        : device(other.device), handle(std::exchange(other.handle, VkShaderModule(VK_NULL_HANDLE))) {}
    ShaderModule& operator=(ShaderModule&&) = delete;
    ~ShaderModule();

    Device* device;
    VkShaderModule handle = VK_NULL_HANDLE;
};

// Pipelines of one user of the device, made if no other user has made the same before (see pipeline_cache.h). The
// pointers it returns stay valid, and change their content at refresh.
class PipelineStore {
public:
    PipelineStore(Device& device, ShaderLibrary& shaders) : device_(device), shaders_(shaders) {}
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
        ComputeDescription compute; // or
        GraphicsDescription graphics;
    };
    using Built = std::shared_ptr<const BuiltPipeline>;
    Result<PipelineKey> key_of(const Entry& entry) const;
    Result<ShaderInterface> read_interface(const Entry& entry) const;
    Status make_layout(BuiltPipeline& built);
    // As the device has it already, or made now.
    Result<Built> obtain(const Entry& entry);
    Result<Built> obtain_again(const Entry& entry);
    Result<Built> build(const Entry& entry);
    Result<VkPipeline> build_compute(const Entry& entry, VkPipelineLayout layout);
    Result<VkPipeline> build_graphics(const Entry& entry, VkPipelineLayout layout);
    Result<ShaderModule> make_module(const std::string& path);
    Result<const Pipeline*> finish(std::unique_ptr<Entry> entry);

    Device& device_;
    ShaderLibrary& shaders_;
    std::vector<std::unique_ptr<Entry>> entries_;
};

} // namespace sunfleck::gpu
