// How many of a frame's passes the device has done, while it works on them: for frames that take so long that somebody
// wants to know. Each count waits for the passes before it, which costs something, so other frames are recorded without
// it.
#pragma once

#include "engine/gpu/resources.h"

namespace sunfleck::gpu {

class PassProgress {
public:
    static Result<PassProgress> create(Device& device);

    // After each pass of the frame, once that is recorded.
    void pass_recorded(VkCommandBuffer commands);
    // Of the passes recorded, as the device counts them; from any thread once all are recorded. Only for people to
    // read: the device writes it while it is read.
    double share_done() const;
    std::uint32_t recorded() const { return recorded_; }

private:
    explicit PassProgress(Device& device) : device_(&device) {}

    Device* device_;
    Buffer done_; // one number, which the device writes
    std::uint32_t recorded_ = 0;
};

} // namespace sunfleck::gpu
