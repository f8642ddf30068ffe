// What a Vulkan layer under a program as it is consists of, whatever it does. A layer is one source that includes this
// once and defines the two functions declared first.
#pragma once

#include <cstring>
#include <map>
#include <mutex>
#include <utility>
#include <vulkan/vk_layer.h>

namespace sunfleck::layer {

// The layer's own function of that name, or null: what lies below is called.
[[gnu::visibility("hidden")]] PFN_vkVoidFunction own_device_function(const char* name);
// The program has made a device.
[[gnu::visibility("hidden")]] void device_made(VkDevice device);

template <typename Handle, typename NextFunction>
struct Below {
    Handle handle = VK_NULL_HANDLE;
    NextFunction next = nullptr;

    template <typename Function>
    Function function(const char* name) const {
        return reinterpret_cast<Function>(next(handle, name));
    }
};
using Instance = Below<VkInstance, PFN_vkGetInstanceProcAddr>;
using Device = Below<VkDevice, PFN_vkGetDeviceProcAddr>;

// By the loader's table, which all handles of one begin with. Static: each layer of a process has its own.
static std::mutex mutex;
static std::map<void*, Instance> instances;
static std::map<void*, Device> devices;

template <typename Handle>
void* table_of(Handle handle) {
    return *reinterpret_cast<void**>(handle);
}

// What lies below the device of a handle.
template <typename Handle>
Device device_of(Handle handle) {
    const std::scoped_lock lock(mutex);
    return devices.at(table_of(handle));
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

static VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info,
                                                      const VkAllocationCallbacks* callbacks, VkInstance* instance) {
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

static VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical_device, const VkDeviceCreateInfo* info,
                                                    const VkAllocationCallbacks* callbacks, VkDevice* device) {
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
    const VkResult result = create(physical_device, info, callbacks, device);
    if (result != VK_SUCCESS)
        return result;
    {
        const std::scoped_lock lock(mutex);
        devices[table_of(*device)] = {*device, next};
    }
    device_made(*device);
    return result;
}

} // namespace sunfleck::layer

extern "C" {

[[gnu::visibility("default")]] VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetDeviceProcAddr(VkDevice device,
                                                                                            const char* name) {
    using namespace sunfleck::layer;
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return untyped(vkGetDeviceProcAddr);
    if (const PFN_vkVoidFunction own = own_device_function(name); own != nullptr)
        return own;
    return device_of(device).next(device, name);
}

[[gnu::visibility("default")]] VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetInstanceProcAddr(VkInstance instance,
                                                                                              const char* name) {
    using namespace sunfleck::layer;
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
