// One scope opens a debug label and a timestamp pair under one name. Results arrive when the GPU has finished the
// frame, tagged with its serial; nothing waits for them.
#pragma once

#include "engine/gpu/device.h"

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sunfleck::gpu {

struct FrameTimes {
    std::uint64_t serial = 0;
    std::map<std::string, double> milliseconds; // scopes of one name are summed
};

class Timers {
public:
    explicit Timers(Device& device) : device_(device) {}
    ~Timers();
    Timers(const Timers&) = delete;
    Timers& operator=(const Timers&) = delete;

    void begin_frame(std::uint64_t serial, std::uint64_t completed_serial);
    void begin_scope(VkCommandBuffer commands, const std::string& name);
    void end_scope(VkCommandBuffer commands);

    // Times of the newest frame whose GPU work is complete, once begin_frame or collect has seen its serial.
    const FrameTimes& latest() const { return latest_; }
    void collect(std::uint64_t completed_serial);

private:
    struct Frame {
        VkQueryPool pool = VK_NULL_HANDLE;
        std::uint64_t serial = 0;
        std::vector<std::string> names;
        std::vector<std::uint32_t> open; // indices into names
    };

    Device& device_;
    std::deque<Frame> frames_; // in flight, oldest first
    std::vector<VkQueryPool> spare_;
    FrameTimes latest_;
};

} // namespace sunfleck::gpu
