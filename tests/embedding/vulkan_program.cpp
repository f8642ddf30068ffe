#include "vulkan_program.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {
#include "geometry_float_frag.h"
#include "geometry_frag.h"
#include "geometry_vert.h"

void require(VkResult result, const char* what) {
    if (result == VK_SUCCESS)
        return;
    std::fprintf(stderr, "%s failed (%d)\n", what, int(result));
    std::exit(1);
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* program) {
    ++static_cast<VulkanProgram*>(program)->messages;
    std::fprintf(stderr, "validation: %s\n", data->pMessage);
    return VK_FALSE;
}

VkShaderModule make_module(VkDevice device, const std::uint32_t* words, std::size_t bytes) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = bytes;
    info.pCode = words;
    VkShaderModule module = VK_NULL_HANDLE;
    require(vkCreateShaderModule(device, &info, nullptr, &module), "vkCreateShaderModule");
    return module;
}

struct Constants {
    std::array<float, 16> view_projection;
    float place_scale[4];
    std::uint32_t surface;
};

} // namespace

std::vector<float> cube_positions() {
    std::vector<float> positions; // four corners for each of six faces
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            for (int corner = 0; corner < 4; ++corner) {
                float p[3];
                p[axis] = float(side);
                p[(axis + 1) % 3] = float(corner == 1 || corner == 2);
                p[(axis + 2) % 3] = float(corner >= 2);
                positions.insert(positions.end(), {p[0], p[1], p[2]});
            }
    return positions;
}

std::vector<std::uint32_t> cube_indices(bool inwards) {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t face = 0; face < 6; ++face) {
        const bool turn = (face % 2 == 0) != inwards; // the far side of an axis already faces outwards
        for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u})
            indices.push_back(face * 4 + (turn ? (4 - k) % 4 : k));
    }
    return indices;
}

VulkanProgram::VulkanProgram(std::uint32_t frames_in_flight, const Features& features,
                             const GeometryFormats& geometry_formats, const VkAllocationCallbacks* callbacks)
    : formats(geometry_formats), callbacks_(callbacks) {
    make_device(features);
    make_images();
    const std::vector<float> positions = cube_positions();
    const std::vector<std::uint32_t> indices = cube_indices(false);
    make_buffer(positions.data(), positions.size() * sizeof(float), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, vertices_,
                vertex_memory_);
    make_buffer(indices.data(), indices.size() * sizeof(std::uint32_t), VK_BUFFER_USAGE_INDEX_BUFFER_BIT, indices_,
                index_memory_);
    make_pipeline();
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    require(vkCreateCommandPool(device, &pool, nullptr, &pool_), "vkCreateCommandPool");
    slots_.resize(frames_in_flight);
    for (Slot& slot : slots_) {
        VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool_,
                                         VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
        require(vkAllocateCommandBuffers(device, &info, &slot.commands), "vkAllocateCommandBuffers");
        VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, VK_FENCE_CREATE_SIGNALED_BIT};
        require(vkCreateFence(device, &fence, nullptr, &slot.fence), "vkCreateFence");
    }
}

void VulkanProgram::make_images() {
    const VkImageUsageFlags colour =
        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const VkImageUsageFlags output = colour | VK_IMAGE_USAGE_STORAGE_BIT;
    depth = make_image(formats.depth, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT, true);
    normals = make_image(formats.normals, colour, false);
    surface = make_image(VK_FORMAT_R32_UINT, colour, false);
    irradiance = make_image(VK_FORMAT_R16G16B16A16_SFLOAT, output, false);
    specular = make_image(VK_FORMAT_R16G16B16A16_SFLOAT, output, false);
}

VulkanProgram::~VulkanProgram() {
    vkDeviceWaitIdle(device);
    for (const Slot& slot : slots_)
        vkDestroyFence(device, slot.fence, nullptr);
    vkDestroyCommandPool(device, pool_, nullptr);
    vkDestroyPipeline(device, pipeline_, nullptr);
    vkDestroyPipelineLayout(device, layout_, nullptr);
    for (const VkBuffer buffer : {vertices_, indices_})
        vkDestroyBuffer(device, buffer, nullptr);
    for (const TargetImage* image : {&depth, &normals, &surface, &irradiance, &specular}) {
        vkDestroyImageView(device, image->view, nullptr);
        vkDestroyImage(device, image->image, nullptr);
        vkFreeMemory(device, image->memory, nullptr);
    }
    vkFreeMemory(device, vertex_memory_, nullptr);
    vkFreeMemory(device, index_memory_, nullptr);
    vkDestroyDevice(device, callbacks_);
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance, messenger_, nullptr);
    vkDestroyInstance(instance, callbacks_);
}

void VulkanProgram::make_device(const Features& features) {
#ifdef EMBEDDING_VOLK
    require(volkInitialize(), "volkInitialize");
#endif
    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.apiVersion = version;
    const char* layer = "VK_LAYER_KHRONOS_validation";
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT validation{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, nullptr, 1, &enabled};
    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, &validation};
    info.pApplicationInfo = &application;
    info.enabledLayerCount = info.enabledExtensionCount = 1;
    info.ppEnabledLayerNames = &layer;
    info.ppEnabledExtensionNames = &extension;
    require(vkCreateInstance(&info, callbacks_, &instance), "vkCreateInstance");
#ifdef EMBEDDING_VOLK
    volkLoadInstance(instance);
#endif
    VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = on_message;
    messenger.pUserData = this;
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT"));
    require(create(instance, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
    std::uint32_t count = 1;
    vkEnumeratePhysicalDevices(instance, &count, &physical_device);
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queues{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
    VkPhysicalDeviceVulkan13Features features13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &features13};
    VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12};
    features13.dynamicRendering = features13.synchronization2 = VK_TRUE; // its own needs
    features(&all.features, &features12, &features13);
    VkDeviceCreateInfo device_info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &all};
    device_info.queueCreateInfoCount = 1;
    device_info.pQueueCreateInfos = &queues;
    require(vkCreateDevice(physical_device, &device_info, callbacks_, &device), "vkCreateDevice");
#ifdef EMBEDDING_VOLK
    volkLoadDevice(device);
#endif
    vkGetDeviceQueue(device, 0, 0, &queue);
}

std::uint32_t VulkanProgram::memory_type(std::uint32_t bits, VkMemoryPropertyFlags wanted) const {
    VkPhysicalDeviceMemoryProperties properties;
    vkGetPhysicalDeviceMemoryProperties(physical_device, &properties);
    for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i)
        if ((bits >> i & 1u) && (properties.memoryTypes[i].propertyFlags & wanted) == wanted)
            return i;
    return 0;
}

TargetImage VulkanProgram::make_image(VkFormat format, VkImageUsageFlags usage, bool is_depth) {
    TargetImage target;
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent = {width, height, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = usage;
    require(vkCreateImage(device, &info, nullptr, &target.image), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device, target.image, &needs);
    const VkMemoryAllocateInfo memory{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size,
                                      memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)};
    require(vkAllocateMemory(device, &memory, nullptr, &target.memory), "vkAllocateMemory");
    vkBindImageMemory(device, target.image, target.memory, 0);
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = target.image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange = {VkImageAspectFlags(is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 1,
                             0, 1};
    require(vkCreateImageView(device, &view, nullptr, &target.view), "vkCreateImageView");
    return target;
}

void VulkanProgram::make_buffer(const void* data, VkDeviceSize size, VkBufferUsageFlags usage, VkBuffer& buffer,
                                VkDeviceMemory& memory) {
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = size;
    info.usage = usage;
    require(vkCreateBuffer(device, &info, nullptr, &buffer), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device, buffer, &needs);
    const VkMemoryAllocateInfo allocation{
        VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size,
        memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)};
    require(vkAllocateMemory(device, &allocation, nullptr, &memory), "vkAllocateMemory");
    vkBindBufferMemory(device, buffer, memory, 0);
    if (data == nullptr)
        return;
    void* mapped = nullptr;
    require(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    std::memcpy(mapped, data, size);
    vkUnmapMemory(device, memory);
}

void VulkanProgram::make_pipeline() {
    const VkShaderStageFlags both = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    const VkPushConstantRange range{both, 0, sizeof(Constants)};
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &range;
    require(vkCreatePipelineLayout(device, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
    const bool packed = formats.normals == VK_FORMAT_R32G32_UINT;
    const VkShaderModule modules[] = {make_module(device, geometry_vert, sizeof geometry_vert),
                                      packed ? make_module(device, geometry_frag, sizeof geometry_frag)
                                             : make_module(device, geometry_float_frag, sizeof geometry_float_frag)};
    const VkBool32 unsigned_format = formats.normals == VK_FORMAT_A2B10G10R10_UNORM_PACK32;
    const VkSpecializationMapEntry entry{0, 0, sizeof unsigned_format};
    const VkSpecializationInfo specialization{1, &entry, sizeof unsigned_format, &unsigned_format};
    VkPipelineShaderStageCreateInfo stages[2] = {{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO},
                                                 {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO}};
    for (int i = 0; i < 2; ++i) {
        stages[i].stage = i == 0 ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_FRAGMENT_BIT;
        stages[i].module = modules[i];
        stages[i].pName = "main";
        stages[i].pSpecializationInfo = i == 1 && !packed ? &specialization : nullptr;
    }
    const VkVertexInputBindingDescription binding{0, 12, VK_VERTEX_INPUT_RATE_VERTEX};
    const VkVertexInputAttributeDescription attribute{0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0};
    VkPipelineVertexInputStateCreateInfo input{
        VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO, nullptr, 0, 1, &binding, 1, &attribute};
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
                                                    nullptr, 0, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkViewport viewport{0, 0, float(width), float(height), 0, 1};
    const VkRect2D scissor{{0, 0}, {width, height}};
    VkPipelineViewportStateCreateInfo viewports{
        VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, nullptr, 0, 1, &viewport, 1, &scissor};
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.lineWidth = 1.0f;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth_state{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth_state.depthTestEnable = depth_state.depthWriteEnable = VK_TRUE;
    depth_state.depthCompareOp = formats.forward_z ? VK_COMPARE_OP_LESS : VK_COMPARE_OP_GREATER;
    VkPipelineColorBlendAttachmentState blend[2] = {};
    blend[0].colorWriteMask = blend[1].colorWriteMask = 15;
    VkPipelineColorBlendStateCreateInfo blending{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blending.attachmentCount = 2;
    blending.pAttachments = blend;
    const VkFormat colours[] = {formats.normals, VK_FORMAT_R32_UINT};
    VkPipelineRenderingCreateInfo rendering{
        VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO, nullptr, 0, 2, colours, formats.depth};
    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewports;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth_state;
    info.pColorBlendState = &blending;
    info.layout = layout_;
    require(vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_),
            "vkCreateGraphicsPipelines");
    for (const VkShaderModule module : modules)
        vkDestroyShaderModule(device, module, nullptr);
}

void VulkanProgram::transition(VkCommandBuffer commands, TargetImage& image, const ImageUse& use, bool is_depth) const {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = image.now.stages;
    barrier.srcAccessMask = image.now.access;
    barrier.dstStageMask = use.stages;
    barrier.dstAccessMask = use.access;
    barrier.oldLayout = image.now.layout;
    barrier.newLayout = use.layout;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image.image;
    barrier.subresourceRange = {VkImageAspectFlags(is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0,
                                1, 0, 1};
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
    image.now = use;
}

void VulkanProgram::draw(VkCommandBuffer commands, const std::vector<Box>& boxes,
                         const std::array<float, 16>& view_projection) {
    const ImageUse target{VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
    transition(commands, normals, target, false);
    transition(commands, surface, target, false);
    transition(commands, depth,
               {VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT},
               true);
    VkRenderingAttachmentInfo colours[2] = {{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO},
                                            {VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO}};
    VkRenderingAttachmentInfo depths{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    for (VkRenderingAttachmentInfo* attachment : {&colours[0], &colours[1], &depths}) {
        attachment->loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
        attachment->storeOp = VK_ATTACHMENT_STORE_OP_STORE;
        attachment->imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    }
    colours[0].imageView = normals.view;
    colours[1].imageView = surface.view;
    depths.imageView = depth.view;
    depths.clearValue.depthStencil.depth = formats.forward_z ? 1.0f : 0.0f;
    depths.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea.extent = {width, height};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = 2;
    rendering.pColorAttachments = colours;
    rendering.pDepthAttachment = &depths;
    vkCmdBeginRendering(commands, &rendering);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(commands, 0, 1, &vertices_, &offset);
    vkCmdBindIndexBuffer(commands, indices_, 0, VK_INDEX_TYPE_UINT32);
    for (const Box& box : boxes) {
        const Constants constants{view_projection, {box.place[0], box.place[1], box.place[2], box.scale}, box.surface};
        vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                           sizeof constants, &constants);
        vkCmdDrawIndexed(commands, 36, 1, 0, 0, 0);
    }
    vkCmdEndRendering(commands);
}

void VulkanProgram::frame(const std::vector<Box>& boxes, const std::function<void()>& before,
                          const std::function<std::array<float, 16>()>& view_projection,
                          const std::function<void(VkCommandBuffer)>& after) {
    Slot& slot = slots_[serial % slots_.size()];
    require(vkWaitForFences(device, 1, &slot.fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    vkResetFences(device, 1, &slot.fence);
    completed = std::max(completed, slot.serial);
    slot.serial = ++serial;
    before();
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr,
                                   VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    require(vkBeginCommandBuffer(slot.commands, &begin), "vkBeginCommandBuffer");
    draw(slot.commands, boxes, view_projection());
    after(slot.commands);
    require(vkEndCommandBuffer(slot.commands), "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, slot.commands, 0};
    VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &commands;
    require(vkQueueSubmit2(queue, 1, &submit, slot.fence), "vkQueueSubmit2");
}
