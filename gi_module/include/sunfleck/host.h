// Sunfleck in a foreign Vulkan program: its own device, its own geometry pass, its own frame loop. Plain numbers and
// handles only; nothing of the engine shows here.
//
//     auto context = sunfleck::host::Context::create({instance, physical_device, device, queue, queue_family}).value();
//     mesh = context->add_mesh(...);  instance = context->add_instance(...);  light = context->add_light(...);
//     each frame:
//         context->update(frame);                       // CPU: what moved, which light samples and shadow maps follow
//         ... the host's geometry pass, which writes context->surface_id(instance) for each instance ...
//         context->record(commands, camera, images);    // GPU work into the host's command buffer
//
// A context never submits, waits for the GPU, presents, or owns a swapchain. All functions must be called from one
// thread at a time; update uses all cores. Several contexts, also on different devices, may live in one process.
// Handles stay the host's and must outlive the context; destroy a context only when the GPU has finished its frames.
// World space is right-handed, in metres; matrices are column-major, 16 floats. Strengths are radiometric RGB, linear
// Rec. 709. Functions that can fail return a Result or Status (engine/core/result.h) with a message; none throws.
#pragma once

#include "engine/core/result.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <vulkan/vulkan_core.h>

namespace sunfleck::host {

// What the device must have been created with: Vulkan 1.3 and these features. `missing` tells which of them a physical
// device lacks; `enable` fills the chain's feature bits, all others left as they are (null: skip that struct).
std::vector<std::string> missing_features(VkPhysicalDevice physical_device);
void enable_features(VkPhysicalDeviceFeatures* features, VkPhysicalDeviceVulkan12Features* features12,
                     VkPhysicalDeviceVulkan13Features* features13);

struct VulkanHandles {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE; // that the recorded command buffers are submitted to: graphics and compute
    std::uint32_t queue_family = 0;
};

using Vector3 = std::array<float, 3>;
using Matrix4 = std::array<float, 16>;
inline constexpr Matrix4 identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// Triangles, counter-clockwise from their front. The spans are read before the call returns.
struct MeshData {
    std::span<const float> positions; // three a vertex, m
    std::span<const float> normals;   // three a vertex, unit length; empty: made from the triangles
    std::span<const std::uint32_t> indices;
};

// Light samples lie on fixed geometry, and patches of it keep light maps: moving it makes all of that anew. What moves
// receives light and casts shadows.
enum class Mobility { fixed, moving };

struct InstanceData {
    std::uint32_t mesh = 0;
    Matrix4 transform = identity; // mesh to world
    Mobility mobility = Mobility::fixed;
    Vector3 albedo = {0.8f, 0.8f, 0.8f};   // what reflected light is multiplied by
    Vector3 emission = {0.0f, 0.0f, 0.0f}; // radiance on the front side, W/(sr m2); not zero: an emitter of any shape
};

enum class LightKind { point, spot, directional, sky };

struct LightData {
    LightKind kind = LightKind::point;
    Vector3 strength = {1.0f, 1.0f, 1.0f}; // point, spot: W/sr; directional: W/m2; sky: W/(sr m2)
    Vector3 position = {0.0f, 0.0f, 0.0f};
    Vector3 direction = {0.0f, -1.0f, 0.0f};      // spot, directional: along which light travels
    float inner_angle = 0.3f, outer_angle = 0.6f; // spot, rad
};

struct Camera {
    Vector3 position = {0.0f, 0.0f, 0.0f};
    Vector3 forward = {0.0f, 0.0f, -1.0f};
    Vector3 up = {0.0f, 1.0f, 0.0f};
    float vertical_field_of_view = 0.9f; // rad
};

// The camera's matrix, world to clip: reverse Z without a far plane, y down. The depth that `record` reads must have
// been written with it (near distance 1 cm).
Matrix4 view_projection(const Camera& camera, std::uint32_t width, std::uint32_t height);

// An image of the host: in which state `record` finds it, and in which state it leaves it.
struct ImageState {
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT; // last use before, or first use after
    VkAccessFlags2 access = 0;
};
struct HostImage {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    ImageState entry, exit;
};

// | image      | format               | content                                                         | needs usage |
// |------------|----------------------|-----------------------------------------------------------------|-------------|
// | depth      | D32_SFLOAT           | near / distance along the camera's axis; 0 where nothing is     | sampled     |
// | normals    | R32G32_UINT          | x shading, y geometric normal on the camera's side, each packed | sampled     |
// |            |                      | by pack_normal of engine/core/octahedral.h (GLSL and C++)       |             |
// | surface    | R32_UINT             | surface_id of the instance; 0 where nothing is                  | sampled     |
// | irradiance | R16G16B16A16_SFLOAT  | written: W/m2 without albedo; a surface of albedo A shows the   | storage     |
// |            |                      | radiance A * irradiance / pi                                    |             |
struct FrameImages {
    std::uint32_t width = 0, height = 0; // of all of them
    HostImage depth, normals, surface, irradiance;
};

struct Frame {
    std::uint64_t serial = 1;               // of this frame; rises by one each frame
    std::uint64_t completed_serial = 0;     // all frames up to this one are finished on the GPU
    std::uint32_t map_budget = 0xffffffffu; // shadow maps redrawn in this frame at most
    // Called with the share that is done, 0 to 1, while an update takes long because all is decided anew (the first one
    // of a level); from any thread, but by one at a time. Returning false ends the update with an error; the next one
    // begins again.
    std::function<bool(float)> progress;
};

class Context {
public:
    static Result<std::unique_ptr<Context>> create(const VulkanHandles& handles);
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    // A setting by its name, as `sunfleck info` lists them: set("lights", "600"). Takes effect at the next update.
    Status set(std::string_view name, std::string_view value);

    // Meshes stay until the context goes. Rejects indices out of range and numbers that are not finite.
    Result<std::uint32_t> add_mesh(const MeshData& mesh);
    Result<std::uint32_t> add_instance(const InstanceData& instance);
    Status set_transform(std::uint32_t instance, const Matrix4& transform);
    Status set_surface(std::uint32_t instance, const Vector3& albedo, const Vector3& emission);
    Status remove_instance(std::uint32_t instance);

    Result<std::uint32_t> add_light(const LightData& light);
    Status set_light(std::uint32_t light, const LightData& data);
    Status remove_light(std::uint32_t light);

    // The CPU's part of a frame: follows all changes since the last one.
    Status update(const Frame& frame);
    // What the geometry pass writes for the instance; valid from one update to the next. 0 for no such instance.
    std::uint32_t surface_id(std::uint32_t instance) const;
    // The GPU's part, once after each update, into a command buffer that is being recorded outside of any rendering.
    Status record(VkCommandBuffer commands, const Camera& camera, const FrameImages& images);

private:
    Context();
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace sunfleck::host
