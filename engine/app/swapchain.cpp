#include "engine/app/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>

extern "C" VkResult glfwCreateWindowSurface(VkInstance, GLFWwindow*, const VkAllocationCallbacks*, VkSurfaceKHR*);

namespace sunfleck::app {

Result<std::unique_ptr<Swapchain>> Swapchain::create(gpu::Device& device, Window& window,
                                                     std::uint32_t frames_in_flight) {
    std::unique_ptr<Swapchain> chain(new Swapchain(device, window));
    SUNFLECK_TRY(chain->make_surface());
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    chain->acquired_.resize(frames_in_flight + 1);
    for (VkSemaphore& semaphore : chain->acquired_)
        SUNFLECK_VK(device.vk.vkCreateSemaphore(device.handle(), &info, nullptr, &semaphore), "creating a semaphore");
    return chain;
}

Swapchain::~Swapchain() {
    static_cast<void>(device_.wait_idle());
    destroy_chain();
    for (VkSemaphore semaphore : acquired_)
        device_.vk.vkDestroySemaphore(device_.handle(), semaphore, nullptr);
    if (surface_ != VK_NULL_HANDLE)
        device_.instance_vk().vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
}

Status Swapchain::make_surface() {
    if (surface_ != VK_NULL_HANDLE)
        device_.instance_vk().vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
    surface_ = VK_NULL_HANDLE;
    SUNFLECK_VK(glfwCreateWindowSurface(device_.instance(), window_.handle(), nullptr, &surface_),
                "creating the window's surface");
    VkBool32 supported = VK_FALSE;
    device_.instance_vk().vkGetPhysicalDeviceSurfaceSupportKHR(device_.physical_device(), device_.queue_family(),
                                                               surface_, &supported);
    if (!supported)
        return Error{"device '" + device_.traits().name +
                     "' cannot present to this window; choose another with --device"};
    surface_lost_ = false;
    return {};
}

void Swapchain::set_vertical_sync(bool wait) {
    stale_ = stale_ || wait != vertical_sync_;
    vertical_sync_ = wait;
}

VkPresentModeKHR Swapchain::present_mode() const {
    std::uint32_t count = 0;
    device_.instance_vk().vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical_device(), surface_, &count,
                                                                    nullptr);
    std::vector<VkPresentModeKHR> modes(count);
    device_.instance_vk().vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical_device(), surface_, &count,
                                                                    modes.data());
    if (!vertical_sync_)
        for (const VkPresentModeKHR mode : {VK_PRESENT_MODE_IMMEDIATE_KHR, VK_PRESENT_MODE_MAILBOX_KHR})
            if (std::find(modes.begin(), modes.end(), mode) != modes.end())
                return mode;
    return VK_PRESENT_MODE_FIFO_KHR; // always supported
}

void Swapchain::destroy_chain() {
    for (VkSemaphore semaphore : rendered_)
        device_.vk.vkDestroySemaphore(device_.handle(), semaphore, nullptr);
    rendered_.clear();
    if (chain_ != VK_NULL_HANDLE)
        device_.vk.vkDestroySwapchainKHR(device_.handle(), chain_, nullptr);
    chain_ = VK_NULL_HANDLE;
}

Result<VkSurfaceFormatKHR> Swapchain::choose_format() const {
    std::uint32_t count = 0;
    device_.instance_vk().vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical_device(), surface_, &count, nullptr);
    std::vector<VkSurfaceFormatKHR> formats(count);
    device_.instance_vk().vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical_device(), surface_, &count,
                                                               formats.data());
    if (formats.empty())
        return Error{"the window's surface offers no image format"};
    // The image is already sRGB-encoded: a UNORM format passes it on unchanged.
    for (const VkSurfaceFormatKHR& format : formats)
        if (format.format == VK_FORMAT_B8G8R8A8_UNORM || format.format == VK_FORMAT_R8G8B8A8_UNORM)
            return format;
    return formats[0];
}

Status Swapchain::rebuild() {
    SUNFLECK_TRY(device_.wait_idle());
    destroy_chain();
    if (surface_lost_)
        SUNFLECK_TRY(make_surface());
    VkSurfaceCapabilitiesKHR capabilities;
    SUNFLECK_VK(device_.instance_vk().vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical_device(), surface_,
                                                                                &capabilities),
                "querying the window's surface");
    std::uint32_t width = 0, height = 0;
    window_.size(width, height);
    extent_ = capabilities.currentExtent;
    if (extent_.width == 0xffffffffu)
        extent_ = {std::clamp(width, capabilities.minImageExtent.width, capabilities.maxImageExtent.width),
                   std::clamp(height, capabilities.minImageExtent.height, capabilities.maxImageExtent.height)};
    if (extent_.width == 0 || extent_.height == 0)
        return {}; // minimised
    SUNFLECK_TRY(create_chain(capabilities));
    std::uint32_t count = 0;
    device_.vk.vkGetSwapchainImagesKHR(device_.handle(), chain_, &count, nullptr);
    images_.resize(count);
    device_.vk.vkGetSwapchainImagesKHR(device_.handle(), chain_, &count, images_.data());
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    rendered_.resize(count);
    for (VkSemaphore& rendered : rendered_)
        SUNFLECK_VK(device_.vk.vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &rendered),
                    "creating a semaphore");
    stale_ = false;
    return {};
}

Status Swapchain::create_chain(const VkSurfaceCapabilitiesKHR& capabilities) {
    SUNFLECK_ASSIGN(const VkSurfaceFormatKHR format, choose_format());
    format_ = format.format;
    VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface_;
    info.minImageCount = std::max(capabilities.minImageCount, 3u);
    if (capabilities.maxImageCount > 0)
        info.minImageCount = std::min(info.minImageCount, capabilities.maxImageCount);
    info.imageFormat = format.format;
    info.imageColorSpace = format.colorSpace;
    info.imageExtent = extent_;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.preTransform = capabilities.currentTransform;
    info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    info.presentMode = present_mode();
    info.clipped = VK_TRUE;
    SUNFLECK_VK(device_.vk.vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &chain_), "creating the swapchain");
    return {};
}

Result<bool> Swapchain::acquire(std::uint64_t serial) {
    std::uint32_t width = 0, height = 0;
    window_.size(width, height);
    if (width == 0 || height == 0)
        return false;
    if (stale_ || width != extent_.width || height != extent_.height)
        SUNFLECK_TRY(rebuild());
    if (chain_ == VK_NULL_HANDLE)
        return false;
    current_.acquired = acquired_[serial % acquired_.size()];
    const VkResult result = device_.vk.vkAcquireNextImageKHR(device_.handle(), chain_, UINT64_MAX, current_.acquired,
                                                             VK_NULL_HANDLE, &image_);
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_ERROR_SURFACE_LOST_KHR) {
        stale_ = true;
        surface_lost_ = result == VK_ERROR_SURFACE_LOST_KHR;
        return false;
    }
    if (result == VK_SUBOPTIMAL_KHR) // still presentable; recreated next time
        stale_ = true;
    else
        SUNFLECK_VK(result, "acquiring the window's next image");
    current_.rendered = rendered_[image_];
    return true;
}

Status Swapchain::record_blit(VkCommandBuffer commands, gpu::FrameResources& resources, const gpu::Image& source) {
    gpu::FrameGraph graph(&device_);
    const gpu::ResourceId from = graph.import_image(source);
    gpu::ImportedImage target;
    target.name = "window image";
    target.image = images_[image_];
    target.description.format = format_;
    // All commands wait for the acquire semaphore; this orders the layout transition after it.
    target.entry.write_stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    target.has_exit = true;
    target.exit = gpu::Usage::present;
    const gpu::ResourceId to = graph.import_host_image(target);
    graph.add_pass("to window")
        .read(from, gpu::Usage::blit_source)
        .write(to, gpu::Usage::blit_destination)
        .execute([&](gpu::PassContext& context) -> Status {
            VkImageBlit region{};
            region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            region.srcOffsets[1] = {int(source.description().width), int(source.description().height), 1};
            region.dstOffsets[1] = {int(extent_.width), int(extent_.height), 1};
            context.device.vk.vkCmdBlitImage(context.commands, source.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                             images_[image_], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region,
                                             VK_FILTER_LINEAR);
            return {};
        });
    SUNFLECK_TRY(graph.compile());
    return graph.execute(commands, resources, nullptr);
}

Status Swapchain::present() {
    VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &current_.rendered;
    info.swapchainCount = 1;
    info.pSwapchains = &chain_;
    info.pImageIndices = &image_;
    const VkResult result = [&] {
        const std::scoped_lock lock(device_.queue_mutex());
        return device_.vk.vkQueuePresentKHR(device_.queue(), &info);
    }();
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR || result == VK_ERROR_SURFACE_LOST_KHR) {
        stale_ = true;
        surface_lost_ = surface_lost_ || result == VK_ERROR_SURFACE_LOST_KHR;
        return {};
    }
    SUNFLECK_VK(result, "presenting the image");
    return {};
}

} // namespace sunfleck::app
