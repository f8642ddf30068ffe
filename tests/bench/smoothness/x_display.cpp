#include "tests/bench/smoothness/x_display.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <dlfcn.h>

namespace sunfleck::bench {

struct XDisplay::Parts {
    Display* display = nullptr;
    Window window = 0;
    void* library = nullptr;
    int (*fake_motion)(Display*, int, int, unsigned long) = nullptr;
    int (*fake_key)(Display*, unsigned, int, unsigned long) = nullptr;
};

namespace {

// A program that closes its window must not end this one.
int ignore_error(Display*, XErrorEvent*) {
    return 0;
}

Window find_below(Display* display, Window window, const std::string& title) {
    char* name = nullptr;
    const bool named = XFetchName(display, window, &name) != 0 && name != nullptr && title == name;
    if (name != nullptr)
        XFree(name);
    XWindowAttributes attributes{};
    if (named && XGetWindowAttributes(display, window, &attributes) != 0 && attributes.map_state == IsViewable &&
        attributes.width > 1)
        return window;
    Window root = 0, parent = 0, *children = nullptr, found = 0;
    unsigned count = 0;
    if (XQueryTree(display, window, &root, &parent, &children, &count) == 0)
        return 0;
    for (unsigned i = 0; i < count && found == 0; ++i)
        found = find_below(display, children[i], title);
    if (children != nullptr)
        XFree(children);
    return found;
}

} // namespace

Result<std::unique_ptr<XDisplay>> XDisplay::open(const std::string& name) {
    std::unique_ptr<XDisplay> result(new XDisplay());
    result->parts_ = std::make_unique<Parts>();
    Parts& parts = *result->parts_;
    XSetErrorHandler(ignore_error);
    parts.display = XOpenDisplay(name.c_str());
    if (parts.display == nullptr)
        return Error{"cannot open the display '" + name + "'"};
    parts.library = ::dlopen("libXtst.so.6", RTLD_NOW);
    if (parts.library != nullptr) {
        parts.fake_motion =
            reinterpret_cast<decltype(parts.fake_motion)>(::dlsym(parts.library, "XTestFakeRelativeMotionEvent"));
        parts.fake_key = reinterpret_cast<decltype(parts.fake_key)>(::dlsym(parts.library, "XTestFakeKeyEvent"));
    }
    if (parts.fake_motion == nullptr || parts.fake_key == nullptr)
        return Error{"libXtst.so.6 is missing: install xdotool, which needs it, too"};
    return result;
}

XDisplay::~XDisplay() {
    if (parts_ && parts_->display != nullptr)
        XCloseDisplay(parts_->display);
    if (parts_ && parts_->library != nullptr)
        ::dlclose(parts_->library);
}

bool XDisplay::find_window(const std::string& title) {
    parts_->window = find_below(parts_->display, DefaultRootWindow(parts_->display), title);
    return parts_->window != 0;
}

void XDisplay::focus() {
    XRaiseWindow(parts_->display, parts_->window);
    XSetInputFocus(parts_->display, parts_->window, RevertToParent, CurrentTime);
    XSync(parts_->display, False);
}

void XDisplay::move_pointer(int right, int down) {
    parts_->fake_motion(parts_->display, right, down, 0);
    XSync(parts_->display, False);
}

void XDisplay::key(const char* name, bool down) {
    parts_->fake_key(parts_->display, XKeysymToKeycode(parts_->display, XStringToKeysym(name)), down, 0);
    XSync(parts_->display, False);
}

void XDisplay::tap(const char* name) {
    key(name, true);
    key(name, false);
}

std::vector<std::uint8_t> XDisplay::pixels(const PixelRegion& region) {
    XImage* image =
        XGetImage(parts_->display, parts_->window, region.x, region.y, region.width, region.height, AllPlanes, ZPixmap);
    if (image == nullptr)
        return {};
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(image->data);
    std::vector<std::uint8_t> result(bytes, bytes + std::size_t(image->bytes_per_line) * std::size_t(image->height));
    XDestroyImage(image);
    return result;
}

} // namespace sunfleck::bench
