#define VOLK_IMPLEMENTATION
#include "engine/gpu/device.h"

#include "engine/gpu/pipeline_cache.h"

#include "engine/core/log.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <vulkan/vk_enum_string_helper.h>

namespace sunfleck::gpu {

Error vulkan_error(VkResult result, std::string_view doing) {
    std::string message = std::string(doing) + " failed: " + string_VkResult(result);
    if (result == VK_ERROR_DEVICE_LOST)
        message += ". The GPU stopped answering; start the program again, and lower --lights or --size if it repeats";
    else if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        message += ". Not enough memory; lower --size, --lights or shadow_map_resolution";
    else if (result == VK_ERROR_FEATURE_NOT_PRESENT || result == VK_ERROR_EXTENSION_NOT_PRESENT)
        message += ". The driver lacks something that is needed; a newer driver may have it";
    return Error{message};
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

// Each required feature by name, with whether `device` has it (all false without a device).
std::vector<std::pair<std::string, bool>> feature_support(VkPhysicalDevice device) {
    VkPhysicalDeviceFeatures2 has{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan12Features has12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features has13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    has.pNext = &has12;
    has12.pNext = &has13;
    if (device != VK_NULL_HANDLE)
        vkGetPhysicalDeviceFeatures2(device, &has);
    return {
        {"shaderClipDistance", has.features.shaderClipDistance},
        {"depthClamp", has.features.depthClamp},
        {"multiDrawIndirect", has.features.multiDrawIndirect},
        {"drawIndirectFirstInstance", has.features.drawIndirectFirstInstance},
        {"shaderStorageImageWriteWithoutFormat", has.features.shaderStorageImageWriteWithoutFormat},
        {"timelineSemaphore", has12.timelineSemaphore},
        {"hostQueryReset", has12.hostQueryReset},
        {"shaderOutputLayer", has12.shaderOutputLayer},
        {"dynamicRendering", has13.dynamicRendering},
        {"synchronization2", has13.synchronization2},
        {"maintenance4", has13.maintenance4},
    };
}

} // namespace

std::vector<std::string> required_feature_names() {
    std::vector<std::string> names;
    for (const auto& [name, present] : feature_support(VK_NULL_HANDLE))
        names.push_back(name);
    return names;
}

std::vector<std::string> missing_features(VkPhysicalDevice physical_device) {
    std::vector<std::string> missing;
    for (const auto& [name, present] : feature_support(physical_device))
        if (!present)
            missing.push_back(name);
    return missing;
}

VkBool32 Device::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
    static_cast<Device*>(self)->validation_messages_++;
    log_error(std::string("validation: ") + data->pMessage);
    return VK_FALSE;
}

// The steps of making a device; a struct so that they can reach Device's members.
struct DeviceBuilder {
    static bool has_name(const auto& properties, const char* name, auto member) {
        return std::any_of(properties.begin(), properties.end(),
                           [&](const auto& property) { return std::strcmp(property.*member, name) == 0; });
    }

    static Status make_instance(Device& device, const DeviceOptions& options, bool validation) {
        std::uint32_t count = 0;
        vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
        std::vector<VkExtensionProperties> available(count);
        vkEnumerateInstanceExtensionProperties(nullptr, &count, available.data());
        std::vector<const char*> extensions = options.window_extensions;
        device.debug_labels_ =
            has_name(available, VK_EXT_DEBUG_UTILS_EXTENSION_NAME, &VkExtensionProperties::extensionName);
        if (device.debug_labels_)
            extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

        const char* layer = "VK_LAYER_KHRONOS_validation";
        if (validation) {
            vkEnumerateInstanceLayerProperties(&count, nullptr);
            std::vector<VkLayerProperties> layers(count);
            vkEnumerateInstanceLayerProperties(&count, layers.data());
            if (!has_name(layers, layer, &VkLayerProperties::layerName))
                return Error{"validation was asked for, but the Khronos validation layer is not installed (package "
                             "vulkan-validationlayers)"};
        }
        const VkValidationFeatureEnableEXT enables[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
        VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
        features.enabledValidationFeatureCount = 1;
        features.pEnabledValidationFeatures = enables;
        const VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_description(device);
        features.pNext = &messenger;

        VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
        application.pApplicationName = "sunfleck";
        application.apiVersion = VK_API_VERSION_1_3;
        VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
        info.pApplicationInfo = &application;
        info.enabledExtensionCount = std::uint32_t(extensions.size());
        info.ppEnabledExtensionNames = extensions.data();
        if (validation) {
            info.pNext = &features;
            info.enabledLayerCount = 1;
            info.ppEnabledLayerNames = &layer;
        }
        SUNFLECK_VK(vkCreateInstance(&info, nullptr, &device.instance_), "creating a Vulkan 1.3 instance");
        volkLoadInstanceOnly(device.instance_);
        if (validation && device.debug_labels_)
            SUNFLECK_VK(vkCreateDebugUtilsMessengerEXT(device.instance_, &messenger, nullptr, &device.messenger_),
                        "creating the validation messenger");
        return {};
    }

    static VkDebugUtilsMessengerCreateInfoEXT messenger_description(Device& device) {
        VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
        info.messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
        info.messageType =
            VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
        info.pfnUserCallback = Device::on_message;
        info.pUserData = &device;
        return info;
    }

    static std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
        std::uint32_t count = 0;
        vkEnumeratePhysicalDevices(instance, &count, nullptr);
        std::vector<VkPhysicalDevice> devices(count);
        vkEnumeratePhysicalDevices(instance, &count, devices.data());
        const auto rank = [](VkPhysicalDevice device) {
            switch (properties_of(device).deviceType) {
            case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
                return 0;
            case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
                return 1;
            case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
                return 2;
            default:
                return 3;
            }
        };
        std::stable_sort(devices.begin(), devices.end(),
                         [&](VkPhysicalDevice a, VkPhysicalDevice b) { return rank(a) < rank(b); });
        return devices;
    }

    static VkPhysicalDeviceProperties properties_of(VkPhysicalDevice device) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(device, &properties);
        return properties;
    }

    static Status choose_physical_device(Device& device, std::string wanted) {
        if (wanted.empty())
            if (const char* environment = std::getenv("SUNFLECK_DEVICE"))
                wanted = environment;
        const std::vector<VkPhysicalDevice> devices = physical_devices(device.instance_);
        if (devices.empty())
            return Error{"no Vulkan device was found; install a driver (software rendering: package "
                         "mesa-vulkan-drivers)"};
        std::string names;
        for (std::size_t i = 0; i < devices.size(); ++i) {
            const VkPhysicalDeviceProperties properties = properties_of(devices[i]);
            names += (i ? ", " : "") + std::to_string(i) + " '" + properties.deviceName + "'";
            const bool chosen = wanted.empty() || wanted == std::to_string(i) ||
                                (wanted.find_first_not_of("0123456789") != std::string::npos &&
                                 std::string_view(properties.deviceName).find(wanted) != std::string_view::npos);
            if (chosen && device.physical_device_ == VK_NULL_HANDLE)
                device.physical_device_ = devices[i];
        }
        if (device.physical_device_ == VK_NULL_HANDLE)
            return Error{"no Vulkan device matches '" + wanted + "'; there are: " + names};
        return {};
    }

    static Status check_features(const Device& device) {
        const VkPhysicalDeviceProperties properties = properties_of(device.physical_device_);
        if (properties.apiVersion < VK_API_VERSION_1_3)
            return Error{std::string("device '") + properties.deviceName +
                         "' does not support Vulkan 1.3; update its driver or choose another with --device"};
        std::string list;
        for (const std::string& name : missing_features(device.physical_device_))
            list += (list.empty() ? "" : ", ") + name;
        if (!list.empty())
            return Error{std::string("device '") + properties.deviceName + "' lacks " + list +
                         "; choose another device with --device"};
        return {};
    }

    static Status make_device(Device& device, bool window) {
        std::uint32_t count = 0;
        vkGetPhysicalDeviceQueueFamilyProperties(device.physical_device_, &count, nullptr);
        std::vector<VkQueueFamilyProperties> families(count);
        vkGetPhysicalDeviceQueueFamilyProperties(device.physical_device_, &count, families.data());
        const VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
        const auto family = std::find_if(families.begin(), families.end(),
                                         [&](const auto& f) { return (f.queueFlags & needed) == needed; });
        if (family == families.end())
            return Error{"the device has no queue for both graphics and compute"};
        device.queue_family_ = std::uint32_t(family - families.begin());

        const float priority = 1.0f;
        VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
        queue.queueFamilyIndex = device.queue_family_;
        queue.queueCount = 1;
        queue.pQueuePriorities = &priority;
        const RequiredFeatures required;
        const char* swapchain = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
        VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
        info.pNext = &required.features;
        info.queueCreateInfoCount = 1;
        info.pQueueCreateInfos = &queue;
        info.enabledExtensionCount = window ? 1 : 0;
        info.ppEnabledExtensionNames = &swapchain;
        SUNFLECK_VK(vkCreateDevice(device.physical_device_, &info, nullptr, &device.device_),
                    "creating the Vulkan device");
        return {};
    }

    static void read_traits(Device& device) {
        VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
        VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES, &subgroup};
        VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver};
        vkGetPhysicalDeviceProperties2(device.physical_device_, &all);
        const VkPhysicalDeviceLimits& limits = all.properties.limits;
        DeviceTraits& traits = device.traits_;
        traits.name = all.properties.deviceName;
        traits.driver = std::string(driver.driverName) + " " + driver.driverInfo;
        traits.software = all.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
        traits.max_image_layers = limits.maxImageArrayLayers;
        traits.max_texel_elements = limits.maxTexelBufferElements;
        traits.max_storage_range = limits.maxStorageBufferRange;
        traits.max_uniform_range = limits.maxUniformBufferRange;
        traits.max_image_size = std::min(limits.maxImageDimension2D, limits.maxFramebufferWidth);
        traits.uniform_alignment = limits.minUniformBufferOffsetAlignment;
        traits.storage_alignment = limits.minStorageBufferOffsetAlignment;
        traits.texel_alignment = limits.minTexelBufferOffsetAlignment;
        traits.timestamp_period_ns = limits.timestampPeriod;
        traits.timestamps = limits.timestampComputeAndGraphics;
        traits.subgroup_size = subgroup.subgroupSize;
    }

    static void finish(Device& device) {
        volkLoadDeviceTable(&device.vk, device.device_);
        device.vk.vkGetDeviceQueue(device.device_, device.queue_family_, 0, &device.queue_);
        read_traits(device);
        device.memory_ = std::make_unique<Memory>(device);
    }

    static Status start_loader() {
        if (volkGetInstanceVersion() == 0 && volkInitialize() != VK_SUCCESS)
            return Error{"the Vulkan loader (libvulkan.so.1) was not found; install package libvulkan1"};
        return {};
    }
};

Result<std::unique_ptr<Device>> Device::create(const DeviceOptions& options) {
    SUNFLECK_TRY(DeviceBuilder::start_loader());
    std::unique_ptr<Device> device(new Device());
    device->owned_ = true;
    const char* environment = std::getenv("SUNFLECK_VALIDATION");
    const bool validation = options.validation || (environment != nullptr && std::strcmp(environment, "1") == 0);
    SUNFLECK_TRY(DeviceBuilder::make_instance(*device, options, validation));
    SUNFLECK_TRY(DeviceBuilder::choose_physical_device(*device, options.device));
    SUNFLECK_TRY(DeviceBuilder::check_features(*device));
    SUNFLECK_TRY(DeviceBuilder::make_device(*device, !options.window_extensions.empty()));
    DeviceBuilder::finish(*device);
    return device;
}

Result<std::unique_ptr<Device>> Device::adopt(const HostDevice& host) {
    SUNFLECK_TRY(DeviceBuilder::start_loader());
    std::unique_ptr<Device> device(new Device());
    if (host.get_instance_proc_addr != nullptr)
        volkInitializeCustom(host.get_instance_proc_addr);
    volkLoadInstanceOnly(host.instance);
    device->debug_labels_ = vkCmdBeginDebugUtilsLabelEXT != nullptr; // null unless the host enabled the extension
    device->instance_ = host.instance;
    device->physical_device_ = host.physical_device;
    device->device_ = host.device;
    device->queue_family_ = host.queue_family;
    SUNFLECK_TRY(DeviceBuilder::check_features(*device));
    DeviceBuilder::finish(*device);
    device->queue_ = host.queue;
    return device;
}

Device::Device() : pipelines_(std::make_unique<PipelineCache>()) {}

Device::~Device() {
    if (device_ != VK_NULL_HANDLE && owned_ && vk.vkDeviceWaitIdle != nullptr)
        vk.vkDeviceWaitIdle(device_);
    pipelines_.reset();
    memory_.reset();
    if (!owned_)
        return;
    if (device_ != VK_NULL_HANDLE)
        vk.vkDestroyDevice(device_, nullptr);
    if (messenger_ != VK_NULL_HANDLE)
        vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    if (instance_ != VK_NULL_HANDLE)
        vkDestroyInstance(instance_, nullptr);
}

void Device::set_name(VkObjectType type, std::uint64_t handle, const std::string& name) {
    if (!debug_labels_ || vkSetDebugUtilsObjectNameEXT == nullptr)
        return;
    VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    info.objectType = type;
    info.objectHandle = handle;
    info.pObjectName = name.c_str();
    vkSetDebugUtilsObjectNameEXT(device_, &info);
}

Status Device::wait_idle() {
    const std::scoped_lock lock(queue_mutex_);
    SUNFLECK_VK(vk.vkDeviceWaitIdle(device_), "waiting for the GPU");
    return {};
}

Result<std::vector<std::string>> list_devices() {
    SUNFLECK_TRY(DeviceBuilder::start_loader());
    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pApplicationInfo = &application;
    VkInstance instance = VK_NULL_HANDLE;
    SUNFLECK_VK(vkCreateInstance(&info, nullptr, &instance), "creating a Vulkan 1.3 instance");
    volkLoadInstanceOnly(instance);
    std::vector<std::string> names;
    for (VkPhysicalDevice device : DeviceBuilder::physical_devices(instance))
        names.emplace_back(DeviceBuilder::properties_of(device).deviceName);
    vkDestroyInstance(instance, nullptr);
    return names;
}

} // namespace sunfleck::gpu
