// What a Vulkan program has of its own: a device, images, a geometry pass, command buffers in flight. Errors end it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>
#ifdef EMBEDDING_VOLK
#include <volk.h>
#else
#include <vulkan/vulkan.h>
#endif

struct Box {
    std::array<float, 3> place; // of its lowest corner
    float scale;                // side, m
    std::uint32_t surface = 0;
};

struct ImageUse {
    VkImageLayout layout;
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
};

struct TargetImage {
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    ImageUse now{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_NONE, 0};
};

// The corners of a unit cube whose faces look outwards (or inwards), three floats a vertex, and its triangles.
std::vector<float> cube_positions();
std::vector<std::uint32_t> cube_indices(bool inwards);

// What the geometry pass writes.
struct GeometryFormats {
    VkFormat depth = VK_FORMAT_D32_SFLOAT;
    VkFormat normals = VK_FORMAT_R32G32_UINT; // or R16G16B16A16_SFLOAT, or A2B10G10R10_UNORM_PACK32
    bool forward_z = false;                   // depth rises with distance
};

class VulkanProgram {
public:
    static constexpr std::uint32_t width = 160, height = 120;
#ifdef EMBEDDING_VOLK
    static constexpr std::uint32_t version = VK_MAKE_API_VERSION(0, 1, 4, 0);
#else
    static constexpr std::uint32_t version = VK_API_VERSION_1_3;
#endif

    // `features`: fills in what the module needs.
    using Features = std::function<void(VkPhysicalDeviceFeatures*, VkPhysicalDeviceVulkan12Features*,
                                        VkPhysicalDeviceVulkan13Features*)>;
    // `callbacks`: of instance and device.
    VulkanProgram(std::uint32_t frames_in_flight, const Features& features, const GeometryFormats& formats = {},
                  const VkAllocationCallbacks* callbacks = nullptr);
    ~VulkanProgram();
    VulkanProgram(const VulkanProgram&) = delete;

    // One frame: waits until its command buffer is free, calls `before` (CPU), draws the boxes into the images, calls
    // `after` with the command buffer, and submits.
    void frame(const std::vector<Box>& boxes, const std::function<void()>& before,
               const std::function<std::array<float, 16>()>& view_projection,
               const std::function<void(VkCommandBuffer)>& after);
    // Brings an image into another state.
    void transition(VkCommandBuffer commands, TargetImage& image, const ImageUse& use, bool is_depth) const;
    // The texels of an image of halves, four numbers each. Waits.
    std::vector<float> read(TargetImage& image);
    // Whether images of the format can be drawn to as depth, and sampled.
    bool has_depth_format(VkFormat format) const;
    // Mean of the irradiance image's red, green and blue, and whether a number is not finite. Waits.
    std::array<double, 3> mean_irradiance(bool& finite);
    void wait() const {
        vkDeviceWaitIdle(device);
    }

    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    GeometryFormats formats;
    TargetImage depth, normals, surface, irradiance, specular;
    std::uint64_t serial = 0;    // of the frame that is made
    std::uint64_t completed = 0; // finished on the GPU
    int messages = 0;            // of the validation layer

private:
    struct Slot {
        VkCommandBuffer commands = VK_NULL_HANDLE;
        VkFence fence = VK_NULL_HANDLE;
        std::uint64_t serial = 0;
    };
    void make_device(const Features& features);
    TargetImage make_image(VkFormat format, VkImageUsageFlags usage, bool is_depth);
    void make_buffer(const void* data, VkDeviceSize size, VkBufferUsageFlags usage, VkBuffer& buffer,
                     VkDeviceMemory& memory);
    void make_images();
    void make_pipeline();
    void draw(VkCommandBuffer commands, const std::vector<Box>& boxes, const std::array<float, 16>& view_projection);
    std::uint32_t memory_type(std::uint32_t bits, VkMemoryPropertyFlags wanted) const;

    const VkAllocationCallbacks* const callbacks_;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkBuffer vertices_ = VK_NULL_HANDLE, indices_ = VK_NULL_HANDLE;
    VkDeviceMemory vertex_memory_ = VK_NULL_HANDLE, index_memory_ = VK_NULL_HANDLE;
    std::vector<Slot> slots_;
};
