// A window, its input and its swapchain.
#pragma once

#include "engine/core/maths.h"
#include "engine/gpu/frame_graph.h"
#include "engine/gpu/submission.h"

#include <array>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;
struct GLFWcursor;

namespace sunfleck::app {

// GLFW key codes, followed by mouse buttons, so that both can be bound to actions.
using Key = int;
inline constexpr Key no_key = -1, key_space = 32, key_escape = 256, key_enter = 257, key_tab = 258, key_right = 262,
                     key_left = 263, key_down = 264, key_up = 265, key_delete = 261, key_home = 268, key_f1 = 290,
                     key_left_shift = 340, key_left_control = 341, key_left_alt = 342, key_right_shift = 344,
                     key_right_control = 345, key_right_alt = 346, first_mouse_button = 400, key_count = 408;
// "W", "space", "left shift", "mouse 2".
std::string key_name(Key key);
// The inverse; no_key if there is no key of that name.
Key key_by_name(const std::string& name);

struct Gamepad {
    bool present = false;
    vec2 left{0.0f}, right{0.0f};                    // sticks, -1 to 1 with the dead zone removed; y downwards
    float left_trigger = 0.0f, right_trigger = 0.0f; // 0 to 1
    std::uint32_t buttons = 0; // bits in GLFW's order: A, B, X, Y, bumpers, back, start, guide, thumbs, d-pad
    bool pressed(int button) const { return (buttons >> button & 1u) != 0; }
    std::string name;
};

// Input state at a poll.
struct InputState {
    std::array<bool, key_count> keys{};
    std::vector<Key> went_down; // since the last poll, in order
    std::vector<std::uint32_t> text;
    vec2 mouse{0.0f};        // pixels
    vec2 mouse_motion{0.0f}; // since the last poll, while captured
    std::array<bool, 3> mouse_buttons{};
    float scroll = 0.0f;
    std::vector<std::filesystem::path> dropped; // files dropped on the window since the last poll
    bool focused = true;
    bool lost_focus = false; // since the last poll, whether it is back or not
    bool captured = false;   // the pointer is hidden and controls the view
    Gamepad gamepad;

    bool down(Key key) const { return key >= 0 && key < key_count && keys[std::size_t(key)]; }
    bool hit(Key key) const;
    // What is held and where the pointer is, without what has just happened.
    InputState still() const;
};

enum class Pointer { arrow, text, hand, horizontal, vertical, cross };

class Window {
public:
    // Starts the window system; the error says what to do where there is no display.
    static Result<std::unique_ptr<Window>> create(const std::string& title, std::uint32_t width, std::uint32_t height);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    // Instance extensions that the device must be created with.
    std::vector<const char*> instance_extensions() const;
    // Handles pending events. All keys count as released while the window is not focused.
    const InputState& poll();
    // The way of the captured pointer since the last poll, in pixels, up to what else came in the meantime. The next
    // poll has the rest. For a view that is drawn long after its frame began.
    vec2 poll_motion();
    const InputState& input() const { return input_; }
    // The next poll finds what the last one found once more, files that were dropped left out, and whatever came since
    // waits for the one after: for a frame that could not be drawn, in which it would be lost.
    void repeat();
    // One thing after the other: from now on a poll ends before the next key, button or movement once a key or button
    // changed, so that a click between two frames is seen where it happened. The rest comes with the next poll.
    void one_by_one(bool on) { one_by_one_ = on; }
    // Whether keys of letters write a text: all that have come are taken at once then, so that what is typed, or sent
    // by a program, faster than frames are drawn is not followed at a letter for each two frames.
    void typing(bool on) { typing_ = on; }
    // Whether events are left for the next poll.
    bool has_more() const { return !events_.empty(); }
    // How many events came so far, those among them that ask for the window to be drawn again: where the number is the
    // same, nothing has to be drawn.
    std::uint64_t event_count() const { return event_count_; }
    // Sleeps until an event arrives, at most this long; for minimised windows.
    void wait(double seconds);
    // Sleeps until an event arrives or another thread calls wake.
    void wait();
    // From any thread, while the window exists.
    static void wake();
    std::string clipboard() const;
    void set_clipboard(const std::string& text);
    void set_pointer(Pointer pointer);
    // Of text on the window's monitor: 1, or more on screens of high density.
    float scale() const;
    void capture_pointer(bool capture);
    bool should_close() const;
    void close();
    // Takes back a request to close.
    void keep_open();
    void set_title(const std::string& title);
    // On the monitor that shows most of the window.
    void set_full_screen(bool full_screen);
    bool full_screen() const;
    // Pixels; 0x0 while minimised.
    void size(std::uint32_t& width, std::uint32_t& height) const;
    GLFWwindow* handle() const { return handle_; }

private:
    friend struct WindowEvents;
    Window() = default;
    struct Event {
        enum class Kind { key, letter, button, pointer, jump, scroll, focus, drop } kind;
        int code = 0;
        bool down = false;
        double x = 0.0, y = 0.0;
        std::vector<std::filesystem::path> files{};
    };
    void take(const Event& event);
    void take_events();
    void move_pointer(vec2 place);
    void change_focus(bool focused);
    void read_gamepad();
    GLFWwindow* handle_ = nullptr;
    std::array<GLFWcursor*, 6> pointers_{}; // by Pointer, made when first shown
    Pointer pointer_ = Pointer::arrow;
    std::deque<Event> events_;
    bool writes_letter(const Event& event) const;
    bool one_by_one_ = false, typing_ = false;
    bool repeats_ = false;
    std::uint64_t event_count_ = 0;
    int windowed_[4] = {};
    InputState input_, pending_;
    vec2 last_mouse_{0.0f};
    bool skip_motion_ = true; // the pointer has just been captured
};

// The window's images. Recreated when the window is resized, and with a new surface when that is lost.
class Swapchain {
public:
    static Result<std::unique_ptr<Swapchain>> create(gpu::Device& device, Window& window,
                                                     std::uint32_t frames_in_flight);
    ~Swapchain();
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    // Vertical synchronisation (no tearing), or presentation without waiting where the device supports it.
    void set_vertical_sync(bool wait);
    // Acquires the next image. False: none is available (minimised, or the swapchain was recreated); try again next
    // frame.
    Result<bool> acquire(std::uint64_t serial);
    // View of the acquired image.
    VkExtent2D extent() const { return extent_; }
    // Adds a pass that scales `source` (in copy-source state) onto the acquired image.
    Status record_blit(VkCommandBuffer commands, gpu::FrameResources& resources, const gpu::Image& source);
    const gpu::PresentSemaphores& semaphores() const { return current_; }
    Status present();

private:
    Swapchain(gpu::Device& device, Window& window) : device_(device), window_(window) {}
    Status make_surface();
    Status rebuild();
    Result<VkSurfaceFormatKHR> choose_format() const;
    Status create_chain(const VkSurfaceCapabilitiesKHR& capabilities);
    VkPresentModeKHR present_mode() const;
    void destroy_chain();

    gpu::Device& device_;
    Window& window_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkSwapchainKHR chain_ = VK_NULL_HANDLE;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    VkExtent2D extent_{};
    std::vector<VkImage> images_;
    std::vector<VkSemaphore> acquired_; // per frame in flight
    std::vector<VkSemaphore> rendered_; // per image
    gpu::PresentSemaphores current_;
    std::uint32_t image_ = 0;
    bool stale_ = true, surface_lost_ = false, vertical_sync_ = true;
};

} // namespace sunfleck::app
