// What the game is shown on: window, device, swapchain, and the user interface over the picture.
#pragma once

#include "engine/app/gui_screen.h"
#include "game_demo/options.h"

namespace sunfleck::demo {

class GameDisplay {
public:
    static Result<std::unique_ptr<GameDisplay>> create(const std::string& title, const Options& options);

    app::Window& window() { return *window_; }
    gpu::Device& device() { return *device_; }
    app::Swapchain& swapchain() { return *swapchain_; }
    app::GuiScreen& screen() { return *screen_; }

    // Before the first frame of a renderer, whose serials start at 1. Waits for the device.
    Status begin_renderer();
    // Starts the renderer's next frame: its command buffer. Waits until a slot is free.
    Result<VkCommandBuffer> begin_frame(viewer::SceneRenderer& renderer);
    // Draws the user interface over the picture.
    viewer::SceneRenderer::Overlay overlay();
    // Submits the recorded frame and hands its picture to the window.
    Status present(VkCommandBuffer commands, viewer::SceneRenderer& renderer);

private:
    GameDisplay() = default;
    std::unique_ptr<app::Window> window_;
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<app::Swapchain> swapchain_;
    std::unique_ptr<gpu::FrameResources> blit_resources_;
    std::unique_ptr<app::GuiScreen> screen_;
};

} // namespace sunfleck::demo
