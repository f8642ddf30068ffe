// A Vulkan layer that writes when each picture was handed to the window: a line for each vkQueuePresentKHR, in
// nanoseconds of CLOCK_MONOTONIC, to the file that SUNFLECK_PRESENT_TIMES names. It measures programs as they are,
// those of earlier commits, too.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <mutex>
#include <vulkan/vk_layer.h>

namespace {

std::mutex mutex;
// By the loader's table, which all handles of one begin with.
std::map<void*, std::pair<VkInstance, PFN_vkGetInstanceProcAddr>> instances;
std::map<void*, std::pair<VkDevice, PFN_vkGetDeviceProcAddr>> devices;

template <typename Handle>
void* table_of(Handle handle) {
    return *reinterpret_cast<void**>(handle);
}

template <typename Function>
PFN_vkVoidFunction untyped(Function function) {
    return reinterpret_cast<PFN_vkVoidFunction>(function);
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
    const std::scoped_lock lock(mutex);
    if (result == VK_SUCCESS)
        instances[table_of(*instance)] = {*instance, next};
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical_device, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* callbacks, VkDevice* device) {
    auto* link = link_of<VkLayerDeviceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    const PFN_vkGetInstanceProcAddr next_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    const PFN_vkGetDeviceProcAddr next = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const std::scoped_lock lock(mutex);
    const VkInstance instance = instances.at(table_of(physical_device)).first;
    const auto create = reinterpret_cast<PFN_vkCreateDevice>(next_instance(instance, "vkCreateDevice"));
    const VkResult result = create(physical_device, info, callbacks, device);
    if (result == VK_SUCCESS)
        devices[table_of(*device)] = {*device, next};
    return result;
}

void write_time() {
    static std::FILE* file = [] {
        const char* path = std::getenv("SUNFLECK_PRESENT_TIMES");
        std::FILE* opened = path != nullptr ? std::fopen(path, "w") : nullptr;
        if (opened != nullptr)
            std::setvbuf(opened, nullptr, _IOLBF, 1 << 12);
        return opened;
    }();
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (file != nullptr)
        std::fprintf(file, "%lld\n", 1000000000LL * now.tv_sec + now.tv_nsec);
}

VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR* info) {
    PFN_vkQueuePresentKHR next = nullptr;
    {
        const std::scoped_lock lock(mutex);
        const auto& [device, function] = devices.at(table_of(queue));
        next = reinterpret_cast<PFN_vkQueuePresentKHR>(function(device, "vkQueuePresentKHR"));
    }
    const VkResult result = next(queue, info);
    write_time();
    return result;
}

} // namespace

extern "C" {

[[gnu::visibility("default")]] VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetDeviceProcAddr(VkDevice device,
                                                                                            const char* name) {
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return untyped(vkGetDeviceProcAddr);
    if (std::strcmp(name, "vkQueuePresentKHR") == 0)
        return untyped(present);
    const std::scoped_lock lock(mutex);
    return devices.at(table_of(device)).second(device, name);
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
    if (std::strcmp(name, "vkQueuePresentKHR") == 0)
        return untyped(present);
    if (instance == VK_NULL_HANDLE)
        return nullptr;
    const std::scoped_lock lock(mutex);
    return instances.at(table_of(instance)).second(instance, name);
}

} // extern "C"
