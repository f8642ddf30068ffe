// The Vulkan functions in use, in tables: one for each instance and one for each device, loaded through the loader's
// vkGetInstanceProcAddr or the host's. There are no global function pointers: devices of different instances, loaders
// and layers live side by side in one process, and a program that uses volk, another loader or none links this one,
// too.
#pragma once

#include "engine/gpu/vulkan.h"

// What belongs to an instance. The last group is null unless its extension is enabled.
#define SUNFLECK_INSTANCE_FUNCTIONS(X)                                                                                 \
    X(vkDestroyInstance)                                                                                               \
    X(vkEnumeratePhysicalDevices)                                                                                      \
    X(vkGetPhysicalDeviceFeatures2)                                                                                    \
    X(vkGetPhysicalDeviceProperties)                                                                                   \
    X(vkGetPhysicalDeviceProperties2)                                                                                  \
    X(vkGetPhysicalDeviceMemoryProperties)                                                                             \
    X(vkGetPhysicalDeviceQueueFamilyProperties)                                                                        \
    X(vkCreateDevice)                                                                                                  \
    X(vkGetDeviceProcAddr)
#define SUNFLECK_INSTANCE_EXTENSION_FUNCTIONS(X)                                                                       \
    X(vkCreateDebugUtilsMessengerEXT)                                                                                  \
    X(vkDestroyDebugUtilsMessengerEXT)                                                                                 \
    X(vkSetDebugUtilsObjectNameEXT)                                                                                    \
    X(vkCmdBeginDebugUtilsLabelEXT)                                                                                    \
    X(vkCmdEndDebugUtilsLabelEXT)                                                                                      \
    X(vkDestroySurfaceKHR)                                                                                             \
    X(vkGetPhysicalDeviceSurfaceSupportKHR)                                                                            \
    X(vkGetPhysicalDeviceSurfaceCapabilitiesKHR)                                                                       \
    X(vkGetPhysicalDeviceSurfaceFormatsKHR)                                                                            \
    X(vkGetPhysicalDeviceSurfacePresentModesKHR)

// What belongs to a device. Those that can fail stand first: tests make each of them fail at each place.
#define SUNFLECK_FALLIBLE_DEVICE_FUNCTIONS(X)                                                                          \
    X(vkAllocateCommandBuffers)                                                                                        \
    X(vkAllocateDescriptorSets)                                                                                        \
    X(vkAllocateMemory)                                                                                                \
    X(vkBeginCommandBuffer)                                                                                            \
    X(vkBindBufferMemory)                                                                                              \
    X(vkBindImageMemory)                                                                                               \
    X(vkCreateBuffer)                                                                                                  \
    X(vkCreateBufferView)                                                                                              \
    X(vkCreateCommandPool)                                                                                             \
    X(vkCreateComputePipelines)                                                                                        \
    X(vkCreateDescriptorPool)                                                                                          \
    X(vkCreateDescriptorSetLayout)                                                                                     \
    X(vkCreateGraphicsPipelines)                                                                                       \
    X(vkCreateImage)                                                                                                   \
    X(vkCreateImageView)                                                                                               \
    X(vkCreatePipelineLayout)                                                                                          \
    X(vkCreateQueryPool)                                                                                               \
    X(vkCreateSampler)                                                                                                 \
    X(vkCreateSemaphore)                                                                                               \
    X(vkCreateShaderModule)                                                                                            \
    X(vkDeviceWaitIdle)                                                                                                \
    X(vkEndCommandBuffer)                                                                                              \
    X(vkGetQueryPoolResults)                                                                                           \
    X(vkGetSemaphoreCounterValue)                                                                                      \
    X(vkMapMemory)                                                                                                     \
    X(vkQueueSubmit2)                                                                                                  \
    X(vkResetCommandPool)                                                                                              \
    X(vkResetDescriptorPool)                                                                                           \
    X(vkWaitSemaphores)
// That give back what was made.
#define SUNFLECK_DESTROYING_DEVICE_FUNCTIONS(X)                                                                        \
    X(vkDestroyBuffer)                                                                                                 \
    X(vkDestroyBufferView)                                                                                             \
    X(vkDestroyCommandPool)                                                                                            \
    X(vkDestroyDescriptorPool)                                                                                         \
    X(vkDestroyDescriptorSetLayout)                                                                                    \
    X(vkDestroyImage)                                                                                                  \
    X(vkDestroyImageView)                                                                                              \
    X(vkDestroyPipeline)                                                                                               \
    X(vkDestroyPipelineLayout)                                                                                         \
    X(vkDestroyQueryPool)                                                                                              \
    X(vkDestroySampler)                                                                                                \
    X(vkDestroySemaphore)                                                                                              \
    X(vkDestroyShaderModule)                                                                                           \
    X(vkFreeMemory)
#define SUNFLECK_OTHER_DEVICE_FUNCTIONS(X)                                                                             \
    X(vkDestroyDevice)                                                                                                 \
    X(vkCmdBeginRendering)                                                                                             \
    X(vkCmdBindDescriptorSets)                                                                                         \
    X(vkCmdBindIndexBuffer)                                                                                            \
    X(vkCmdBindPipeline)                                                                                               \
    X(vkCmdBindVertexBuffers)                                                                                          \
    X(vkCmdBlitImage)                                                                                                  \
    X(vkCmdClearColorImage)                                                                                            \
    X(vkCmdCopyBuffer)                                                                                                 \
    X(vkCmdCopyBufferToImage)                                                                                          \
    X(vkCmdCopyImageToBuffer)                                                                                          \
    X(vkCmdDispatch)                                                                                                   \
    X(vkCmdDispatchIndirect)                                                                                           \
    X(vkCmdDraw)                                                                                                       \
    X(vkCmdDrawIndexed)                                                                                                \
    X(vkCmdDrawIndexedIndirect)                                                                                        \
    X(vkCmdEndRendering)                                                                                               \
    X(vkCmdFillBuffer)                                                                                                 \
    X(vkCmdPipelineBarrier2)                                                                                           \
    X(vkCmdPushConstants)                                                                                              \
    X(vkCmdSetCullMode)                                                                                                \
    X(vkCmdSetFrontFace)                                                                                               \
    X(vkCmdSetScissor)                                                                                                 \
    X(vkCmdSetViewport)                                                                                                \
    X(vkCmdWriteTimestamp2)                                                                                            \
    X(vkGetBufferMemoryRequirements)                                                                                   \
    X(vkGetDeviceQueue)                                                                                                \
    X(vkGetImageMemoryRequirements)                                                                                    \
    X(vkResetQueryPool)                                                                                                \
    X(vkUpdateDescriptorSets)
// Null unless VK_KHR_swapchain is enabled.
#define SUNFLECK_SWAPCHAIN_FUNCTIONS(X)                                                                                \
    X(vkCreateSwapchainKHR)                                                                                            \
    X(vkDestroySwapchainKHR)                                                                                           \
    X(vkGetSwapchainImagesKHR)                                                                                         \
    X(vkAcquireNextImageKHR)                                                                                           \
    X(vkQueuePresentKHR)

namespace sunfleck::gpu {

#define SUNFLECK_DECLARE_FUNCTION(name) PFN_##name name = nullptr;

struct InstanceFunctions {
    SUNFLECK_INSTANCE_FUNCTIONS(SUNFLECK_DECLARE_FUNCTION)
    SUNFLECK_INSTANCE_EXTENSION_FUNCTIONS(SUNFLECK_DECLARE_FUNCTION)

    // An error names the first function that is missing.
    static Result<InstanceFunctions> load(VkInstance instance, PFN_vkGetInstanceProcAddr get);
};

struct DeviceFunctions {
    SUNFLECK_FALLIBLE_DEVICE_FUNCTIONS(SUNFLECK_DECLARE_FUNCTION)
    SUNFLECK_DESTROYING_DEVICE_FUNCTIONS(SUNFLECK_DECLARE_FUNCTION)
    SUNFLECK_OTHER_DEVICE_FUNCTIONS(SUNFLECK_DECLARE_FUNCTION)
    SUNFLECK_SWAPCHAIN_FUNCTIONS(SUNFLECK_DECLARE_FUNCTION)

    static Result<DeviceFunctions> load(VkDevice device, PFN_vkGetDeviceProcAddr get);
    // From then on nothing that is destroyed or waited for calls the device: it is gone, and its objects with it.
    void abandon();
};

#undef SUNFLECK_DECLARE_FUNCTION

// The loader's vkGetInstanceProcAddr, loaded at the first call; null if there is no loader.
PFN_vkGetInstanceProcAddr loader_functions();

} // namespace sunfleck::gpu
