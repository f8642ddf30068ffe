// While the camera stands still: a display picture at the screen's size from pictures that are smaller, or as large, of
// which each sees the scene from the same place through other points of its pixels: temporal anti-aliasing and
// enlargement in one (B. Karis, "High-quality temporal supersampling", 2014). What the frames before showed is moved to
// where its surfaces are now (the G-buffer's motion) and kept within the range of colours that the new picture has
// there, so that light which changes leaves no trail. Each pixel is a running mean of what was sampled near its middle.
// Where nothing changes at all for a round of samples, the picture becomes the mean of that, and stays as it is, to the
// bit.
//
// Frames of a camera that moves are better made each by itself (subpixel_edges.h): at the few frames a second of a CPU
// device much of what such a frame shows was hidden in the one before, and what was not is blurred by being moved again
// and again. The first frame after them goes on from what they showed.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/pipeline.h"
#include "engine/scene/camera_shared.h"

#include <memory>

namespace sunfleck::render {

class TemporalEnlargement {
public:
    static Result<std::unique_ptr<TemporalEnlargement>> create(gpu::Device& device, gpu::PipelineStore& pipelines);
    ~TemporalEnlargement();

    // Where the pixels of the next frame are sampled, in pixels from their middles: -0.5 to 0.5. One round of a
    // sequence covers a pixel evenly.
    vec2 offset() const;
    // Moves the picture of `camera`, of that many pixels, so that it is sampled there. The picture before that motion
    // is measured from is moved with it, so that what stands still has none.
    static void apply_offset(shared::CameraRow& camera, vec2 offset);

    // The next frame is the first of a round, which is sampled as the first of any.
    bool begins_round() const { return frame_ % round_length == 0; }

    struct Input {
        gpu::ResourceId picture; // storage image of 8 bits a channel, with display values
        gpu::ResourceId depth;   // of the G-buffer, of the same size
        gpu::ResourceId motion;  // the same
        bool changes = true;     // something has changed since the frame before that the picture shows
    };
    // Writes `target`, of at least that size, which holds what the frame before showed, and counts a frame.
    Status add(gpu::FrameGraph& graph, const Input& input, gpu::ResourceId target, gpu::FrameResources& resources);
    // A frame was drawn without it: the next one starts with no history.
    void forget();

private:
    explicit TemporalEnlargement(gpu::Device& device) : device_(device) {}
    Status make_images(const gpu::ImageDescription& target, gpu::FrameResources& resources);
    void add_still(gpu::FrameGraph& graph, const gpu::Pipeline& kernel, const Input& input,
                   gpu::ResourceId target) const;
    void add_moving(gpu::FrameGraph& graph, const Input& input, gpu::ResourceId target) const;

    gpu::Device& device_;
    const gpu::Pipeline* doubling_ = nullptr; // to twice the size
    const gpu::Pipeline* any_ = nullptr;      // to any other
    const gpu::Pipeline* sum_ = nullptr;      // a frame of a still picture
    const gpu::Pipeline* show_ = nullptr;     // their mean
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Image histories_[2];                         // of temporal_enlargement.comp
    static constexpr std::uint32_t round_length = 16; // of offsets, frames
    gpu::Image sums_;                                 // of a still picture
    std::uint32_t frame_ = 0, summed_ = 0;
    bool has_history_ = false;
};

} // namespace sunfleck::render
