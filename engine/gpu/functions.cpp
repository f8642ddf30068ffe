#include "engine/gpu/functions.h"

#include <dlfcn.h>
#include <string>

namespace sunfleck::gpu {
namespace {

// A function that takes what the other takes and does nothing.
template <typename... Arguments>
void do_nothing(void (*&function)(Arguments...)) {
    function = [](Arguments...) {};
}

} // namespace

Result<InstanceFunctions> InstanceFunctions::load(VkInstance instance, PFN_vkGetInstanceProcAddr get) {
    InstanceFunctions table;
#define SUNFLECK_LOAD(name) table.name = reinterpret_cast<PFN_##name>(get(instance, #name));
#define SUNFLECK_CHECK(name)                                                                                           \
    if (table.name == nullptr)                                                                                         \
        return Error{"the Vulkan instance has no " #name                                                               \
                     "; one of Vulkan 1.3 (VkApplicationInfo::apiVersion) is needed",                                  \
                     ErrorCode::unsupported};
    SUNFLECK_INSTANCE_FUNCTIONS(SUNFLECK_LOAD)
    SUNFLECK_INSTANCE_EXTENSION_FUNCTIONS(SUNFLECK_LOAD)
    SUNFLECK_INSTANCE_FUNCTIONS(SUNFLECK_CHECK)
#undef SUNFLECK_CHECK
#undef SUNFLECK_LOAD
    return table;
}

Result<DeviceFunctions> DeviceFunctions::load(VkDevice device, PFN_vkGetDeviceProcAddr get) {
    DeviceFunctions table;
#define SUNFLECK_LOAD(name) table.name = reinterpret_cast<PFN_##name>(get(device, #name));
#define SUNFLECK_CHECK(name)                                                                                           \
    if (table.name == nullptr)                                                                                         \
        return Error{"the Vulkan device has no " #name                                                                 \
                     "; its instance must be of Vulkan 1.3 (VkApplicationInfo::apiVersion), and so must the device",   \
                     ErrorCode::unsupported};
    SUNFLECK_FALLIBLE_DEVICE_FUNCTIONS(SUNFLECK_LOAD)
    SUNFLECK_DESTROYING_DEVICE_FUNCTIONS(SUNFLECK_LOAD)
    SUNFLECK_OTHER_DEVICE_FUNCTIONS(SUNFLECK_LOAD)
    SUNFLECK_SWAPCHAIN_FUNCTIONS(SUNFLECK_LOAD)
    SUNFLECK_FALLIBLE_DEVICE_FUNCTIONS(SUNFLECK_CHECK)
    SUNFLECK_DESTROYING_DEVICE_FUNCTIONS(SUNFLECK_CHECK)
    SUNFLECK_OTHER_DEVICE_FUNCTIONS(SUNFLECK_CHECK)
#undef SUNFLECK_CHECK
#undef SUNFLECK_LOAD
    return table;
}

void DeviceFunctions::abandon() {
#define SUNFLECK_DROP(name) do_nothing(name);
    SUNFLECK_DESTROYING_DEVICE_FUNCTIONS(SUNFLECK_DROP)
#undef SUNFLECK_DROP
    vkDeviceWaitIdle = [](VkDevice) { return VK_ERROR_DEVICE_LOST; };
}

PFN_vkGetInstanceProcAddr loader_functions() {
    // Never closed: drivers have threads and handlers of their own in it.
    static const PFN_vkGetInstanceProcAddr function = [] {
        void* library = nullptr;
        for (const char* name : {"libvulkan.so.1", "libvulkan.so"})
            if (library == nullptr)
                library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
        return library == nullptr
                   ? nullptr
                   : reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
    }();
    return function;
}

} // namespace sunfleck::gpu
