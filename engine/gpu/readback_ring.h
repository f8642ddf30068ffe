// Memory that the GPU writes and the CPU reads frames later, without waiting: as many buffers as there are frames in
// flight.
#pragma once

#include "engine/gpu/frame_graph.h"

#include <cstddef>
#include <deque>
#include <functional>
#include <span>
#include <string>

namespace sunfleck::gpu {

class ReadbackRing {
public:
    // `usage`: how the GPU writes the buffers.
    ReadbackRing(Device& device, std::string name, VkBufferUsageFlags usage)
        : device_(device), name_(std::move(name)), usage_(usage) {}

    struct Slot {
        Buffer buffer;
        std::uint64_t bytes = 0;  // of the buffer, that this frame uses
        std::uint64_t tag = 0;    // the caller's own
        std::uint64_t serial = 0; // frame that wrote it; 0: none did, or what it wrote is not wanted
    };
    // A slot with room for `bytes` that no frame in flight uses. It stays where it is as long as the ring.
    Result<Slot*> acquire(std::uint64_t completed_serial, std::uint64_t bytes);
    // Adds the pass that makes what frame `serial` wrote to `slot` visible to the CPU. After the pass that writes it.
    void add_pass(FrameGraph& graph, Slot& slot, std::uint64_t serial);

    // The newest frame that has a slot was recorded, but never submitted: what it should have written is not collected.
    void drop_newest();

    // The newest complete slot that was not collected before, or null.
    const Slot* collect(std::uint64_t completed_serial);
    template <typename T>
    static std::span<const T> content(const Slot& slot) {
        return {reinterpret_cast<const T*>(slot.buffer.mapped()), std::size_t(slot.bytes / sizeof(T))};
    }

private:
    Device& device_;
    std::string name_;
    VkBufferUsageFlags usage_;
    std::deque<Slot> slots_; // a deque: passes hold on to its elements
    std::uint64_t collected_ = 0;
};

} // namespace sunfleck::gpu
