// A Vulkan layer whose devices stop answering: SUNFLECK_LOSE=40,25 loses the first device of the process with its 40th
// submission and the second one with its 25th (0: never); SUNFLECK_LOSE_FILE names a file, and once there is one of
// that name, it is removed, and the device that submits next is lost. What was submitted before is finished then, so
// that programs may destroy what they made, as on a device that is lost they may at any time.
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>
#include <vulkan/vk_layer.h>

namespace {

struct Device {
    VkDevice handle = VK_NULL_HANDLE;
    PFN_vkGetDeviceProcAddr next = nullptr;
    unsigned long lose_at = 0, submissions = 0;
    std::atomic<bool> lost{false};

    template <typename Function>
    Function function(const char* name) const {
        return reinterpret_cast<Function>(next(handle, name));
    }
};

std::mutex mutex;
struct Instance {
    VkInstance handle = VK_NULL_HANDLE;
    PFN_vkGetInstanceProcAddr next = nullptr;
};
std::map<void*, Instance> instances; // by the loader's table, which all handles of one begin with
std::map<void*, std::shared_ptr<Device>> devices;
std::size_t devices_made = 0;

template <typename Handle>
void* table_of(Handle handle) {
    return *reinterpret_cast<void**>(handle);
}

template <typename Handle>
std::shared_ptr<Device> device_of(Handle handle) {
    const std::scoped_lock lock(mutex);
    return devices.at(table_of(handle));
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

// The loader's link to what lies below this layer.
template <typename Link, typename Info>
Link* link_of(const Info* info, VkStructureType type) {
    for (auto* entry = static_cast<const VkBaseInStructure*>(info->pNext); entry != nullptr; entry = entry->pNext) {
        auto* link = reinterpret_cast<const Link*>(entry);
        if (entry->sType == type && link->function == VK_LAYER_LINK_INFO)
            return const_cast<Link*>(link);
    }
    return nullptr;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* callbacks,
                                               VkInstance* instance) {
    auto* link = link_of<VkLayerInstanceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    const PFN_vkGetInstanceProcAddr next = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
    const VkResult result = create(info, callbacks, instance);
    if (result == VK_SUCCESS) {
        const std::scoped_lock lock(mutex);
        instances[table_of(*instance)] = {*instance, next};
    }
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical_device, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* callbacks, VkDevice* handle) {
    auto* link = link_of<VkLayerDeviceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    const PFN_vkGetInstanceProcAddr next_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    const PFN_vkGetDeviceProcAddr next = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    VkInstance instance = VK_NULL_HANDLE;
    {
        const std::scoped_lock lock(mutex);
        instance = instances.at(table_of(physical_device)).handle;
    }
    const auto create = reinterpret_cast<PFN_vkCreateDevice>(next_instance(instance, "vkCreateDevice"));
    const VkResult result = create(physical_device, info, callbacks, handle);
    if (result == VK_SUCCESS) {
        const std::scoped_lock lock(mutex);
        auto device = std::make_shared<Device>();
        device->handle = *handle;
        device->next = next;
        device->lose_at = submission_that_loses(devices_made++);
        devices[table_of(*handle)] = std::move(device);
    }
    return result;
}

bool loss_is_asked_for() {
    const char* file = std::getenv("SUNFLECK_LOSE_FILE");
    return file != nullptr && std::remove(file) == 0;
}

VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* infos, VkFence fence) {
    const auto device = device_of(queue);
    if (!device->lost && (++device->submissions == device->lose_at || loss_is_asked_for())) {
        device->function<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(device->handle);
        device->lost = true;
    }
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->function<PFN_vkQueueSubmit2>("vkQueueSubmit2")(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR* info) {
    const auto device = device_of(queue);
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->function<PFN_vkQueuePresentKHR>("vkQueuePresentKHR")(queue, info);
}

VKAPI_ATTR VkResult VKAPI_CALL acquire(VkDevice handle, VkSwapchainKHR chain, std::uint64_t timeout,
                                       VkSemaphore semaphore, VkFence fence, std::uint32_t* image) {
    const auto device = device_of(handle);
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->function<PFN_vkAcquireNextImageKHR>("vkAcquireNextImageKHR")(handle, chain, timeout,
                                                                                               semaphore, fence, image);
}

VKAPI_ATTR VkResult VKAPI_CALL wait_semaphores(VkDevice handle, const VkSemaphoreWaitInfo* info,
                                               std::uint64_t timeout) {
    const auto device = device_of(handle);
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->function<PFN_vkWaitSemaphores>("vkWaitSemaphores")(handle, info, timeout);
}

VKAPI_ATTR VkResult VKAPI_CALL counter_value(VkDevice handle, VkSemaphore semaphore, std::uint64_t* value) {
    const auto device = device_of(handle);
    return device->lost ? VK_ERROR_DEVICE_LOST
                        : device->function<PFN_vkGetSemaphoreCounterValue>("vkGetSemaphoreCounterValue")(
                              handle, semaphore, value);
}

VKAPI_ATTR VkResult VKAPI_CALL wait_idle(VkDevice handle) {
    const auto device = device_of(handle);
    const VkResult result = device->function<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(handle);
    return device->lost ? VK_ERROR_DEVICE_LOST : result;
}

template <typename Function>
PFN_vkVoidFunction untyped(Function function) {
    return reinterpret_cast<PFN_vkVoidFunction>(function);
}

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

} // namespace

extern "C" {

[[gnu::visibility("default")]] VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetDeviceProcAddr(VkDevice device,
                                                                                            const char* name) {
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return untyped(vkGetDeviceProcAddr);
    if (const PFN_vkVoidFunction own = own_device_function(name); own != nullptr)
        return own;
    return device_of(device)->next(device, name);
}

[[gnu::visibility("default")]] VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetInstanceProcAddr(VkInstance instance,
                                                                                              const char* name) {
    if (std::strcmp(name, "vkGetInstanceProcAddr") == 0)
        return untyped(vkGetInstanceProcAddr);
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return untyped(vkGetDeviceProcAddr);
    if (std::strcmp(name, "vkCreateInstance") == 0)
        return untyped(create_instance);
    if (std::strcmp(name, "vkCreateDevice") == 0)
        return untyped(create_device);
    if (const PFN_vkVoidFunction own = own_device_function(name); own != nullptr)
        return own;
    if (instance == VK_NULL_HANDLE)
        return nullptr;
    const std::scoped_lock lock(mutex);
    return instances.at(table_of(instance)).next(instance, name);
}

} // extern "C"
