#include "engine/gpu/readback_ring.h"

#include <algorithm>

namespace sunfleck::gpu {

Result<ReadbackRing::Slot*> ReadbackRing::acquire(std::uint64_t completed_serial, std::uint64_t bytes) {
    auto slot = std::find_if(slots_.begin(), slots_.end(), [&](const Slot& candidate) {
        return candidate.serial <= completed_serial && candidate.buffer.size() >= bytes;
    });
    if (slot == slots_.end()) {
        Slot fresh;
        SUNFLECK_ASSIGN(fresh.buffer, Buffer::create(device_, {name_, bytes, usage_, MemoryUse::readback}));
        slots_.push_back(std::move(fresh));
        slot = slots_.end() - 1;
    }
    slot->bytes = bytes;
    slot->serial = 0;
    return &*slot;
}

void ReadbackRing::add_pass(FrameGraph& graph, Slot& slot, std::uint64_t serial) {
    graph.add_pass(name_ + " for the CPU").read(graph.import_buffer(slot.buffer), Usage::host_read).keep();
    graph.when_executed([&slot, serial] { slot.serial = serial; });
}

void ReadbackRing::drop_newest() {
    const auto newest = std::max_element(slots_.begin(), slots_.end(),
                                         [](const Slot& a, const Slot& b) { return a.serial < b.serial; });
    if (newest != slots_.end())
        newest->serial = 0;
}

const ReadbackRing::Slot* ReadbackRing::collect(std::uint64_t completed_serial) {
    const Slot* newest = nullptr;
    for (const Slot& slot : slots_)
        if (slot.serial > collected_ && slot.serial <= completed_serial &&
            (newest == nullptr || slot.serial > newest->serial))
            newest = &slot;
    if (newest != nullptr)
        collected_ = newest->serial;
    return newest;
}

} // namespace sunfleck::gpu
