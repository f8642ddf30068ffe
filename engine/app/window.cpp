#include "engine/app/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace sunfleck::app {
namespace {

void forward_key(GLFWwindow* handle, int key, int, int action, int) {
    auto* window = static_cast<Window*>(glfwGetWindowUserPointer(handle));
    if (action != GLFW_PRESS || !window->on_key)
        return;
    switch (key) {
    case GLFW_KEY_ESCAPE:
        window->on_key(Key::escape);
        break;
    case GLFW_KEY_SPACE:
        window->on_key(Key::space);
        break;
    case GLFW_KEY_I:
        window->on_key(Key::i);
        break;
    case GLFW_KEY_P:
        window->on_key(Key::p);
        break;
    case GLFW_KEY_S:
        window->on_key(Key::s);
        break;
    case GLFW_KEY_F:
        window->on_key(Key::f);
        break;
    default:
        break;
    }
}

} // namespace

Result<std::unique_ptr<Window>> Window::create(const std::string& title, std::uint32_t width, std::uint32_t height) {
    if (!glfwInit())
        return Error{"no window system was found (is DISPLAY set?); run with --headless, or under xvfb-run"};
    std::unique_ptr<Window> window(new Window());
    if (!glfwVulkanSupported())
        return Error{"the window system cannot show Vulkan pictures; run with --headless"};
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window->handle_ = glfwCreateWindow(int(width), int(height), title.c_str(), nullptr, nullptr);
    if (window->handle_ == nullptr)
        return Error{"a window could not be opened; run with --headless"};
    glfwSetWindowUserPointer(window->handle_, window.get());
    glfwSetKeyCallback(window->handle_, forward_key);
    return window;
}

Window::~Window() {
    if (handle_ != nullptr)
        glfwDestroyWindow(handle_);
    glfwTerminate();
}

std::vector<const char*> Window::instance_extensions() const {
    std::uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    return {names, names + count};
}

void Window::poll() {
    glfwPollEvents();
}
void Window::wait(double seconds) {
    glfwWaitEventsTimeout(seconds);
}
bool Window::should_close() const {
    return glfwWindowShouldClose(handle_);
}
void Window::close() {
    glfwSetWindowShouldClose(handle_, GLFW_TRUE);
}
void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(handle_, title.c_str());
}

void Window::toggle_full_screen() {
    if (glfwGetWindowMonitor(handle_) != nullptr) {
        glfwSetWindowMonitor(handle_, nullptr, windowed_[0], windowed_[1], windowed_[2], windowed_[3], 0);
        return;
    }
    glfwGetWindowPos(handle_, &windowed_[0], &windowed_[1]);
    glfwGetWindowSize(handle_, &windowed_[2], &windowed_[3]);
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    if (const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr)
        glfwSetWindowMonitor(handle_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void Window::size(std::uint32_t& width, std::uint32_t& height) const {
    int w = 0, h = 0;
    glfwGetFramebufferSize(handle_, &w, &h);
    width = std::uint32_t(w);
    height = std::uint32_t(h);
}

} // namespace sunfleck::app
