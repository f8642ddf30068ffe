// A window, its keys and its swapchain.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/submission.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;

namespace sunfleck::app {

enum class Key { escape, space, i, p, s, f };

class Window {
public:
    // Starts the window system; the error says what to do where there is no display.
    static Result<std::unique_ptr<Window>> create(const std::string& title, std::uint32_t width, std::uint32_t height);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    // Instance extensions that the device must be created with.
    std::vector<const char*> instance_extensions() const;
    // Handles pending events; calls `on_key` for each key pressed.
    void poll();
    // Sleeps until something happens, at most this long; for minimised windows.
    void wait(double seconds);
    bool should_close() const;
    void close();
    void set_title(const std::string& title);
    void toggle_full_screen();
    // Pixels; 0x0 while minimised.
    void size(std::uint32_t& width, std::uint32_t& height) const;
    GLFWwindow* handle() const { return handle_; }

    std::function<void(Key)> on_key;

private:
    Window() = default;
    GLFWwindow* handle_ = nullptr;
    int windowed_[4] = {};
};

// The window's images. Made anew when the window changes size.
class Swapchain {
public:
    static Result<std::unique_ptr<Swapchain>> create(gpu::Device& device, Window& window,
                                                     std::uint32_t frames_in_flight);
    ~Swapchain();
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    // Gets the next image. False: there is none now (minimised, or the swapchain was remade); try again next time.
    Result<bool> acquire(std::uint64_t serial);
    // Adds a pass that scales `source` (in the state that a copy reads from) onto the acquired image.
    Status record_blit(VkCommandBuffer commands, gpu::FrameResources& resources, const gpu::Image& source);
    const gpu::PresentSemaphores& semaphores() const { return current_; }
    Status present();

private:
    Swapchain(gpu::Device& device, Window& window) : device_(device), window_(window) {}
    Status rebuild();
    void destroy_chain();

    gpu::Device& device_;
    Window& window_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkSwapchainKHR chain_ = VK_NULL_HANDLE;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    VkExtent2D extent_{};
    std::vector<VkImage> images_;
    std::vector<VkSemaphore> acquired_; // by frame in flight
    std::vector<VkSemaphore> rendered_; // by image
    gpu::PresentSemaphores current_;
    std::uint32_t image_ = 0;
    bool stale_ = true;
};

} // namespace sunfleck::app
