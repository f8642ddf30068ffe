#include "game_demo/game_display.h"

#include "game_demo/level_loader.h"

namespace sunfleck::demo {

Result<std::unique_ptr<GameDisplay>> GameDisplay::create(const std::string& title, const Options& options) {
    std::unique_ptr<GameDisplay> display(new GameDisplay());
    auto window = app::Window::create(title, options.width, options.height);
    if (!window)
        return Error{window.error().message + "; or do without a window: --headless", window.error().code};
    display->window_ = std::move(*window);
    SUNFLECK_TRY(display->make_device(options));
    return display;
}

Status GameDisplay::make_device(const Options& options) {
    SUNFLECK_ASSIGN(device_, gpu::Device::create({options.device, options.validation, window_->instance_extensions()}));
    SUNFLECK_ASSIGN(swapchain_, app::Swapchain::create(*device_, *window_, LevelLoader::frames_in_flight));
    SUNFLECK_ASSIGN(screen_, app::GuiScreen::create(*device_, *swapchain_));
    return {};
}

Status GameDisplay::replace_device(const Options& options) {
    blit_resources_.reset();
    screen_.reset();
    swapchain_.reset();
    lost_.push_back(std::move(device_));
    return make_device(options);
}

Result<bool> GameDisplay::begin_renderer() {
    SUNFLECK_TRY(device_->wait_idle());
    blit_resources_ = std::make_unique<gpu::FrameResources>(*device_);
    const bool is_another = !lost_.empty();
    lost_.clear();
    return is_another;
}

Status GameDisplay::wait_for_slot(viewer::SceneRenderer& renderer) {
    const std::uint64_t serial = renderer.submission().serial();
    constexpr std::uint64_t slots = LevelLoader::frames_in_flight;
    return serial > slots ? renderer.submission().wait(serial - slots) : Status();
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
