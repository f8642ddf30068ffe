// From what hosts write in their geometry pass to the form that the module works on (transport/g_buffer.h). Passes are
// added only for what differs: depth of another convention, normals in another format.
#pragma once

#include "engine/gpu/pipeline.h"
#include "engine/scene/camera_projection.h"
#include "gi_module/g_buffer/conversion_shared.h"
#include "gi_module/transport/g_buffer.h"

#include <map>
#include <memory>

namespace sunfleck::gi {

// World-space normals: packed as the module has them, or three components, 0.5 * normal + 0.5 or as they are.
enum class NormalEncoding { packed, unsigned_values, signed_values };

struct HostGBuffer {
    gpu::ResourceId depth, normals, surface;
    gpu::ResourceId geometric_normals; // with normals that are not packed; invalid: derived from depth
    std::uint32_t width = 0, height = 0;
    NormalEncoding normal_encoding = NormalEncoding::packed;
    NormalEncoding geometric_encoding = NormalEncoding::signed_values; // of geometric_normals; never packed
    scene::DepthMapping mapping;
    float depth_step = 0.0f; // smallest difference that the depth format can tell; 0 with floating point
};

class GBufferConversion {
public:
    static Result<std::unique_ptr<GBufferConversion>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~GBufferConversion();
    GBufferConversion(const GBufferConversion&) = delete;
    GBufferConversion& operator=(const GBufferConversion&) = delete;

    // `camera` holds a CameraRow.
    Result<GBufferInput> add_passes(gpu::FrameGraph& graph, const HostGBuffer& host, const gpu::UploadSlice& camera);

private:
    GBufferConversion(gpu::Device& device, gpu::PipelineStore& pipelines) : device_(device), pipelines_(pipelines) {}
    Result<gpu::ResourceId> convert_depth(gpu::FrameGraph& graph, const HostGBuffer& host);
    Result<gpu::ResourceId> convert_normals(gpu::FrameGraph& graph, const HostGBuffer& host, gpu::ResourceId depth,
                                            const gpu::UploadSlice& camera);
    Result<const gpu::Pipeline*> pipeline(const gpu::ComputeDescription& description);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    std::map<std::pair<std::string, std::vector<std::uint32_t>>, const gpu::Pipeline*> made_; // by shader, constants
};

} // namespace sunfleck::gi
