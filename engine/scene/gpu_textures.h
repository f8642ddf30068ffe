// The texture store on the GPU: an image with all mip levels for each texture, and samplers.
#pragma once

#include "engine/gpu/frame_resources.h"
#include "engine/gpu/submission.h"
#include "engine/scene/texture_store.h"

#include <map>

namespace sunfleck::scene {

class GpuTextures {
public:
    explicit GpuTextures(gpu::Device& device) : device_(device) {}
    ~GpuTextures();
    GpuTextures(const GpuTextures&) = delete;
    GpuTextures& operator=(const GpuTextures&) = delete;

    // Uploads textures that are new in the store. Submits and waits when there are any: loading time, not frame time.
    Status update(const TextureStore& textures, gpu::Submission& submission);

    // The texture with its sampler; white for -1 and what has not been uploaded.
    gpu::Binding binding(std::int32_t texture) const;
    std::uint64_t memory_bytes() const { return memory_bytes_; }

private:
    Result<gpu::Image> upload(const Texture& texture, gpu::Submission& submission);
    Result<VkSampler> sampler(const Texture& texture);

    gpu::Device& device_;
    std::vector<gpu::Image> images_; // the first is white
    std::vector<VkSampler> samplers_;
    std::map<std::uint32_t, VkSampler> by_mode_;
    std::uint64_t memory_bytes_ = 0;
};

} // namespace sunfleck::scene
