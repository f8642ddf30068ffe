// A program's own frame loop on the device's queue: command buffers, frames in flight, serials. A host of the GI module
// has its own instead.
#pragma once

#include "engine/gpu/resources.h"

#include <chrono>
#include <functional>

namespace sunfleck::gpu {

// Semaphores of a window's swapchain that one submission waits for and signals.
struct PresentSemaphores {
    VkSemaphore acquired = VK_NULL_HANDLE;
    VkSemaphore rendered = VK_NULL_HANDLE;
};

class Submission {
public:
    static Result<std::unique_ptr<Submission>> create(Device& device, std::uint32_t frames_in_flight);
    ~Submission();

    // Waits until a slot is free (at most frames_in_flight are pending) and starts its command buffer.
    Result<VkCommandBuffer> begin();
    // Ends and submits; the serial of this submission is serial() before the call.
    Status submit(const PresentSemaphores* semaphores = nullptr);
    // Serial of the frame being recorded, from 1.
    std::uint64_t serial() const { return serial_; }
    // Serials up to this one are finished on the GPU.
    Result<std::uint64_t> completed();
    Status wait(std::uint64_t serial);
    // Whether it is finished after at most so long.
    Result<bool> wait_for(std::uint64_t serial, std::chrono::nanoseconds time);

    // Records, submits and waits: for set-up and read-back, never within a frame.
    Status immediate(const std::function<Status(VkCommandBuffer)>& record);

private:
    explicit Submission(Device& device) : device_(device) {}
    struct Slot {
        VkCommandPool pool = VK_NULL_HANDLE;
        VkCommandBuffer commands = VK_NULL_HANDLE;
        std::uint64_t serial = 0;
    };
    Device& device_;
    std::vector<Slot> slots_;
    VkSemaphore timeline_ = VK_NULL_HANDLE;
    std::uint64_t serial_ = 1;
};

// Copies CPU data into a device buffer at once (creation time only).
Status upload_now(Device& device, Submission& submission, const Buffer& target, std::span<const std::byte> bytes,
                  VkDeviceSize offset = 0);

// An image that shaders sample, filled at once (creation time only). `regions` place levels within `bytes`; usage is
// added to the description.
Result<Image> make_sampled_image(Device& device, Submission& submission, ImageDescription description,
                                 std::span<const std::byte> bytes, std::span<const VkBufferImageCopy> regions);

} // namespace sunfleck::gpu
