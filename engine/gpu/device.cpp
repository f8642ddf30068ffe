#include "engine/gpu/device.h"

#include "engine/gpu/pipeline_cache.h"

#include "engine/core/log.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace sunfleck::gpu {

namespace {

VkPhysicalDeviceProperties properties_of(const InstanceFunctions& vk, VkPhysicalDevice device) {
    VkPhysicalDeviceProperties properties;
    vk.vkGetPhysicalDeviceProperties(device, &properties);
    return properties;
}

std::vector<VkQueueFamilyProperties> queue_families(const InstanceFunctions& vk, VkPhysicalDevice device) {
    std::uint32_t count = 0;
    vk.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vk.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    return families;
}

bool draws_and_computes(const VkQueueFamilyProperties& family) {
    const VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    return (family.queueFlags & needed) == needed;
}

std::string joined(const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names)
        list += (list.empty() ? "" : ", ") + name;
    return list;
}

// Functions that need no instance.
template <typename Function>
Function global_function(const char* name) {
    return reinterpret_cast<Function>(loader_functions()(nullptr, name));
}

} // namespace

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
        const auto list_extensions =
            global_function<PFN_vkEnumerateInstanceExtensionProperties>("vkEnumerateInstanceExtensionProperties");
        list_extensions(nullptr, &count, nullptr);
        std::vector<VkExtensionProperties> available(count);
        list_extensions(nullptr, &count, available.data());
        std::vector<const char*> extensions = options.window_extensions;
        device.debug_labels_ =
            has_name(available, VK_EXT_DEBUG_UTILS_EXTENSION_NAME, &VkExtensionProperties::extensionName);
        if (device.debug_labels_)
            extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

        const char* layer = "VK_LAYER_KHRONOS_validation";
        if (validation) {
            const auto list_layers =
                global_function<PFN_vkEnumerateInstanceLayerProperties>("vkEnumerateInstanceLayerProperties");
            list_layers(&count, nullptr);
            std::vector<VkLayerProperties> layers(count);
            list_layers(&count, layers.data());
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
        SUNFLECK_VK(global_function<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &device.instance_),
                    "creating a Vulkan 1.3 instance");
        SUNFLECK_ASSIGN(device.instance_vk_, InstanceFunctions::load(device.instance_, loader_functions()));
        if (validation && device.debug_labels_)
            SUNFLECK_VK(device.instance_vk_.vkCreateDebugUtilsMessengerEXT(device.instance_, &messenger, nullptr,
                                                                           &device.messenger_),
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

    static std::vector<VkPhysicalDevice> physical_devices(const InstanceFunctions& vk, VkInstance instance) {
        std::uint32_t count = 0;
        vk.vkEnumeratePhysicalDevices(instance, &count, nullptr);
        std::vector<VkPhysicalDevice> devices(count);
        vk.vkEnumeratePhysicalDevices(instance, &count, devices.data());
        const auto rank = [&vk](VkPhysicalDevice device) {
            switch (properties_of(vk, device).deviceType) {
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

    static Status choose_physical_device(Device& device, std::string wanted) {
        if (wanted.empty())
            if (const char* environment = std::getenv("SUNFLECK_DEVICE"))
                wanted = environment;
        const std::vector<VkPhysicalDevice> devices = physical_devices(device.instance_vk_, device.instance_);
        if (devices.empty())
            return Error{"no Vulkan device was found; install a driver (software rendering: package "
                         "mesa-vulkan-drivers)"};
        std::string names;
        for (std::size_t i = 0; i < devices.size(); ++i) {
            const VkPhysicalDeviceProperties properties = properties_of(device.instance_vk_, devices[i]);
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
        const VkPhysicalDeviceProperties properties = properties_of(device.instance_vk_, device.physical_device_);
        const std::string list = joined(missing_features(device.instance_vk_, device.physical_device_));
        if (list.empty())
            return {};
        return Error{std::string("device '") + properties.deviceName + "' lacks " + list +
                         "; update its driver or choose another device",
                     ErrorCode::unsupported};
    }

    // What a host says of its device.
    static Status check_host(const Device& device, const HostDevice& host) {
        const std::vector<VkQueueFamilyProperties> families =
            queue_families(device.instance_vk_, device.physical_device_);
        if (host.queue_family >= families.size())
            return Error{"there is no queue family " + std::to_string(host.queue_family) + "; the device has " +
                             std::to_string(families.size()),
                         ErrorCode::argument};
        if (!draws_and_computes(families[host.queue_family]))
            return Error{"queue family " + std::to_string(host.queue_family) +
                             " cannot do both graphics and compute, which is needed",
                         ErrorCode::argument};
        if (host.enabled_features == nullptr)
            return {};
        const std::string list = joined(missing_features(*host.enabled_features));
        if (list.empty())
            return {};
        return Error{"the device was created without " + list + ", which is needed", ErrorCode::unsupported};
    }

    static Status make_device(Device& device, bool window) {
        const std::vector<VkQueueFamilyProperties> families =
            queue_families(device.instance_vk_, device.physical_device_);
        const auto family = std::find_if(families.begin(), families.end(), draws_and_computes);
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
        SUNFLECK_VK(device.instance_vk_.vkCreateDevice(device.physical_device_, &info, nullptr, &device.device_),
                    "creating the Vulkan device");
        return {};
    }

    static void read_traits(Device& device) {
        VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
        VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES, &subgroup};
        VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver};
        device.instance_vk_.vkGetPhysicalDeviceProperties2(device.physical_device_, &all);
        const VkPhysicalDeviceLimits& limits = all.properties.limits;
        DeviceTraits& traits = device.traits_;
        traits.name = all.properties.deviceName;
        traits.driver = std::string(driver.driverName) + " " + driver.driverInfo;
        traits.software = all.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
        traits.shares_memory = traits.software || all.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
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

    static Status finish(Device& device) {
        SUNFLECK_ASSIGN(device.vk, DeviceFunctions::load(device.device_, device.instance_vk_.vkGetDeviceProcAddr));
        if (device.queue_ == VK_NULL_HANDLE)
            device.vk.vkGetDeviceQueue(device.device_, device.queue_family_, 0, &device.queue_);
        read_traits(device);
        device.memory_ = std::make_unique<Memory>(device);
        return {};
    }

    static Status start_loader() {
        if (loader_functions() == nullptr)
            return Error{"the Vulkan loader (libvulkan.so.1) was not found; install package libvulkan1",
                         ErrorCode::unsupported};
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
    SUNFLECK_TRY(DeviceBuilder::finish(*device));
    return device;
}

Result<std::unique_ptr<Device>> Device::adopt(const HostDevice& host) {
    PFN_vkGetInstanceProcAddr get = host.get_instance_proc_addr;
    if (get == nullptr) {
        SUNFLECK_TRY(DeviceBuilder::start_loader());
        get = loader_functions();
    }
    std::unique_ptr<Device> device(new Device());
    SUNFLECK_ASSIGN(device->instance_vk_, InstanceFunctions::load(host.instance, get));
    // Null unless the host enabled the extension.
    device->debug_labels_ = device->instance_vk_.vkCmdBeginDebugUtilsLabelEXT != nullptr;
    device->instance_ = host.instance;
    device->physical_device_ = host.physical_device;
    device->device_ = host.device;
    device->queue_family_ = host.queue_family;
    device->queue_ = host.queue;
    SUNFLECK_TRY(DeviceBuilder::check_features(*device));
    SUNFLECK_TRY(DeviceBuilder::check_host(*device, host));
    SUNFLECK_TRY(DeviceBuilder::finish(*device));
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
    if (device_ != VK_NULL_HANDLE && vk.vkDestroyDevice != nullptr)
        vk.vkDestroyDevice(device_, nullptr);
    if (messenger_ != VK_NULL_HANDLE)
        instance_vk_.vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    if (instance_ != VK_NULL_HANDLE && instance_vk_.vkDestroyInstance != nullptr)
        instance_vk_.vkDestroyInstance(instance_, nullptr);
}

void Device::set_name(VkObjectType type, std::uint64_t handle, const std::string& name) {
    if (!debug_labels_ || instance_vk_.vkSetDebugUtilsObjectNameEXT == nullptr)
        return;
    VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    info.objectType = type;
    info.objectHandle = handle;
    info.pObjectName = name.c_str();
    instance_vk_.vkSetDebugUtilsObjectNameEXT(device_, &info);
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
    SUNFLECK_VK(global_function<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance),
                "creating a Vulkan 1.3 instance");
    SUNFLECK_ASSIGN(const InstanceFunctions vk, InstanceFunctions::load(instance, loader_functions()));
    std::vector<std::string> names;
    for (VkPhysicalDevice device : DeviceBuilder::physical_devices(vk, instance))
        names.emplace_back(properties_of(vk, device).deviceName);
    vk.vkDestroyInstance(instance, nullptr);
    return names;
}

} // namespace sunfleck::gpu
