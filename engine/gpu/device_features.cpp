// What a device must have, whether one has it, and what Vulkan's results mean.
#include "engine/gpu/device.h"

#include <vulkan/vk_enum_string_helper.h>

namespace sunfleck::gpu {

Error vulkan_error(VkResult result, std::string_view doing) {
    const std::string message = std::string(doing) + " failed: " + string_VkResult(result);
    switch (result) {
    case VK_ERROR_DEVICE_LOST:
        return Error{
            message +
                ". The GPU stopped answering; start the program again, and lower --lights or --size if it repeats",
            ErrorCode::device_lost};
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_FRAGMENTED_POOL:
    case VK_ERROR_FRAGMENTATION:
    case VK_ERROR_MEMORY_MAP_FAILED:
    case VK_ERROR_TOO_MANY_OBJECTS:
        return Error{message + ". Not enough memory; lower --size, --lights or shadow_map_resolution",
                     ErrorCode::memory};
    case VK_ERROR_FEATURE_NOT_PRESENT:
    case VK_ERROR_EXTENSION_NOT_PRESENT:
    case VK_ERROR_LAYER_NOT_PRESENT:
    case VK_ERROR_INCOMPATIBLE_DRIVER:
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
        return Error{message + ". The driver lacks something that is needed; a newer driver may have it",
                     ErrorCode::unsupported};
    default:
        return Error{message};
    }
}

RequiredFeatures::RequiredFeatures() {
    features.features.shaderClipDistance = VK_TRUE;
    features.features.depthClamp = VK_TRUE;
    features.features.multiDrawIndirect = VK_TRUE;
    features.features.drawIndirectFirstInstance = VK_TRUE;
    features.features.shaderStorageImageWriteWithoutFormat = VK_TRUE;
    features12.timelineSemaphore = VK_TRUE;
    features12.hostQueryReset = VK_TRUE;
    features12.shaderOutputLayer = VK_TRUE;
    features13.dynamicRendering = VK_TRUE;
    features13.synchronization2 = VK_TRUE;
    features13.maintenance4 = VK_TRUE; // glslang writes LocalSizeId for Vulkan 1.3
    features.pNext = &features12;
    features12.pNext = &features13;
}

namespace {

struct Features {
    VkPhysicalDeviceFeatures core{};
    VkPhysicalDeviceVulkan12Features of12{};
    VkPhysicalDeviceVulkan13Features of13{};
};

// Each required feature by name, with whether it is there.
std::vector<std::pair<std::string, bool>> feature_support(const Features& has) {
    return {
        {"shaderClipDistance", has.core.shaderClipDistance},
        {"depthClamp", has.core.depthClamp},
        {"multiDrawIndirect", has.core.multiDrawIndirect},
        {"drawIndirectFirstInstance", has.core.drawIndirectFirstInstance},
        {"shaderStorageImageWriteWithoutFormat", has.core.shaderStorageImageWriteWithoutFormat},
        {"timelineSemaphore", has.of12.timelineSemaphore},
        {"hostQueryReset", has.of12.hostQueryReset},
        {"shaderOutputLayer", has.of12.shaderOutputLayer},
        {"dynamicRendering", has.of13.dynamicRendering},
        {"synchronization2", has.of13.synchronization2},
        {"maintenance4", has.of13.maintenance4},
    };
}

std::vector<std::string> missing_of(const Features& has) {
    std::vector<std::string> missing;
    for (const auto& [name, present] : feature_support(has))
        if (!present)
            missing.push_back(name);
    return missing;
}

// Adds what one struct of a chain enables; features have structs of their own beside those of Vulkan 1.2 and 1.3.
void add_features(const VkBaseInStructure& in, Features& features) {
    const void* chained = &in;
    switch (in.sType) {
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES:
        features.of12 = *static_cast<const VkPhysicalDeviceVulkan12Features*>(chained);
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES:
        features.of13 = *static_cast<const VkPhysicalDeviceVulkan13Features*>(chained);
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES:
        features.of12.timelineSemaphore =
            static_cast<const VkPhysicalDeviceTimelineSemaphoreFeatures*>(chained)->timelineSemaphore;
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_HOST_QUERY_RESET_FEATURES:
        features.of12.hostQueryReset =
            static_cast<const VkPhysicalDeviceHostQueryResetFeatures*>(chained)->hostQueryReset;
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES:
        features.of13.dynamicRendering =
            static_cast<const VkPhysicalDeviceDynamicRenderingFeatures*>(chained)->dynamicRendering;
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES:
        features.of13.synchronization2 =
            static_cast<const VkPhysicalDeviceSynchronization2Features*>(chained)->synchronization2;
        break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_FEATURES:
        features.of13.maintenance4 = static_cast<const VkPhysicalDeviceMaintenance4Features*>(chained)->maintenance4;
        break;
    default:
        break;
    }
}

} // namespace

std::vector<std::string> required_feature_names() {
    return missing_of({});
}

std::vector<std::string> missing_features(const VkPhysicalDeviceFeatures2& features) {
    Features all;
    all.core = features.features;
    for (auto next = static_cast<const VkBaseInStructure*>(features.pNext); next != nullptr; next = next->pNext)
        add_features(*next, all);
    return missing_of(all);
}

std::vector<std::string> missing_features(const InstanceFunctions& vk, VkPhysicalDevice physical_device) {
    // Drivers of older versions do not know the structs that are asked for below.
    VkPhysicalDeviceProperties properties;
    vk.vkGetPhysicalDeviceProperties(physical_device, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_3)
        return {"Vulkan 1.3"};
    VkPhysicalDeviceFeatures2 has{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan12Features has12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features has13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    has.pNext = &has12;
    has12.pNext = &has13;
    vk.vkGetPhysicalDeviceFeatures2(physical_device, &has);
    return missing_of({has.features, has12, has13});
}

} // namespace sunfleck::gpu
