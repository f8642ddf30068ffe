// A host whose Vulkan functions are volk's global pointers, which have the names of the loader's own functions.
#define VOLK_IMPLEMENTATION
#include <volk.h>

#include <cstdio>
#include <sunfleck/host.h>

namespace host = sunfleck::host;

namespace {

bool fails(VkResult result, const char* what) {
    if (result != VK_SUCCESS)
        std::printf("volk host: %s: %d\n", what, int(result));
    return result != VK_SUCCESS;
}

VkDevice make_device(VkPhysicalDevice physical_device) {
    VkPhysicalDeviceVulkan13Features features13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &features13};
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12};
    host::enable_features(&features.features, &features12, &features13);
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueCount = 1; // of family 0, which software devices have for everything
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features};
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    VkDevice device = VK_NULL_HANDLE;
    fails(vkCreateDevice(physical_device, &info, nullptr, &device), "vkCreateDevice");
    return device;
}

} // namespace

int main() {
    if (fails(volkInitialize(), "volkInitialize"))
        return 1;
    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pApplicationInfo = &application;
    VkInstance instance = VK_NULL_HANDLE;
    if (fails(vkCreateInstance(&info, nullptr, &instance), "vkCreateInstance"))
        return 1;
    volkLoadInstance(instance);
    std::uint32_t count = 1;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    if (vkEnumeratePhysicalDevices(instance, &count, &physical_device) < 0 || count == 0)
        return 1;
    const VkDevice device = make_device(physical_device);
    if (device == VK_NULL_HANDLE)
        return 1;
    volkLoadDevice(device);
    host::VulkanHandles handles{instance, physical_device, device};
    vkGetDeviceQueue(device, 0, 0, &handles.queue);
    handles.get_instance_proc_addr = vkGetInstanceProcAddr;
    bool right = false;
    {
        auto context = host::Context::create(handles);
        right = context && context.value()->set("lights", "100") && context.value()->clear();
        std::printf("volk host: %s\n", right     ? "a context is made"
                                       : context ? "a call failed"
                                                 : context.error().message.c_str());
    }
    vkDestroyDevice(device, nullptr);
    vkDestroyInstance(instance, nullptr);
    return right ? 0 : 1;
}
