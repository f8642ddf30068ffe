// What a host::Context holds: the module with a registry, device and frame graph of its own.
#pragma once

#include "engine/gpu/vulkan.h" // before any other header that includes Vulkan's

#include "engine/scene/camera_projection.h"
#include "gi_module/g_buffer/conversion.h"
#include "gi_module/light_sensors/light_sensors.h"
#include "gi_module/system.h"
#include "sunfleck/host.h"

#include <optional>

namespace sunfleck::host {

inline vec3 vector_of(const Vector3& v) {
    return {v[0], v[1], v[2]};
}

inline bool is_strength(const Vector3& v) {
    const vec3 value = vector_of(v);
    return is_finite(value) && value.x >= 0.0f && value.y >= 0.0f && value.z >= 0.0f;
}

struct Context::Implementation {
    struct SharedMaterial {
        scene::Material material;
        std::optional<scene::MaterialTextures> textures;
    };

    std::unique_ptr<gpu::Device> device;
    gpu::ShaderLibrary shaders;
    std::unique_ptr<gpu::PipelineStore> pipelines;
    std::unique_ptr<gpu::FrameResources> resources;
    std::unique_ptr<gpu::Timers> timers;
    std::unique_ptr<gpu::FrameGraph> graph;
    std::unique_ptr<scene::GpuScene> gpu_scene;
    std::unique_ptr<raytrace::RayScene> rays;
    std::unique_ptr<gi::System> system;
    std::unique_ptr<gi::GBufferConversion> conversion;
    std::unique_ptr<gi::LightSensors> sensors; // null until there is one
    gi::Settings settings;
    gi::SensorSettings sensor_settings;
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::ChangeTracker change_tracker{scene::ChangeTracker::Space::of_scene};
    scene::SceneSpace space; // of the last update
    scene::TextureStore textures;
    std::vector<SharedMaterial> materials;
    std::vector<ecs::Entity> instances, lights;    // null: removed
    std::vector<ecs::Entity> sensor_entities;      // the same
    std::vector<std::uint32_t> instance_materials; // no_material: a surface of its own
    std::vector<std::uint32_t> surface_ids;        // by instance
    std::optional<mat4> view_projection;           // of the last frame recorded
    bool updated = false;
    bool unrecorded = false; // the last update was not followed by a frame
    bool broken = false;     // recording ended halfway: its commands will never be executed

    Result<ecs::Entity> find(const std::vector<ecs::Entity>& list, std::uint32_t number, const char* what) const {
        if (number >= list.size() || list[number].is_null())
            return Error{std::string("there is no ") + what + " " + std::to_string(number)};
        return list[number];
    }
    void place(ecs::Entity entity, const mat4& matrix) {
        // Hosts give whole matrices, so the hierarchy's part of an entity stays unused.
        registry.update<scene::WorldTransform>(entity, {matrix});
    }
    void set_light(ecs::Entity entity, const LightData& data);
    Result<SharedMaterial> make_material(const MaterialData& data, const SharedMaterial* before);
    void set_surface(ecs::Entity entity, const SharedMaterial& surface);
    Status set_for_sensors(const Field& field, std::string_view value);
    void forget_lost_commands();
    Status record(VkCommandBuffer commands, const scene::ProjectedCamera& camera, const FrameImages& images);
    Status record_passes(VkCommandBuffer commands, const gpu::UploadSlice& row, const scene::DepthMapping& mapping,
                         const FrameImages& images);
};

// host_images.cpp
Status check_images(const FrameImages& images);
gi::HostGBuffer import_g_buffer(gpu::FrameGraph& graph, const FrameImages& images, const scene::DepthMapping& mapping);
gpu::ResourceId import_output(gpu::FrameGraph& graph, const char* name, const HostImage& image,
                              const FrameImages& images);
// Inputs that the module has no use for in another form; invalid where the host gives none.
gpu::ResourceId import_optional(gpu::FrameGraph& graph, const char* name, const HostImage& image, VkFormat usual,
                                const FrameImages& images);

} // namespace sunfleck::host
