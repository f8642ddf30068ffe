#include "game_demo/game_display.h"

namespace sunfleck::demo {

Result<std::unique_ptr<GameDisplay>> GameDisplay::create(const std::string& title, const Options& options) {
    std::unique_ptr<GameDisplay> display(new GameDisplay());
    SUNFLECK_ASSIGN(display->window_, app::Window::create(title, options.width, options.height));
    SUNFLECK_ASSIGN(display->device_,
                    gpu::Device::create({options.device, options.validation, display->window_->instance_extensions()}));
    SUNFLECK_ASSIGN(display->swapchain_, app::Swapchain::create(*display->device_, *display->window_, 2));
    SUNFLECK_ASSIGN(display->screen_, app::GuiScreen::create(*display->device_, *display->swapchain_));
    return display;
}

Status GameDisplay::begin_renderer() {
    SUNFLECK_TRY(device_->wait_idle());
    blit_resources_ = std::make_unique<gpu::FrameResources>(*device_);
    return {};
}

Result<VkCommandBuffer> GameDisplay::begin_frame(viewer::SceneRenderer& renderer) {
    SUNFLECK_ASSIGN(const VkCommandBuffer commands, renderer.submission().begin());
    SUNFLECK_ASSIGN(const std::uint64_t completed, renderer.submission().completed());
    blit_resources_->begin_frame(renderer.submission().serial(), completed);
    return commands;
}

viewer::SceneRenderer::Overlay GameDisplay::overlay() {
    return [this](gpu::FrameGraph& graph, gpu::ResourceId target, gpu::FrameResources& resources) {
        return screen_->gui().add_pass(graph, target, resources);
    };
}

Status GameDisplay::present(VkCommandBuffer commands, viewer::SceneRenderer& renderer) {
    SUNFLECK_TRY(swapchain_->record_blit(commands, *blit_resources_, renderer.output()));
    SUNFLECK_TRY(renderer.submission().submit(&swapchain_->semaphores()));
    return swapchain_->present();
}

} // namespace sunfleck::demo
