#include "engine/app/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace sunfleck::app {
namespace {

constexpr float dead_zone = 0.16f; // of a stick

struct NamedKey {
    Key key;
    const char* name;
};
constexpr NamedKey named_keys[] = {{key_space, "space"},
                                   {key_escape, "escape"},
                                   {key_enter, "enter"},
                                   {key_tab, "tab"},
                                   {259, "backspace"},
                                   {260, "insert"},
                                   {261, "delete"},
                                   {key_right, "right"},
                                   {key_left, "left"},
                                   {key_down, "down"},
                                   {key_up, "up"},
                                   {266, "page up"},
                                   {267, "page down"},
                                   {268, "home"},
                                   {269, "end"},
                                   {key_left_shift, "left shift"},
                                   {key_left_control, "left control"},
                                   {342, "left alt"},
                                   {344, "right shift"},
                                   {345, "right control"},
                                   {346, "right alt"},
                                   {39, "'"},
                                   {44, ","},
                                   {45, "-"},
                                   {46, "."},
                                   {47, "/"},
                                   {59, ";"},
                                   {61, "="},
                                   {91, "["},
                                   {92, "\\"},
                                   {93, "]"},
                                   {96, "`"}};

vec2 without_dead_zone(vec2 stick) {
    const float length = glm::length(stick);
    if (length < dead_zone)
        return vec2(0.0f);
    return stick / length * std::min((length - dead_zone) / (1.0f - dead_zone), 1.0f);
}

} // namespace

std::string key_name(Key key) {
    for (const NamedKey& named : named_keys)
        if (named.key == key)
            return named.name;
    if ((key >= 48 && key <= 57) || (key >= 65 && key <= 90))
        return std::string(1, char(key));
    if (key >= key_f1 && key < key_f1 + 25)
        return "F" + std::to_string(key - key_f1 + 1);
    if (key >= first_mouse_button && key < key_count)
        return "mouse " + std::to_string(key - first_mouse_button + 1);
    return key == no_key ? "none" : "key " + std::to_string(key);
}

Key key_by_name(const std::string& name) {
    for (Key key = 0; key < key_count; ++key)
        if (key_name(key) == name)
            return key;
    return no_key;
}

bool InputState::hit(Key key) const {
    return std::find(went_down.begin(), went_down.end(), key) != went_down.end();
}

InputState InputState::still() const {
    InputState result = *this;
    result.went_down.clear();
    result.text.clear();
    result.dropped.clear();
    result.mouse_motion = vec2(0.0f);
    result.scroll = 0.0f;
    return result;
}

// Callbacks of the window system.
struct WindowEvents {
    using Kind = Window::Event::Kind;
    static Window& of(GLFWwindow* handle) { return *static_cast<Window*>(glfwGetWindowUserPointer(handle)); }
    static void add(GLFWwindow* handle, Window::Event event) {
        of(handle).events_.push_back(std::move(event));
        ++of(handle).event_count_;
    }
    static void key(GLFWwindow* handle, int key, int, int action, int) {
        if (action == GLFW_REPEAT)
            return redraw(handle); // who repeats keys that are held has to see the time pass
        add(handle, {Kind::key, key, action == GLFW_PRESS});
    }
    static void letter(GLFWwindow* handle, unsigned int code) { add(handle, {Kind::letter, int(code)}); }
    static void button(GLFWwindow* handle, int button, int action, int) {
        add(handle, {Kind::button, button, action == GLFW_PRESS});
    }
    static void pointer(GLFWwindow* handle, double x, double y) { add(handle, {Kind::pointer, 0, false, x, y}); }
    static void scroll(GLFWwindow* handle, double x, double y) { add(handle, {Kind::scroll, 0, false, x, y}); }
    static void focus(GLFWwindow* handle, int focused) { add(handle, {Kind::focus, 0, focused == GLFW_TRUE}); }
    // The window went elsewhere or took another size, or the pointer came in: its next place is no motion.
    static void jump(GLFWwindow* handle, int, int) { add(handle, {Kind::jump}); }
    static void enter(GLFWwindow* handle, int) { add(handle, {Kind::jump}); }
    static void redraw(GLFWwindow* handle) { ++of(handle).event_count_; }
    static void resize(GLFWwindow* handle, int, int) { redraw(handle); }
    static void drop(GLFWwindow* handle, int count, const char** paths) {
        add(handle, {Kind::drop, 0, false, 0.0, 0.0, {paths, paths + count}});
    }
};

void Window::move_pointer(vec2 place) {
    if (pending_.captured && !skip_motion_)
        pending_.mouse_motion += place - last_mouse_;
    skip_motion_ = false;
    last_mouse_ = place;
    pending_.mouse = place;
}

void Window::change_focus(bool focused) {
    pending_.focused = focused;
    pending_.lost_focus = pending_.lost_focus || !focused;
    skip_motion_ = true;
    if (!focused) { // key releases outside the window are not reported
        pending_.keys.fill(false);
        pending_.mouse_buttons.fill(false);
    }
}

void Window::take(const Event& event) {
    const auto set = [&](Key key) {
        if (key < 0 || key >= key_count)
            return;
        pending_.keys[std::size_t(key)] = event.down;
        if (event.down)
            pending_.went_down.push_back(key);
    };
    switch (event.kind) {
    case Event::Kind::key:
        return set(event.code);
    case Event::Kind::letter:
        return pending_.text.push_back(std::uint32_t(event.code));
    case Event::Kind::button:
        set(first_mouse_button + event.code);
        if (event.code < 3)
            pending_.mouse_buttons[std::size_t(event.code)] = event.down;
        return;
    case Event::Kind::pointer:
        return move_pointer({float(event.x), float(event.y)});
    case Event::Kind::jump:
        skip_motion_ = true;
        return;
    case Event::Kind::scroll:
        pending_.scroll += float(event.y);
        return;
    case Event::Kind::focus:
        return change_focus(event.down);
    case Event::Kind::drop:
        pending_.dropped.insert(pending_.dropped.end(), event.files.begin(), event.files.end());
        return;
    }
}

// A key that is only a part of a letter's way into a text: not with Control or Alt, when it is a command.
bool Window::writes_letter(const Event& event) const {
    constexpr int last_letter = 255;
    const auto held = [&](Key key) { return pending_.keys[std::size_t(key)]; };
    if (!typing_ || event.kind != Event::Kind::key || held(key_left_control) || held(key_right_control) ||
        held(key_left_alt) || held(key_right_alt))
        return false;
    return event.code <= last_letter || event.code == key_left_shift || event.code == key_right_shift;
}

void Window::take_events() {
    bool changed = false;
    while (!events_.empty()) {
        const Event::Kind kind = events_.front().kind;
        if (one_by_one_ && changed && kind != Event::Kind::letter && kind != Event::Kind::focus)
            return;
        changed =
            changed || kind == Event::Kind::button || (kind == Event::Kind::key && !writes_letter(events_.front()));
        take(events_.front());
        events_.pop_front();
    }
}

Result<std::unique_ptr<Window>> Window::create(const std::string& title, std::uint32_t width, std::uint32_t height) {
    if (!glfwInit()) {
        const char* why = nullptr;
        glfwGetError(&why);
        return Error{"no window system was found (is DISPLAY set?" + (why ? " " + std::string(why) : std::string()) +
                     "); start it from a desktop, or under xvfb-run"};
    }
    std::unique_ptr<Window> window(new Window());
    if (!glfwVulkanSupported())
        return Error{"the window system does not support Vulkan"};
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window->handle_ = glfwCreateWindow(int(width), int(height), title.c_str(), nullptr, nullptr);
    if (window->handle_ == nullptr)
        return Error{"a window could not be opened"};
    GLFWwindow* handle = window->handle_;
    glfwSetWindowSizeLimits(handle, 160, 120, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwSetWindowUserPointer(handle, window.get());
    glfwSetKeyCallback(handle, WindowEvents::key);
    glfwSetCharCallback(handle, WindowEvents::letter);
    glfwSetMouseButtonCallback(handle, WindowEvents::button);
    glfwSetCursorPosCallback(handle, WindowEvents::pointer);
    glfwSetCursorEnterCallback(handle, WindowEvents::enter);
    glfwSetWindowSizeCallback(handle, WindowEvents::jump);
    glfwSetWindowPosCallback(handle, WindowEvents::jump);
    glfwSetScrollCallback(handle, WindowEvents::scroll);
    glfwSetWindowFocusCallback(handle, WindowEvents::focus);
    glfwSetDropCallback(handle, WindowEvents::drop);
    glfwSetWindowRefreshCallback(handle, WindowEvents::redraw);
    glfwSetWindowCloseCallback(handle, WindowEvents::redraw);
    glfwSetFramebufferSizeCallback(handle, WindowEvents::resize);
    window->pending_.focused = true; // without a window manager, no focus event arrives
    return window;
}

Window::~Window() {
    for (GLFWcursor* shape : pointers_)
        if (shape != nullptr)
            glfwDestroyCursor(shape);
    if (handle_ != nullptr)
        glfwDestroyWindow(handle_);
    glfwTerminate();
}

std::vector<const char*> Window::instance_extensions() const {
    std::uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    return {names, names + count};
}

void Window::repeat() {
    repeats_ = true;
    input_.dropped.clear();
}

const InputState& Window::poll() {
    glfwPollEvents();
    if (std::exchange(repeats_, false))
        return input_;
    read_gamepad();
    take_events();
    input_ = pending_;
    pending_ = input_.still();
    pending_.lost_focus = false;
    return input_;
}

vec2 Window::poll_motion() {
    glfwPollEvents();
    for (; !events_.empty() && events_.front().kind == Event::Kind::pointer; events_.pop_front())
        take(events_.front());
    return std::exchange(pending_.mouse_motion, vec2(0.0f));
}

// The first one in the mapping database; gamepads may come and go.
void Window::read_gamepad() {
    Gamepad& pad = pending_.gamepad;
    pad = {};
    for (int id = GLFW_JOYSTICK_1; id <= GLFW_JOYSTICK_LAST; ++id) {
        GLFWgamepadstate state;
        if (!glfwJoystickIsGamepad(id) || !glfwGetGamepadState(id, &state))
            continue;
        pad.present = true;
        pad.name = glfwGetGamepadName(id);
        pad.left = without_dead_zone({state.axes[0], state.axes[1]});
        pad.right = without_dead_zone({state.axes[2], state.axes[3]});
        pad.left_trigger = 0.5f * (state.axes[4] + 1.0f);
        pad.right_trigger = 0.5f * (state.axes[5] + 1.0f);
        for (int button = 0; button <= GLFW_GAMEPAD_BUTTON_LAST; ++button)
            pad.buttons |= state.buttons[button] == GLFW_PRESS ? 1u << button : 0u;
        return;
    }
}

void Window::wait(double seconds) {
    glfwWaitEventsTimeout(seconds);
}

void Window::wait() {
    glfwWaitEvents();
}

void Window::wake() {
    glfwPostEmptyEvent();
}

std::string Window::clipboard() const {
    const char* text = glfwGetClipboardString(handle_);
    return text != nullptr ? text : "";
}

void Window::set_clipboard(const std::string& text) {
    glfwSetClipboardString(handle_, text.c_str());
}

void Window::set_pointer(Pointer pointer) {
    if (pointer == pointer_)
        return;
    pointer_ = pointer;
    constexpr int shapes[] = {GLFW_ARROW_CURSOR,   GLFW_IBEAM_CURSOR,   GLFW_HAND_CURSOR,
                              GLFW_HRESIZE_CURSOR, GLFW_VRESIZE_CURSOR, GLFW_CROSSHAIR_CURSOR};
    GLFWcursor*& shape = pointers_[std::size_t(pointer)];
    if (shape == nullptr)
        shape = glfwCreateStandardCursor(shapes[std::size_t(pointer)]);
    glfwSetCursor(handle_, shape);
}

float Window::scale() const {
    float x = 1.0f, y = 1.0f;
    glfwGetWindowContentScale(handle_, &x, &y);
    return std::max(x, 1.0f);
}

void Window::capture_pointer(bool capture) {
    if (capture == pending_.captured)
        return;
    pending_.captured = capture;
    skip_motion_ = true;
    glfwSetInputMode(handle_, GLFW_CURSOR, capture ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    if (glfwRawMouseMotionSupported())
        glfwSetInputMode(handle_, GLFW_RAW_MOUSE_MOTION, capture ? GLFW_TRUE : GLFW_FALSE);
}

bool Window::should_close() const {
    return glfwWindowShouldClose(handle_);
}
void Window::close() {
    glfwSetWindowShouldClose(handle_, GLFW_TRUE);
}
void Window::keep_open() {
    glfwSetWindowShouldClose(handle_, GLFW_FALSE);
}
void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(handle_, title.c_str());
}
bool Window::full_screen() const {
    return glfwGetWindowMonitor(handle_) != nullptr;
}

void Window::set_full_screen(bool wanted) {
    if (wanted == full_screen())
        return;
    if (!wanted) {
        glfwSetWindowMonitor(handle_, nullptr, windowed_[0], windowed_[1], windowed_[2], windowed_[3], 0);
        return;
    }
    glfwGetWindowPos(handle_, &windowed_[0], &windowed_[1]);
    glfwGetWindowSize(handle_, &windowed_[2], &windowed_[3]);
    int count = 0;
    GLFWmonitor** monitors = glfwGetMonitors(&count);
    GLFWmonitor* best = glfwGetPrimaryMonitor();
    int largest = 0;
    for (int i = 0; i < count; ++i) {
        int x = 0, y = 0;
        glfwGetMonitorPos(monitors[i], &x, &y);
        const GLFWvidmode* mode = glfwGetVideoMode(monitors[i]);
        if (mode == nullptr)
            continue;
        const int wide = std::min(x + mode->width, windowed_[0] + windowed_[2]) - std::max(x, windowed_[0]);
        const int high = std::min(y + mode->height, windowed_[1] + windowed_[3]) - std::max(y, windowed_[1]);
        if (wide > 0 && high > 0 && wide * high > largest) {
            largest = wide * high;
            best = monitors[i];
        }
    }
    if (const GLFWvidmode* mode = best != nullptr ? glfwGetVideoMode(best) : nullptr)
        glfwSetWindowMonitor(handle_, best, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void Window::size(std::uint32_t& width, std::uint32_t& height) const {
    int w = 0, h = 0;
    glfwGetFramebufferSize(handle_, &w, &h);
    // A minimised window keeps its size on some window systems.
    const bool hidden = glfwGetWindowAttrib(handle_, GLFW_ICONIFIED) == GLFW_TRUE;
    width = hidden ? 0 : std::uint32_t(std::max(w, 0));
    height = hidden ? 0 : std::uint32_t(std::max(h, 0));
}

} // namespace sunfleck::app
