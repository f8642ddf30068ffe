// A window's picture with nothing but the GUI on a dark ground: what is shown while a level loads. It has a submission
// of its own, so that another thread may use the device meanwhile.
#pragma once

#include "engine/app/gui.h"
#include "engine/gpu/submission.h"

namespace sunfleck::app {

class GuiScreen {
public:
    // The device and the swapchain must outlive it.
    static Result<std::unique_ptr<GuiScreen>> create(gpu::Device& device, Swapchain& swapchain);
    ~GuiScreen();

    // Draws on anything of this screen's format, in other pictures too.
    Gui& gui() { return *gui_; }
    // The serial to acquire the swapchain's image with.
    std::uint64_t serial() const { return submission_->serial(); }
    // Shows what was drawn between the GUI's begin_frame and end_frame on the swapchain's acquired image.
    Status present();

private:
    GuiScreen(gpu::Device& device, Swapchain& swapchain) : device_(device), swapchain_(swapchain) {}
    Status make_picture();
    Status record(VkCommandBuffer commands);

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
