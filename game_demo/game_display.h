// What the game is shown on: window, device, swapchain, and the user interface over the picture.
#pragma once

#include "engine/app/gui_screen.h"
#include "game_demo/options.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace sunfleck::demo {

class GameDisplay {
public:
    static Result<std::unique_ptr<GameDisplay>> create(const std::string& title, const Options& options);

    app::Window& window() { return *window_; }
    gpu::Device& device() { return *device_; }
    app::Swapchain& swapchain() { return *swapchain_; }
    app::GuiScreen& screen() { return *screen_; }

    // The device is lost: another one, for the same window. What was made on the one before may live until the next
    // renderer begins. An error: there is no device.
    Status replace_device(const Options& options);
    // Before the first frame of a renderer, whose serials start at 1. Waits for the device. True: the device is
    // another.
    Result<bool> begin_renderer();
    // Waits until the renderer's next frame has a slot, before anybody asks for the input that it shows: what is waited
    // for afterwards makes it late.
    static Status wait_for_slot(viewer::SceneRenderer& renderer);
    // Starts the renderer's next frame: its command buffer.
    Result<VkCommandBuffer> begin_frame(viewer::SceneRenderer& renderer);
    // Draws the user interface over the picture.
    viewer::SceneRenderer::Overlay overlay();
    // Submits the recorded frame and hands its picture to the window.
    Status present(VkCommandBuffer commands, viewer::SceneRenderer& renderer);

    // Of text and widgets, by the window's height.
    static float ui_scale(const DemoSettings& settings, VkExtent2D extent) {
        return settings.ui_scale * std::clamp(float(extent.height) / 720.0f, 0.6f, 3.0f);
    }

private:
    GameDisplay() = default;
    Status make_device(const Options& options);
    std::unique_ptr<app::Window> window_;
    std::vector<std::unique_ptr<gpu::Device>> lost_; // until what lies on them is gone
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<app::Swapchain> swapchain_;
    std::unique_ptr<gpu::FrameResources> blit_resources_;
    std::unique_ptr<app::GuiScreen> screen_;
};

} // namespace sunfleck::demo
