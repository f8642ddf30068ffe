// A Vulkan layer whose devices stop answering: SUNFLECK_LOSE=40,25 loses the first device of the process with its 40th
// submission and the second one with its 25th (0: never); SUNFLECK_LOSE_FILE names a file, and once there is one of
// that name, it is removed, and the device that submits next is lost. What was submitted before is finished then, so
// that programs may destroy what they made, as on a device that is lost they may at any time.
#include "tests/support/vulkan_layer.h"

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>

namespace sunfleck::layer {
namespace {

struct LossyDevice {
    Device below;
    unsigned long lose_at = 0, submissions = 0;
    std::atomic<bool> lost{false};
};

std::map<void*, std::shared_ptr<LossyDevice>> lossy_devices;
std::size_t devices_made = 0;

template <typename Handle>
std::shared_ptr<LossyDevice> lossy(Handle handle) {
    const std::scoped_lock lock(mutex);
    return lossy_devices.at(table_of(handle));
}

unsigned long submission_that_loses(std::size_t device) {
    const char* text = std::getenv("SUNFLECK_LOSE");
    std::istringstream list(text != nullptr ? text : "");
    std::string entry;
    for (std::size_t i = 0; i <= device; ++i)
        if (!std::getline(list, entry, ','))
            return 0;
    return std::strtoul(entry.c_str(), nullptr, 10);
}

bool loss_is_asked_for() {
    const char* file = std::getenv("SUNFLECK_LOSE_FILE");
    return file != nullptr && std::remove(file) == 0;
}

VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* infos, VkFence fence) {
    const auto device = lossy(queue);
    if (!device->lost && (++device->submissions == device->lose_at || loss_is_asked_for())) {
        device->below.function<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(device->below.handle);
        device->lost = true;
    }
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->below.function<PFN_vkQueueSubmit2>("vkQueueSubmit2")(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR* info) {
    const auto device = lossy(queue);
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->below.function<PFN_vkQueuePresentKHR>("vkQueuePresentKHR")(queue, info);
}

VKAPI_ATTR VkResult VKAPI_CALL acquire(VkDevice handle, VkSwapchainKHR chain, std::uint64_t timeout,
                                       VkSemaphore semaphore, VkFence fence, std::uint32_t* image) {
    const auto device = lossy(handle);
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->below.function<PFN_vkAcquireNextImageKHR>("vkAcquireNextImageKHR")(
                              handle, chain, timeout, semaphore, fence, image);
}

VKAPI_ATTR VkResult VKAPI_CALL wait_semaphores(VkDevice handle, const VkSemaphoreWaitInfo* info,
                                               std::uint64_t timeout) {
    const auto device = lossy(handle);
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->below.function<PFN_vkWaitSemaphores>("vkWaitSemaphores")(handle, info, timeout);
}

VKAPI_ATTR VkResult VKAPI_CALL counter_value(VkDevice handle, VkSemaphore semaphore, std::uint64_t* value) {
    const auto device = lossy(handle);
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->below.function<PFN_vkGetSemaphoreCounterValue>("vkGetSemaphoreCounterValue")(
                              handle, semaphore, value);
}

VKAPI_ATTR VkResult VKAPI_CALL wait_idle(VkDevice handle) {
    const auto device = lossy(handle);
    const VkResult result = device->below.function<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(handle);
    return device->lost ? VK_ERROR_DEVICE_LOST : result;
}

} // namespace

PFN_vkVoidFunction own_device_function(const char* name) {
    const std::array<std::pair<const char*, PFN_vkVoidFunction>, 6> own = {
        {{"vkQueueSubmit2", untyped(submit)},
         {"vkQueuePresentKHR", untyped(present)},
         {"vkAcquireNextImageKHR", untyped(acquire)},
         {"vkWaitSemaphores", untyped(wait_semaphores)},
         {"vkGetSemaphoreCounterValue", untyped(counter_value)},
         {"vkDeviceWaitIdle", untyped(wait_idle)}}};
    for (const auto& [known, function] : own)
        if (std::strcmp(known, name) == 0)
            return function;
    return nullptr;
}

void device_made(VkDevice handle) {
    auto device = std::make_shared<LossyDevice>();
    device->below = device_of(handle);
    const std::scoped_lock lock(mutex);
    device->lose_at = submission_that_loses(devices_made++);
    lossy_devices[table_of(handle)] = std::move(device);
}

} // namespace sunfleck::layer
