// What the window shows while a level is loaded.
#pragma once

#include "engine/app/gui_screen.h"
#include "game_demo/level_loader.h"

namespace sunfleck::demo {

class LoadingScreen {
public:
    // Starts loading.
    LoadingScreen(gpu::Device& device, LevelSource source, const DemoSettings& settings)
        : loader_(device, std::move(source), settings) {}
    // The same for a level that moves to the device from one that is lost.
    LoadingScreen(gpu::Device& device, std::unique_ptr<Level> level, const DemoSettings& settings)
        : loader_(device, std::move(level), settings) {}

    // Takes input and draws one frame; Escape closes the window. The level once it is loaded, until then null. An
    // error: why it cannot be loaded, or drawn.
    Result<std::unique_ptr<Level>> frame(app::Window& window, app::Swapchain& swapchain, app::GuiScreen& screen,
                                         float ui_scale);
    // LevelLoader::give_back
    std::unique_ptr<Level> give_back() { return loader_.give_back(); }

private:
    LevelLoader loader_;
};

} // namespace sunfleck::demo
