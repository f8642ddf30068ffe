// The surroundings' picture on the GPU, for what is seen where no surface is.
#pragma once

#include "engine/gpu/frame_resources.h"
#include "engine/gpu/submission.h"
#include "engine/scene/environment_map.h"

namespace sunfleck::render {

class SkyImage {
public:
    explicit SkyImage(gpu::Device& device) : device_(device) {}
    ~SkyImage();
    SkyImage(const SkyImage&) = delete;
    SkyImage& operator=(const SkyImage&) = delete;

    // Uploads the picture if it is another one than before. Submits and waits then: loading time, not frame time.
    Status update(const scene::EnvironmentImage* picture, gpu::Submission& submission);
    explicit operator bool() const { return shown_ != nullptr; }
    // A black texel without a picture.
    gpu::Binding binding() const { return gpu::Binding::sampled_image(image_.view(), sampler_); }

private:
    gpu::Device& device_;
    gpu::Image image_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    const scene::EnvironmentImage* shown_ = nullptr;
};

} // namespace sunfleck::render
