// GPU times of named scopes: a pair of timestamps each. Results arrive when the GPU has finished the frame, tagged with
// its serial; nothing waits for them.
#pragma once

#include "engine/gpu/device.h"

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sunfleck::gpu {

// One scope of a frame, in ms from the first scope's begin.
struct ScopeTime {
    std::string name;
    double begin_ms = 0.0, end_ms = 0.0;
};

struct FrameTimes {
    std::uint64_t serial = 0;
    std::map<std::string, double> milliseconds; // scopes of one name are summed
    std::vector<ScopeTime> scopes;              // in the order in which they began
};

class Timers {
public:
    explicit Timers(Device& device) : device_(device) {}
    ~Timers();
    Timers(const Timers&) = delete;
    Timers& operator=(const Timers&) = delete;

    // Fails where the device is lost; whatever else goes wrong, a frame has no times.
    Status begin_frame(std::uint64_t serial, std::uint64_t completed_serial);
    void begin_scope(VkCommandBuffer commands, const std::string& name);
    void end_scope(VkCommandBuffer commands);

    // Times of the newest frame whose GPU work is complete, once begin_frame or collect has seen its serial.
    const FrameTimes& latest() const { return latest_; }
    Status collect(std::uint64_t completed_serial);

private:
    struct Frame {
        VkQueryPool pool = VK_NULL_HANDLE;
        std::uint64_t serial = 0;
        std::vector<std::string> names;
        std::vector<std::uint32_t> open; // indices into names
    };

    VkQueryPool take_pool();
    FrameTimes times_of(const Frame& frame, const std::vector<std::uint64_t>& stamps) const;

    Device& device_;
    std::deque<Frame> frames_;               // in flight, oldest first
    std::vector<VkQueryPool> pools_, spare_; // all of them, and those that no frame has
    FrameTimes latest_;
};

// A scope from construction to destruction; nothing without timers.
class TimerScope {
public:
    TimerScope(Timers* timers, VkCommandBuffer commands, const std::string& name)
        : timers_(timers), commands_(commands) {
        if (timers_ != nullptr)
            timers_->begin_scope(commands_, name);
    }
    ~TimerScope() {
        if (timers_ != nullptr)
            timers_->end_scope(commands_);
    }
    TimerScope(const TimerScope&) = delete;
    TimerScope& operator=(const TimerScope&) = delete;

private:
    Timers* timers_;
    VkCommandBuffer commands_;
};

} // namespace sunfleck::gpu
