// Drops files on a window, as a file manager does: the source's side of the XDND protocol (version 5).
//
//     drop_files WINDOW FILE...
//
// WINDOW: its number, as xdotool says it. The files land in its middle. Exit status 0 once the window has taken them.
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

namespace {

constexpr long version = 5;

class Source {
public:
    Source(Window target, std::string list) : target_(target), list_(std::move(list)) {}

    bool run() {
        if (display_ == nullptr)
            return false;
        window_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
        XSetSelectionOwner(display_, atom("XdndSelection"), window_, CurrentTime);
        send("XdndEnter", {long(window_), version << 24, long(atom("text/uri-list")), 0, 0});
        int x = 0, y = 0;
        Window child = 0;
        XTranslateCoordinates(display_, target_, DefaultRootWindow(display_), 100, 100, &x, &y, &child);
        send("XdndPosition", {long(window_), 0, (long(x) << 16) | y, CurrentTime, long(atom("XdndActionCopy"))});
        return answer();
    }

private:
    Atom atom(const char* name) const { return XInternAtom(display_, name, False); }

    void send(const char* message, std::array<long, 5> values) const {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = target_;
        event.xclient.message_type = atom(message);
        event.xclient.format = 32;
        for (std::size_t i = 0; i < values.size(); ++i)
            event.xclient.data.l[i] = values[i];
        XSendEvent(display_, target_, False, NoEventMask, &event);
        XFlush(display_);
    }

    // Until the window has finished, at most half a minute.
    bool answer() {
        for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
             std::chrono::steady_clock::now() < end;) {
            if (XPending(display_) == 0) {
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
                continue;
            }
            XEvent event;
            XNextEvent(display_, &event);
            if (event.type == SelectionRequest)
                give(event.xselectionrequest);
            if (event.type != ClientMessage)
                continue;
            if (event.xclient.message_type == atom("XdndStatus"))
                send("XdndDrop", {long(window_), 0, CurrentTime, 0, 0});
            if (event.xclient.message_type == atom("XdndFinished"))
                return true;
        }
        return false;
    }

    void give(const XSelectionRequestEvent& request) const {
        XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                        reinterpret_cast<const unsigned char*>(list_.data()), int(list_.size()));
        XEvent event{};
        event.xselection.type = SelectionNotify;
        event.xselection.requestor = request.requestor;
        event.xselection.selection = request.selection;
        event.xselection.target = request.target;
        event.xselection.property = request.property;
        event.xselection.time = request.time;
        XSendEvent(display_, request.requestor, False, NoEventMask, &event);
        XFlush(display_);
    }

    Display* display_ = XOpenDisplay(nullptr);
    Window target_, window_ = 0;
    std::string list_; // of addresses, a line each
};

} // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fputs("drop_files WINDOW FILE...\n", stderr);
        return 2;
    }
    std::string list;
    for (int i = 2; i < argc; ++i)
        list += std::string("file://") + argv[i] + "\r\n";
    Source source(Window(std::strtoul(argv[1], nullptr, 0)), std::move(list));
    return source.run() ? 0 : 1;
}
