// Draws only the GUI on a dark background, or over finished pictures: for loading screens and editors. Has its own
// submission, so that another thread may use the device meanwhile.
#pragma once

#include "engine/app/gui.h"
#include "engine/gpu/submission.h"

namespace sunfleck::app {

// A picture behind the GUI, in its transfer-source state, and where it goes, in pixels.
struct Backdrop {
    const gpu::Image* image = nullptr;
    VkRect2D place{};
    VkRect2D part{}; // of the image, pixels; empty: all of it
};

class GuiScreen {
public:
    // The device and the swapchain must outlive it.
    static Result<std::unique_ptr<GuiScreen>> create(gpu::Device& device, Swapchain& swapchain);
    // With the GUI of a screen whose device is lost.
    static Result<std::unique_ptr<GuiScreen>> create(gpu::Device& device, Swapchain& swapchain,
                                                     std::unique_ptr<Gui> gui);
    ~GuiScreen();
    // The device is lost: the GUI, for another screen. Only destroying this one makes sense then.
    std::unique_ptr<Gui> give_gui();

    // Also usable over other images of the same format.
    Gui& gui() { return *gui_; }
    // Pass this serial when acquiring the swapchain's image.
    std::uint64_t serial() const { return submission_->serial(); }
    // Renders the GUI's current frame to the swapchain's acquired image and presents it. The images are read on the
    // device's queue until wait().
    Status present(std::span<const Backdrop> behind = {});
    // Of the frames that were presented, those up to this serial are finished, and the pictures behind them free.
    Result<std::uint64_t> completed() { return submission_->completed(); }
    // Until the GPU has finished what was presented.
    Status wait();

private:
    GuiScreen(gpu::Device& device, Swapchain& swapchain) : device_(device), swapchain_(swapchain) {}
    Status make_picture();
    Status record(VkCommandBuffer commands, std::span<const Backdrop> behind);
    void add_backdrop(const Backdrop& backdrop, gpu::ResourceId target);

    gpu::Device& device_;
    Swapchain& swapchain_;
    gpu::ShaderLibrary shaders_;
    std::unique_ptr<gpu::PipelineStore> pipelines_;
    std::unique_ptr<gpu::Submission> submission_;
    std::unique_ptr<gpu::FrameResources> resources_;
    std::unique_ptr<gpu::FrameGraph> graph_;
    gpu::Image picture_;
    std::unique_ptr<Gui> gui_;
};

} // namespace sunfleck::app
