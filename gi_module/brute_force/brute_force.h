// The baseline: every light sample with its shadow map at every pixel.
#pragma once

#include "engine/gpu/readback_ring.h"
#include "gi_module/brute_force/brute_force_shared.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_maps.h"
#include "gi_module/transport/g_buffer.h"
#include "gi_module/transport/light_batch.h"

namespace sunfleck::gi {

// The forms that the kernel can take (BruteForceSettings). `bench kernel` tries them; default_shape picks the best
// known one.
struct KernelShape {
    std::uint32_t pixels = 8; // an invocation: 1, 2, 4, 8 or 16
    std::uint32_t maps = shared::maps_texel_buffer;
    bool storage_lights = false;
    auto operator<=>(const KernelShape&) const = default;
};

struct BruteForceOptions {
    bool shadows = true;
    bool filter = false;
    bool count_clamped = false;
};

// What the bound of the geometry term took away, over the pixels that show a surface.
struct ClampedLight {
    double flux = 0;            // W, luminance-weighted, over the visible surface
    double mean_irradiance = 0; // W/m2, mean over pixels
    std::uint64_t serial = 0;   // frame that it belongs to; 0: none yet
};

// What the frame's dispatches read and write.
struct BruteForceFrame {
    gpu::FrameGraph& graph;
    const GBufferInput& g_buffer;
    const gpu::UploadSlice& camera; // a CameraRow
    const ShadowMaps& maps;
    gpu::ResourceId output;
};

class BruteForce {
public:
    static Result<std::unique_ptr<BruteForce>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~BruteForce();

    static KernelShape default_shape(const gpu::DeviceTraits& traits);
    void set_shape(const KernelShape& shape) { shape_ = shape; }

    // Called once a frame before add_pass; sizes the accumulation buffer (needed only where `accumulates`: the frame
    // has more than one batch) and collects finished counters.
    Status begin_frame(std::uint32_t width, std::uint32_t height, bool accumulates, std::uint64_t serial,
                       std::uint64_t completed_serial, gpu::FrameResources& resources);

    // Adds one dispatch for each batch. `first` and `last` tell where this call stands among those of the frame: sums
    // start with the first and reach `output` with the last. There is at least one batch; it may be empty.
    Status add_pass(const BruteForceFrame& frame, std::span<const LightBatch> batches, const BruteForceOptions& options,
                    bool first, bool last);

    // The frame recorded last was never submitted: it counts nothing.
    void drop_last_counts() { readback_.drop_newest(); }

    const ClampedLight& clamped() const { return clamped_; }

private:
    BruteForce(gpu::Device& device, gpu::PipelineStore& pipelines)
        : device_(device), pipelines_(pipelines),
          readback_(device, "clamped flux", VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) {}
    // What the passes of one frame share.
    // Large pictures go in bands of rows, a pass each, so that a band's sums fit one storage binding.
    void add_bands(const BruteForceFrame& frame, const gpu::Pipeline& kernel, const LightBatch& batch,
                   shared::BruteForceConstants constants);
    void collect(std::uint64_t completed_serial);
    Result<const gpu::Pipeline*> pipeline(std::uint32_t light_class, const BruteForceOptions& options,
                                          std::uint32_t map_bits);

    // Rows of a picture whose sums one storage binding can hold.
    std::uint32_t band_rows(std::uint32_t width) const;

    gpu::Device& device_;
    gpu::PipelineStore& pipelines_;
    KernelShape shape_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Buffer accumulation_, unused_texels_;
    gpu::ReadbackRing readback_;
    gpu::ReadbackRing::Slot* clamped_sums_ = nullptr; // of this frame
    std::uint64_t serial_ = 0;
    ClampedLight clamped_;
};

} // namespace sunfleck::gi
