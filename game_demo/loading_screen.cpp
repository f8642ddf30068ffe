#include "game_demo/loading_screen.h"

#include "game_demo/menu.h"

namespace sunfleck::demo {

Result<std::unique_ptr<Level>> LoadingScreen::frame(app::Window& window, app::Swapchain& swapchain,
                                                    app::GuiScreen& screen, float ui_scale) {
    const app::InputState& input = window.poll();
    if (input.hit(app::key_escape))
        window.close();
    if (loader_.finished())
        return loader_.take();
    SUNFLECK_ASSIGN(const bool visible, swapchain.acquire(screen.serial()));
    if (!visible) {
        window.wait(0.05);
        return std::unique_ptr<Level>();
    }
    const VkExtent2D extent = swapchain.extent();
    screen.gui().begin_frame(input, extent.width, extent.height, 1.0 / 30.0, ui_scale);
    Menu::loading_screen(loader_.share());
    screen.gui().end_frame();
    SUNFLECK_TRY(screen.present());
    return std::unique_ptr<Level>();
}

} // namespace sunfleck::demo
