// What the editor is shown on: window, device, swapchain, and the screen that draws the GUI.
#pragma once

#include "editor/window/comparison.h"
#include "editor/window/editor.h"
#include "engine/app/gui_screen.h"

#include <deque>

namespace sunfleck::editor {

class Display {
public:
    static Result<std::unique_ptr<Display>> create(const Options& options);

    app::Window& window() { return *window_; }
    gpu::Device& device() { return *device_; }
    app::Gui& gui() { return screen_->gui(); }
    VkExtent2D extent() const { return swapchain_->extent(); }

    // The device is lost, and nothing else lies on it any more: another one for the same window. The GUI goes on where
    // it was, with open menus and what is being typed. An error: there is no device.
    Status replace_device(const Options& options);
    // The next image of the window. False: there is none at the moment.
    Result<bool> acquire() { return swapchain_->acquire(screen_->serial()); }
    // The GUI's frame over the scene, or over what it is compared with.
    Status present(Comparison& comparison, const std::shared_ptr<ScenePicture>& picture, VkRect2D place);
    // Lets go of the pictures that it shows, once the GPU has finished; of a device that is lost, at once.
    Status finish(bool wait);
    // Of all its devices so far.
    int validation_messages() const { return earlier_messages_ + (device_ ? device_->validation_messages() : 0); }

private:
    Display() = default;
    Status make_device(const Options& options);
    Status make_screen(std::unique_ptr<app::Gui> gui);

    std::unique_ptr<app::Window> window_;
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<app::Swapchain> swapchain_;
    std::unique_ptr<app::GuiScreen> screen_;
    int earlier_messages_ = 0; // of devices that were lost
    // By the GUI's serial.
    std::deque<std::pair<std::uint64_t, std::vector<std::shared_ptr<ScenePicture>>>> on_screen_;
};

} // namespace sunfleck::editor
