// A Vulkan 1.3 device: made here, or the host's.
#pragma once

#include "engine/gpu/functions.h"
#include "engine/gpu/memory.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace sunfleck::gpu {

struct DeviceOptions {
    // Part of a device's name, or its number in `sunfleck info`; empty takes SUNFLECK_DEVICE from the environment, and
    // without that the first discrete, then integrated, then other device.
    std::string device;
    // Khronos validation with synchronisation checks; also switched on by SUNFLECK_VALIDATION=1.
    bool validation = false;
    // Instance extensions that the window system needs; with any, VK_KHR_swapchain is enabled too.
    std::vector<const char*> window_extensions;
};

// A device that the host made. All handles stay the host's and must outlive the Device. The features listed in
// required_features() must be enabled on it.
struct HostDevice {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    std::uint32_t queue_family = 0;
    PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;  // null: the loader's
    const VkPhysicalDeviceFeatures2* enabled_features = nullptr; // null: they cannot be checked
};

// What a device can do beyond the floor, and its limits that algorithms here depend on.
struct DeviceTraits {
    std::string name;
    std::string driver;
    bool software = false;      // a CPU device: kernels take the shapes that suit it
    bool shares_memory = false; // what it takes is missing elsewhere: a CPU device, or a GPU without memory of its own
    std::uint32_t max_image_layers = 0;
    std::uint64_t max_texel_elements = 0;
    std::uint64_t max_storage_range = 0;
    std::uint64_t max_uniform_range = 0;
    std::uint32_t max_image_size = 0;
    std::uint64_t uniform_alignment = 256;
    std::uint64_t storage_alignment = 256;
    std::uint64_t texel_alignment = 256;
    float timestamp_period_ns = 1.0f;
    bool timestamps = false;
    std::uint32_t subgroup_size = 0;
};

class PipelineCache;

class Device {
public:
    static Result<std::unique_ptr<Device>> create(const DeviceOptions& options);
    static Result<std::unique_ptr<Device>> adopt(const HostDevice& host);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkDevice handle() const { return device_; }
    VkInstance instance() const { return instance_; }
    VkPhysicalDevice physical_device() const { return physical_device_; }
    VkQueue queue() const { return queue_; }
    std::uint32_t queue_family() const { return queue_family_; }
    const DeviceTraits& traits() const { return traits_; }
    Memory& memory() { return *memory_; }
    // Pipelines that were made on this device, whichever store asked for them (pipeline_cache.h).
    PipelineCache& pipelines() { return *pipelines_; }

    // Functions of this device. Tests replace entries to make calls fail on purpose.
    DeviceFunctions vk;
    const InstanceFunctions& instance_vk() const { return instance_vk_; }

    // Names an object for validation messages and captures. No effect without VK_EXT_debug_utils.
    void set_name(VkObjectType type, std::uint64_t handle, const std::string& name);
    bool debug_labels() const { return debug_labels_; }

    // Messages of the validation layers so far (warnings and errors).
    int validation_messages() const { return validation_messages_.load(); }

    // Held around every use of the queue, so that threads may have submissions of their own (a level that loads, say).
    // Of an adopted device the host sees to that itself.
    std::mutex& queue_mutex() { return queue_mutex_; }

    // Blocks until the queue is idle. For shutdown and resizing, never within a frame.
    Status wait_idle();

    // The device is gone, or about to go, with all that was made on it: what is destroyed from then on frees the CPU's
    // memory and calls nothing of Vulkan.
    void abandon() { vk.abandon(); }

private:
    Device();
    friend struct DeviceBuilder;
    static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                     VkDebugUtilsMessageTypeFlagsEXT type,
                                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);

    bool owned_ = false;
    bool debug_labels_ = false;
    InstanceFunctions instance_vk_;
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    std::mutex queue_mutex_;
    std::uint32_t queue_family_ = 0;
    DeviceTraits traits_;
    std::unique_ptr<Memory> memory_;
    std::unique_ptr<PipelineCache> pipelines_;
    std::atomic<int> validation_messages_{0};
};

// Names of devices, in the order in which numbers select them.
Result<std::vector<std::string>> list_devices();

// The features of Vulkan 1.3 that this project needs, as a chain to hand to vkCreateDevice. Lives as long as the
// object.
struct RequiredFeatures {
    RequiredFeatures();
    RequiredFeatures(const RequiredFeatures&) = delete;
    RequiredFeatures& operator=(const RequiredFeatures&) = delete;
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features features13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
};

// Names of the features that this project needs.
std::vector<std::string> required_feature_names();
// Names of required features that `features` (a chain, as for vkCreateDevice) leaves out.
std::vector<std::string> missing_features(const VkPhysicalDeviceFeatures2& features);
// Names of what a physical device lacks, "Vulkan 1.3" among them; empty if it will do.
std::vector<std::string> missing_features(const InstanceFunctions& vk, VkPhysicalDevice physical_device);

} // namespace sunfleck::gpu
