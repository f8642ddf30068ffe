// An X display as a person has it: a window's pixels to look at, a pointer and keys to move.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace sunfleck::bench {

// A rectangle of a window, pixels.
struct PixelRegion {
    int x = 0, y = 0;
    unsigned width = 0, height = 0;
};

// Every call returns when the server has done it.
class XDisplay {
public:
    // `name` as in DISPLAY. Needs the XTEST extension and libXtst.so.6, which xdotool brings along.
    static Result<std::unique_ptr<XDisplay>> open(const std::string& name);
    ~XDisplay();
    XDisplay(const XDisplay&) = delete;
    XDisplay& operator=(const XDisplay&) = delete;

    // Looks at the visible window of this title; false: there is none.
    bool find_window(const std::string& title);
    void focus();
    void move_pointer(int right, int down);
    // A key by its name in X: "w", "Return".
    void key(const char* name, bool down);
    void tap(const char* name);
    // Bytes of the window's pixels; empty if it cannot be read.
    std::vector<std::uint8_t> pixels(const PixelRegion& region);

private:
    XDisplay() = default;
    struct Parts; // what Xlib's header defines is kept out of here
    std::unique_ptr<Parts> parts_;
};

} // namespace sunfleck::bench
