#include "editor/window/display.h"

#include "editor/window/style.h"

namespace sunfleck::editor {

Result<std::unique_ptr<Display>> Display::create(const Options& options) {
    std::unique_ptr<Display> display(new Display());
    SUNFLECK_ASSIGN(display->window_, app::Window::create("Sunfleck", options.width, options.height));
    display->window_->one_by_one(true);
    SUNFLECK_TRY(display->make_device(options));
    SUNFLECK_TRY(display->make_screen(nullptr));
    display->gui().use_window(*display->window_);
    display->gui().set_style(set_style);
    ImGui::GetIO().ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard; // keys are commands here
    return display;
}

Status Display::make_device(const Options& options) {
    SUNFLECK_ASSIGN(device_, gpu::Device::create({options.device, options.validation, window_->instance_extensions()}));
    SUNFLECK_ASSIGN(swapchain_, app::Swapchain::create(*device_, *window_, 2));
    swapchain_->set_vertical_sync(true);
    return {};
}

Status Display::make_screen(std::unique_ptr<app::Gui> gui) {
    SUNFLECK_ASSIGN(screen_, app::GuiScreen::create(*device_, *swapchain_, std::move(gui)));
    return {};
}

Status Display::replace_device(const Options& options) {
    earlier_messages_ = validation_messages();
    on_screen_.clear();
    std::unique_ptr<app::Gui> gui = screen_->give_gui();
    screen_.reset();
    swapchain_.reset();
    device_.reset();
    SUNFLECK_TRY(make_device(options));
    return make_screen(std::move(gui));
}

Status Display::finish(bool wait) {
    const Status finished = wait ? device_->wait_idle() : Status();
    on_screen_.clear();
    return finished;
}

Status Display::present(Comparison& comparison, const std::shared_ptr<ScenePicture>& picture, VkRect2D place) {
    SUNFLECK_ASSIGN(const std::uint64_t completed, screen_->completed());
    while (!on_screen_.empty() && on_screen_.front().first <= completed)
        on_screen_.pop_front();
    std::vector<std::shared_ptr<ScenePicture>> held;
    const std::vector<app::Backdrop> backdrops = comparison.backdrops(picture, place, held);
    on_screen_.emplace_back(screen_->serial(), std::move(held));
    return screen_->present(backdrops);
}

} // namespace sunfleck::editor
