// A pass with one dispatch. Each call names a resource once, in the order of the shader's binding numbers; it declares
// the access to the frame graph and says what is bound:
//
//     ComputePass(graph, "reconstruction", kernel)
//         .uniform(camera)
//         .sampled(depth, sampler)
//         .storage_write(output)
//         .push(constants)
//         .dispatch(columns, rows);
//
// When the pass is recorded, this is compared with what the shader declares: number, kinds, `readonly`, `writeonly`.
#pragma once

#include "engine/gpu/frame_graph.h"

#include <span>
#include <string>
#include <vector>

namespace sunfleck::gpu {

class ComputePass {
public:
    ComputePass(FrameGraph& graph, const std::string& name, const Pipeline& kernel);

    // Upload memory is written before the frame starts, so the graph need not know of it.
    ComputePass& uniform(const UploadSlice& slice);
    ComputePass& storage_read(const UploadSlice& slice);

    ComputePass& sampled(ResourceId image, VkSampler sampler);
    ComputePass& texels(const Buffer& buffer);
    ComputePass& storage_read(const BufferRange& range);
    ComputePass& storage_write(const BufferRange& range); // all or part is written, nothing read
    ComputePass& storage_read_write(const BufferRange& range);
    ComputePass& storage_read(ResourceId image);
    ComputePass& storage_write(ResourceId image);
    ComputePass& storage_read_write(ResourceId image);

    // For what the graph need not order: content that no pass ever writes, and bindings that the kernel, specialised as
    // it is, does not access. (Some drivers want every binding of a set to be filled.)
    ComputePass& constant(const Binding& binding);
    ComputePass& unused(const BufferRange& range) { return constant(Binding::storage(range)); }

    template <typename T>
    ComputePass& push(const T& constants) {
        const auto bytes = std::as_bytes(std::span<const T>(&constants, 1));
        constants_.assign(bytes.begin(), bytes.end());
        return *this;
    }

    // The last call: hands the pass to the graph.
    void dispatch(std::uint32_t x, std::uint32_t y = 1, std::uint32_t z = 1);
    void dispatch_indirect(const Buffer& commands, VkDeviceSize offset);

private:
    enum class Access { none, read, write, read_write };
    struct Resource {
        Binding binding;
        ResourceId image; // valid: the view is known when the pass is recorded
        Access access = Access::none;
    };
    struct Recording;

    ComputePass& add_range(const BufferRange& range, Usage usage, Access access);
    ComputePass& add_image(Binding binding, ResourceId image, Usage usage, Access access);
    void finish(Recording recording);

    FrameGraph& graph_;
    FrameGraph::PassBuilder pass_;
    const Pipeline& kernel_;
    std::vector<Resource> resources_;
    std::vector<std::byte> constants_;
};

} // namespace sunfleck::gpu
