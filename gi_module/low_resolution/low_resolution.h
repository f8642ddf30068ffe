// Light at low resolution, for any technique that lights pixels one by one (thesis sec. 4.3.3): it is summed for a
// subset of the pixels, blended over the rest where surfaces allow it, and summed again at full resolution where they
// do not (repair). Techniques contribute to the sums; where the pixels are, and what becomes of the sums, is decided
// here.
//
// A frame: a stage for the low-resolution pixels, reconstruction, compaction of the pixels that it marked, and a stage
// for these. At scale 1 there is one stage, for every pixel. In each stage all contributors are called in turn.
#pragma once

#include "engine/gpu/compute_pass.h"
#include "engine/gpu/readback_ring.h"
#include "gi_module/low_resolution/low_resolution_settings.h"
#include "gi_module/low_resolution/low_resolution_shared.h"
#include "gi_module/transport/g_buffer.h"
#include "gi_module/transport/report.h"

#include <functional>
#include <memory>
#include <span>

namespace sunfleck::gi {

class LowResolution;

// What a contributor lights in a stage: the pixels of groups (low_resolution_shared.h).
struct PixelStage {
    LowResolution& low_resolution;
    gpu::FrameGraph& graph;
    const GBufferInput& g_buffer;
    const gpu::UploadSlice& camera; // a CameraRow
    shared::LowResolutionConstants constants;
    bool repair = false; // the pixels are listed on the GPU, and so is their number
    bool first = true;   // nobody listed or summed anything yet: list the pixels (or call list_pixels), write the sums
    bool last = true;    // nobody adds anything after this
    bool resolves =
        false; // the sums are the light of their pixels: the last contributor writes `output` (or calls resolve)
    const gpu::Buffer& pixels;     // uint an entry
    const gpu::Buffer& sums;       // vec4 an entry: W/m2; alpha 0 where there is nothing to light
    const gpu::Buffer& commands;   // indirect dispatches over the groups, if repair
    const gpu::Buffer& cell_masks; // of the pixels that are repaired; complete in the repair stage
    gpu::ResourceId output;

    // The end of a pass over the stage's groups: with a work group for each (command_groups), or one for eight of them
    // (command_packed).
    void dispatch(gpu::ComputePass& pass, std::uint32_t command) const;
};
using PixelLighting = std::function<Status(const PixelStage& stage)>;

struct LowResolutionFrame {
    const GBufferInput& g_buffer;
    const gpu::UploadSlice& camera; // a CameraRow, the camera of the G-buffer
    gpu::ResourceId output;         // every pixel is written
    std::uint64_t serial = 0, completed_serial = 0;
    // Of contributors' own memory for a group; bounds how many groups can be repaired.
    std::uint64_t bytes_per_group = 4;
    bool every_pixel = false; // scale 1, whatever the settings say
};

class LowResolution {
public:
    static Result<std::unique_ptr<LowResolution>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~LowResolution();

    Status add_passes(gpu::FrameGraph& graph, const LowResolutionSettings& settings, const LowResolutionFrame& frame,
                      std::span<const PixelLighting> contributors, gpu::FrameResources& resources);

    // For contributors without a kernel of their own for it: lists the stage's pixels and clears their sums; writes the
    // sums to the output.
    Status list_pixels(const PixelStage& stage);
    Status resolve(const PixelStage& stage);

    // The frame recorded last was never submitted: it counts nothing.
    void drop_last_counts() { readback_.drop_newest(); }

    static std::span<const Counter> counters();
    void report(Report& report) const;

private:
    LowResolution(gpu::Device& device, gpu::PipelineStore& pipelines)
        : device_(device), pipelines_(pipelines),
          readback_(device, "repair counters", VK_BUFFER_USAGE_TRANSFER_DST_BIT) {}
    Status make_buffers(const shared::LowResolutionConstants& constants, gpu::FrameResources& resources);
    Status make_buffer(gpu::Buffer& buffer, const char* name, std::uint64_t bytes, VkBufferUsageFlags usage,
                       gpu::FrameResources& resources, VkFormat texel_format = VK_FORMAT_UNDEFINED);
    Result<const gpu::Pipeline*> pipeline(const char* shader, std::vector<std::uint32_t> specialization);
    Status light_stage(PixelStage stage, std::span<const PixelLighting> contributors);
    Status add_reconstruction(const PixelStage& stage, bool through_buffer, bool repairs_contacts);
    Status add_compaction(const PixelStage& stage);
    Status add_counters(const PixelStage& stage, const LowResolutionFrame& frame);

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer pixels_, sums_, cell_masks_, block_entries_, commands_, picture_;
    gpu::ReadbackRing readback_; // tag: pixels of the low-resolution picture
    std::uint64_t low_pixels_ = 0, repaired_ = 0, not_repaired_ = 0;
};

} // namespace sunfleck::gi
