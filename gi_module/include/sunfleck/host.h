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
// A context never submits, waits for the GPU, presents, or owns a swapchain.
//
// Threads. A context may be used from any thread, but by one at a time; update uses all cores. What calls a context
// while it is within another call, from another thread or from a callback (progress, log), is refused (argument), or
// returns nothing (surface_id, read_sensor, statistics); abandon() then takes effect when the other call ends. Only
// destroying it there is undefined. surface_id and read_sensor, which only look something up, may run on any number of
// threads at once. Contexts share nothing: any number of them, on one device or on several, may be used at the same
// time by threads of their own. None uses a queue or a command pool; those stay under the host's own locks.
//
// Ownership. Handles stay the host's. They must be valid (no library can tell a destroyed or foreign handle from a good
// one; null ones are refused) and outlive the context. A context may be destroyed once the GPU has finished the frames
// that it recorded; abandon() is for one whose device is gone. What a context makes of Vulkan's objects it makes
// without VkAllocationCallbacks, whatever the host uses for its own.
//
// Errors. Functions that can fail return a Result or Status (engine/core/result.h): a message for people and an
// ErrorCode for programs. None throws, whatever a callback of the host's does.
//   argument     The message names the argument, its value and what is allowed. Nothing has changed.
//   memory       The CPU's or the GPU's; the message names the call or its step. What the call was to add or change is
//                as before. An update or record that failed may be followed by the next update, which computes what
//                follows from the scene again.
//   device_lost  Only destroying or abandoning the context makes sense.
//   unsupported  The driver, the instance or the device lacks what missing_features names.
//   stopped      Frame::progress returned false; the next update begins again.
//   other        What should not happen: an exception of a callback's or a library's. Afterwards as after `memory`.
//
// Units. World space is right-handed, in metres; matrices are column-major, 16 floats. Strengths are radiometric RGB,
// linear Rec. 709. Coordinates and strengths may be as large as 2^60: squares of them still fit into a float.
//
// The package's include folder is all that a compiler needs; engine/core/octahedral.h lies in its folder sunfleck/,
// which shader compilers are given as an include folder, too.
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

// What the device must have been created with: an instance and a device of Vulkan 1.3 or later
// (VkApplicationInfo::apiVersion) and these features. No extension is needed; with VK_EXT_debug_utils, objects and
// passes have names. `missing_features` tells what a physical device lacks, "Vulkan 1.3" among it, before anything else
// exists; `get_instance_proc_addr` is the host's, or null for the loader's. `enable_features` sets the chain's feature
// bits, all others left as they are (null: skip that struct).
Result<std::vector<std::string>> missing_features(VkInstance instance, VkPhysicalDevice physical_device,
                                                  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr);
void enable_features(VkPhysicalDeviceFeatures* features, VkPhysicalDeviceVulkan12Features* features12,
                     VkPhysicalDeviceVulkan13Features* features13);

// How much memory the process may take, in bytes; 0, the default: three quarters of what is free when the module first
// asks (of the machine, or of the control group), and what the process has by then. What would go over it is refused
// before it is taken (ErrorCode::memory), with a message that says what asked for how much. Of all contexts; from any
// thread.
void set_memory_limit(std::uint64_t bytes);

struct VulkanHandles {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE; // that the recorded command buffers are submitted to
    std::uint32_t queue_family = 0; // of that queue: graphics and compute
    // Where every function of Vulkan is loaded from; null: libvulkan.so.1, loaded at run time.
    PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
    // What vkCreateDevice was given, with its chain. Vulkan cannot be asked which features a device was created with:
    // with this, a context refuses a device that lacks one by its name; without it, what happens then is undefined.
    const VkPhysicalDeviceFeatures2* enabled_features = nullptr;
};

enum class LogLevel { information, warning, error };
// What a context has to say beside errors (a light that is left out, say), from the threads that use it.
using LogSink = std::function<void(LogLevel, std::string_view)>;

using Vector3 = std::array<float, 3>;
using Matrix4 = std::array<float, 16>;
inline constexpr Matrix4 identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// Triangles, counter-clockwise from their front. Fronts and backs of everything receive light and block it, whatever
// the host's cull mode: a host that shows backs (VK_CULL_MODE_NONE) writes the normal on the camera's side for them;
// one that culls them just never shows that light. The spans are read before the call returns.
struct MeshData {
    std::span<const float> positions; // three a vertex, m
    std::span<const float> normals;   // three a vertex, not zero; empty: made from the triangles
    std::span<const std::uint32_t> indices;
    std::span<const float> texture_coordinates; // two a vertex, u to the right and v down the texture; may be empty
};

// Light samples lie on fixed geometry, and patches of it keep light maps: moving it computes all of that again. What
// moves receives light and casts shadows.
enum class Mobility { fixed, moving };

// RGBA of 8 bits, sRGB, rows from the top; repeats outside of 0 to 1. Read before the call returns.
struct TextureData {
    std::span<const std::uint8_t> pixels; // four a texel; empty: no texture
    std::uint32_t width = 0, height = 0;
};

// A surface that instances share.
struct MaterialData {
    Vector3 albedo = {0.8f, 0.8f, 0.8f};     // what reflected light is multiplied by, 0 to 1
    Vector3 emission = {0.0f, 0.0f, 0.0f};   // radiance on the front side, W/(sr m2); not zero: an emitter of any shape
    float metallic = 0.0f, roughness = 1.0f; // as in glTF; for specular light (setting `specular`)
    TextureData albedo_texture;              // multiplies albedo, where the mesh has texture coordinates
};

inline constexpr std::uint32_t no_material = 0xffffffffu;

struct InstanceData {
    std::uint32_t mesh = 0;
    Matrix4 transform = identity; // mesh to world; its last row is 0 0 0 1
    Mobility mobility = Mobility::fixed;
    Vector3 albedo = {0.8f, 0.8f, 0.8f}; // this and the next: as in MaterialData, for an instance without a material
    Vector3 emission = {0.0f, 0.0f, 0.0f};
    std::uint32_t material = no_material; // from add_material
};

enum class LightKind { point, spot, directional, sky };

struct LightData {
    LightKind kind = LightKind::point;
    Vector3 strength = {1.0f, 1.0f, 1.0f}; // point, spot: W/sr; directional: W/m2; sky: W/(sr m2)
    Vector3 position = {0.0f, 0.0f, 0.0f};
    Vector3 direction = {0.0f, -1.0f, 0.0f};      // spot, directional: along which light travels; of any length
    float inner_angle = 0.3f, outer_angle = 0.6f; // spot, rad from its direction: 0 <= inner <= outer <= pi/2
};

// A place where a game asks how much light arrives, direct and reflected.
struct SensorData {
    Vector3 position = {0.0f, 0.0f, 0.0f};
    Vector3 normal = {0.0f, 1.0f, 0.0f};    // of the side that light arrives on; any length but 0
    Vector3 threshold = {1.0f, 1.0f, 1.0f}; // W/m2 that matter; a colour of 0 does not
};
struct SensorValue {
    Vector3 irradiance = {0.0f, 0.0f, 0.0f}; // W/m2
    float share = 0.0f;                      // the least, over the colours that matter, of the threshold
    bool open = false;                       // from a share of 1 until one below 0.8
};

// Forward and up have any length, but different directions.
struct Camera {
    Vector3 position = {0.0f, 0.0f, 0.0f};
    Vector3 forward = {0.0f, 0.0f, -1.0f};
    Vector3 up = {0.0f, 1.0f, 0.0f};
    float vertical_field_of_view = 0.9f; // rad, between 0 and pi
};

// The camera's matrix, world to clip: reverse Z without a far plane, y down. The depth that `record` reads together
// with a Camera must have been written with it (near distance 1 cm).
Matrix4 view_projection(const Camera& camera, std::uint32_t width, std::uint32_t height);

// A camera by the host's own matrices, of any perspective projection: forward or reverse Z, near and far planes
// anywhere (also at infinity), off-centre, jittered. Everything follows from the two, which must be the ones that depth
// was written with, jitter included; a host that has only their product may give it as view_to_clip. Depth is the
// viewport's 0 to 1, cleared to the far plane's value: 1 with forward Z, 0 with reverse Z.
struct View {
    Matrix4 world_to_view = identity;
    Matrix4 view_to_clip = identity;
    bool clip_y_up = false; // clip y runs up the picture: the host's viewport has a negative height
};

// An image of the host: in which state `record` finds it, and in which state it leaves it. `record` has barriers of its
// own on both sides, so the host needs none. `entry` is the last use before: of an input, the layout that it lies in,
// and the stages and accesses that wrote it, so that they are waited for and made visible (accesses that only read may
// be given, too); of an output, the last stages that use it, and the undefined layout, because nothing of it is kept.
// `exit` is the first use after: the layout that it shall lie in, and the stages and accesses that then may read or
// write it.
//   layout         One of Vulkan 1.3, not the swapchain's, that an image of its format may have; where the format has
//                  stencil, too, one for both aspects. Which the image's usage allows is the host's affair.
//   stages         Of Vulkan 1.3, of mesh shaders and of ray tracing; only of features that the device was made with.
//   access         Each is of one of the stages, by Vulkan's table; without stages, none or those of memory.
struct ImageState {
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    VkAccessFlags2 access = 0;
};
struct HostImage {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE; // of the whole image; of depth and stencil formats: the depth aspect
    ImageState entry, exit;
    VkFormat format = VK_FORMAT_UNDEFINED; // undefined: the first one in the list below
};

// The images of one frame. Inputs need VK_IMAGE_USAGE_SAMPLED_BIT, outputs VK_IMAGE_USAGE_STORAGE_BIT; `record` reads
// and writes them in compute shaders. No image may be given twice.
//
//   depth               D32_SFLOAT, D16_UNORM, X8_D24_UNORM_PACK32, D24_UNORM_S8_UINT, D32_SFLOAT_S8_UINT, R32_SFLOAT.
//                       With a Camera: near / distance along its axis, 0 where nothing is. With a View: what it writes.
//   normals             World space. R32G32_UINT: x shading, y geometric normal on the camera's side, each packed by
//                       pack_normal of engine/core/octahedral.h (GLSL and C++). Or the shading normal alone:
//                       A2B10G10R10_UNORM_PACK32, A2R10G10B10_UNORM_PACK32, R8G8B8A8_UNORM, R16G16B16A16_UNORM, holding
//                       0.5 * normal + 0.5; R16G16B16A16_SFLOAT, R32G32B32A32_SFLOAT, R16G16B16A16_SNORM,
//                       R8G8B8A8_SNORM, holding the normal.
//   surface             R32_UINT or R16_UINT. surface_id of the instance; 0 where nothing is.
//   irradiance          R16G16B16A16_SFLOAT or R32G32B32A32_SFLOAT. Output, W/m2 without albedo: a surface of albedo A
//                       shows the radiance A * irradiance / pi.
// Optional (no image: not there):
//   geometric_normals   R16G16B16A16_SFLOAT and all other formats of normals but R32G32_UINT. The triangle's normal,
//                       from either side. Without it, geometric normals are derived from depth, which is rougher at
//                       silhouettes and with D16.
//   motion              R16G16_SFLOAT or R32G32_SFLOAT. Place in the previous frame minus place in this one; 1 is the
//                       picture's width or height.
//   metallic_roughness  R8G8_UNORM, R8G8B8A8_UNORM or R16G16_SFLOAT. x: metallic, y: roughness, as in glTF.
//   specular            R16G16B16A16_SFLOAT or R32G32B32A32_SFLOAT. Output, with the setting `specular=gloss`; else 0.
//                       rgb: radiance that metals reflect, W/(sr m2); a: share of the diffuse base's light that leaves
//                       it: the camera sees albedo * irradiance / pi * a + rgb. Where nothing is glossy, all are 0.
// Motion is read by no technique yet: giving it costs no more than the change to the layout at exit.
struct FrameImages {
    std::uint32_t width = 0, height = 0; // of all of them, in fact: images cannot be asked for their size
    HostImage depth, normals, surface, irradiance;
    HostImage geometric_normals, motion, metallic_roughness, specular;
};

struct Frame {
    // Of this frame: greater than those of all frames that were recorded, or that of the frame that was dropped.
    std::uint64_t serial = 1;           // 2^63 at most
    std::uint64_t completed_serial = 0; // all frames up to this one are finished on the GPU; never falls
    // Shadow maps redrawn in this frame at most. A light sample without one yet shines only where nothing is in the
    // way. With a budget, light is baked in small portions, too, over more frames.
    std::uint32_t map_budget = 0xffffffffu;
    // Thousands of light samples times texels that are evaluated in this frame at most to refine the light of what
    // stands still, where the setting `baked_samples` is not 0: 4,000 take 15 to 30 ms of two CPU cores.
    std::uint32_t refinement_budget = 0xffffffffu;
    // Called with the share that is done, 0 to 1, while an update takes long because everything has to be computed (the
    // first one of a level); from any thread, but by one at a time. Returning false ends the update with an error; the
    // next one begins again.
    std::function<bool(float)> progress;
    // The commands of the frame recorded last were never submitted. What they would have uploaded and drawn is recorded
    // once more.
    bool dropped = false;
};

// A number about the last frames, by its name.
struct Statistic {
    std::string name;
    double value = 0.0;
    std::string unit; // "" for what is counted
};
struct Statistics {
    std::uint64_t gpu_serial = 0;      // the frame that gpu_passes is about: the newest that is complete, 0 for none
    std::vector<Statistic> gpu_passes; // ms; passes of one name are summed. Empty where the device has no timestamps
    std::vector<Statistic> cpu_stages; // ms of the last update
    std::vector<Statistic> counters;   // of the last frame
    std::vector<Statistic> memory;     // device memory, MiB by use
};

class Context {
public:
    // `log` stays the context's; without one, messages go to standard error.
    static Result<std::unique_ptr<Context>> create(const VulkanHandles& handles, LogSink log = {});
    ~Context();
    // The device is lost, or is destroyed before the context: from then on nothing of Vulkan is called, every function
    // that can fail does, and destroying the context frees the CPU's part.
    void abandon();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    // A setting by its name, as `sunfleck info` lists them: set("lights", "600"). Takes effect at the next update.
    Status set(std::string_view name, std::string_view value);

    // Numbers of meshes, materials, instances, lights and sensors rise from 0 and are not used again until clear().
    Result<std::uint32_t> add_mesh(const MeshData& mesh);
    // Refused while an instance has it. Its memory is free after the next update.
    Status remove_mesh(std::uint32_t mesh);
    // Materials and their textures stay until clear(), those that set_material replaces, too. A changed material
    // changes all instances that have it.
    Result<std::uint32_t> add_material(const MaterialData& material);
    Status set_material(std::uint32_t material, const MaterialData& data);
    Result<std::uint32_t> add_instance(const InstanceData& instance);
    Status set_transform(std::uint32_t instance, const Matrix4& transform);
    // From then on the instance has a surface of its own, without a material.
    Status set_surface(std::uint32_t instance, const Vector3& albedo, const Vector3& emission);
    Status remove_instance(std::uint32_t instance);

    Result<std::uint32_t> add_light(const LightData& light);
    Status set_light(std::uint32_t light, const LightData& data);
    Status remove_light(std::uint32_t light);

    // Sensors are measured by rays on the CPU at the host's fixed step, so that readings depend on the scene and the
    // number of steps alone: on no frame, device, setting of pictures or number of threads. A step looks at what has
    // moved, traces about so many rays as set("sensor_rays", ...) says, and none where nothing moves. New sensors are
    // measured at once; after a change a reading is complete half a second of steps of 1/60 s later with the default of
    // 2,048 rays for 8 sensors. The error is about 2 % of a threshold that the light is near to.
    Result<std::uint32_t> add_sensor(const SensorData& sensor);
    Status set_sensor(std::uint32_t sensor, const SensorData& data);
    Status remove_sensor(std::uint32_t sensor);
    Status step_sensors();
    // Of the last step; all zero before the first, for no such sensor, and until the next step after an error of
    // memory.
    SensorValue read_sensor(std::uint32_t sensor) const;

    // As if the context had just been made: no mesh, material, instance, light or sensor. Settings and serials stay.
    Status clear();

    // The CPU's part of a frame: follows all changes since the last one.
    Status update(const Frame& frame);
    // What the geometry pass writes for the instance; valid from one update to the next. 0 for no such instance.
    std::uint32_t surface_id(std::uint32_t instance) const;
    // The GPU's part, once after each update, into a command buffer that is being recorded outside of any rendering.
    // Arguments that are refused leave nothing recorded and may be followed by another try or another update. After any
    // other error the command buffer must not be submitted. What is bound afterwards (pipelines, descriptor sets, push
    // constants, vertex and index buffers, viewport and other dynamic state, for graphics and compute) is undefined; no
    // query, rendering or debug label is left open.
    Status record(VkCommandBuffer commands, const Camera& camera, const FrameImages& images);
    Status record(VkCommandBuffer commands, const View& view, const FrameImages& images);

    // Times, counters and memory: see Statistics. Waits for nothing; empty after abandon().
    Statistics statistics() const;

private:
    Context();
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace sunfleck::host
