// What a host::Context holds: what the host described, and the module with a registry, device and frame graph of its
// own that follows it.
#pragma once

#include "engine/gpu/vulkan.h" // before any other header that includes Vulkan's

#include "engine/core/log.h"
#include "engine/scene/camera_projection.h"
#include "gi_module/g_buffer/conversion.h"
#include "gi_module/host_checks.h"
#include "gi_module/light_sensors/light_sensors.h"
#include "gi_module/numbered.h"
#include "gi_module/system.h"
#include "sunfleck/host.h"

#include <atomic>
#include <optional>

namespace sunfleck::host {

struct SharedMaterial {
    scene::Material material;
    std::optional<scene::MaterialTextures> textures;
};

// The scene in the host's words. Nothing in it depends on a device.
struct Description {
    struct Instance {
        std::uint64_t order = 0; // in which all of them were added
        std::uint32_t mesh = 0;
        mat4 transform{1.0f};
        Mobility mobility = Mobility::fixed;
        std::uint32_t material = no_material; // no_material: `own`
        SharedMaterial own;
    };
    struct Light {
        std::uint64_t order = 0;
        LightData data;
    };
    struct Sensor {
        std::uint64_t order = 0;
        SensorData data;
    };
    scene::MeshStore meshes;
    std::vector<std::uint32_t> removed_meshes; // of which the store still has some
    scene::TextureStore textures;
    std::vector<SharedMaterial> materials;
    Numbered<Instance> instances;
    Numbered<Light> lights;
    Numbered<Sensor> sensors;
    std::uint64_t next_order = 0;

    const SharedMaterial& surface_of(const Instance& instance) const {
        return instance.material == no_material ? instance.own : materials[instance.material];
    }
};

// The description as entities.
struct Mirror {
    explicit Mirror(const Description& description);
    void add(const Description& description, std::uint32_t instance);
    void add_light(const Description& description, std::uint32_t light);
    void place(ecs::Entity entity, const mat4& matrix) {
        // Hosts give whole matrices, so the hierarchy's part of an entity stays unused.
        registry.update<scene::WorldTransform>(entity, {matrix});
    }
    void add_sensor(const Description& description, std::uint32_t sensor);
    void set_light(ecs::Entity entity, const LightData& data);
    void set_sensor(ecs::Entity entity, const SensorData& data);
    void set_surface(ecs::Entity entity, const SharedMaterial& surface);

    struct Instance {
        ecs::Entity entity;
        std::uint32_t surface = 0; // what surface_id says: 0 before the first update
    };
    ecs::Registry registry;
    Numbered<Instance> instances;
    Numbered<ecs::Entity> lights, sensors;
    scene::ChangeTracker change_tracker{scene::ChangeTracker::Space::of_scene};
};

// Everything that follows from the description, and can be made from it again.
struct Follower {
    static Result<std::unique_ptr<Follower>> create(gpu::Device& device, gpu::PipelineStore& pipelines,
                                                    const Description& description, const gi::Settings& settings);
    explicit Follower(const Description& description) : mirror(description) {}
    ~Follower() {
        // Passes of the last frame refer to the rest.
        graph.reset();
    }

    Mirror mirror;
    std::unique_ptr<scene::GpuScene> gpu_scene;
    std::unique_ptr<raytrace::RayScene> rays;
    std::unique_ptr<gi::System> system;
    std::unique_ptr<gi::GBufferConversion> conversion;
    std::unique_ptr<gi::LightSensors> sensors; // null until their first step
    std::unique_ptr<gpu::FrameGraph> graph;
    scene::SceneSpace space;             // of the last update
    std::optional<mat4> view_projection; // of the last frame recorded
    bool updated = false;
    bool unrecorded = false; // the last update was not followed by a frame
};

struct Context::Implementation {
    std::unique_ptr<gpu::Device> device;
    gpu::ShaderLibrary shaders;
    std::unique_ptr<gpu::PipelineStore> pipelines;
    std::unique_ptr<gpu::FrameResources> resources;
    std::unique_ptr<gpu::Timers> timers;
    LogSink log;
    sunfleck::LogSink engine_log; // leads to `log`
    gi::Settings settings;
    gi::SensorSettings sensor_settings;
    Description description;
    std::unique_ptr<Follower> follower;
    Serials serials;
    // A call that may change the context is under way. Calls from its callbacks, and from other threads meanwhile, are
    // refused.
    std::atomic<bool> busy{false};
    mutable std::atomic<int> readers{0};     // those that only look something up
    std::atomic<bool> abandon_wanted{false}; // seen to by whichever call has the turn, or the next one
    // The follower may be half of this and half of that, because a step failed: the next update makes another.
    bool damaged = false;
    bool abandoned = false;

    Status restart();
    Status set_for_sensors(const Field& field, std::string_view value);
    Status step_sensors();
    Status update(const Frame& frame);
    Status follow(const Frame& frame, bool lost);
    void number_surfaces();
    void drop_removed_meshes();
    void forget_lost_commands();
    Status check_record(VkCommandBuffer commands, const FrameImages& images) const;
    Status record(VkCommandBuffer commands, const scene::ProjectedCamera& camera, const FrameImages& images);
    Status record_passes(VkCommandBuffer commands, const gpu::UploadSlice& row, const scene::DepthMapping& mapping,
                         const FrameImages& images);
    Result<SharedMaterial> make_material(const MaterialData& data, const SharedMaterial* before);
    Status check_ready() const;

    struct Turn {
        explicit Turn(Implementation& context);
        ~Turn();
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;
        Implementation& context;
        const bool taken; // false: another call has it
    };
    // Of calls that only look something up, and never wait or call back.
    struct Reading {
        explicit Reading(const Implementation& context);
        ~Reading();
        Reading(const Reading&) = delete;
        Reading& operator=(const Reading&) = delete;
        const Implementation& context;
        const bool allowed; // false: what there is may be changing
    };
    void let_go_if_wanted();
    // `name`: of the host's call, for messages.
    template <typename Call>
    auto run(const Call& call, const char* name = __builtin_FUNCTION()) noexcept -> decltype(call());

    // Calls change(mirror). The description has the change already; where the mirror cannot follow, it is made again.
    template <typename Change>
    void mirror(const Change& change) noexcept {
        if (damaged || follower == nullptr)
            return;
        try {
            change(follower->mirror);
        } catch (...) {
            damaged = true;
        }
    }
};

// There may be no memory for the message, either.
inline Error out_of_memory(const char* call) noexcept {
    try {
        return Error{std::string(call) + ": out of memory", ErrorCode::memory};
    } catch (const std::bad_alloc&) {
        return Error{"out of memory", ErrorCode::memory};
    }
}

// Runs a call of the host's, of that name; no exception leaves it.
template <typename Call>
auto guarded(const sunfleck::LogSink& log, const Call& call, const char* name) noexcept -> decltype(call()) {
    try {
        const ThreadLogSink scope(log);
        return call();
    } catch (const std::bad_alloc&) {
        return out_of_memory(name);
    } catch (const std::exception& exception) {
        return Error{exception.what()};
    } catch (...) {
        return Error{"a callback of the host's ended with an exception"};
    }
}

// A call of the host's on its context.
template <typename Call>
auto Context::Implementation::run(const Call& call, const char* name) noexcept -> decltype(call()) {
    const Turn turn(*this);
    const auto taken = [&]() -> decltype(call()) {
        if (!turn.taken)
            return wrong("the context is within another call; callbacks and other threads must not call it meanwhile");
        return call();
    };
    return guarded(engine_log, taken, name);
}

template <typename T>
Status check_there(const Numbered<T>& all, std::uint32_t number, const char* what) {
    if (all.find(number) != nullptr)
        return {};
    return wrong(std::string("there is no ") + what + " " + std::to_string(number));
}

// host_image_states.cpp
Status check_image_state(const std::string& what, const ImageState& state, VkFormat format);

// host_images.cpp
Status check_images(const FrameImages& images, std::uint32_t largest);
gi::HostGBuffer import_g_buffer(gpu::FrameGraph& graph, const FrameImages& images, const scene::DepthMapping& mapping);
gpu::ResourceId import_output(gpu::FrameGraph& graph, const char* name, const HostImage& image,
                              const FrameImages& images);
// Inputs that the module has no use for in another form; invalid where the host gives none.
gpu::ResourceId import_optional(gpu::FrameGraph& graph, const char* name, const HostImage& image, VkFormat usual,
                                const FrameImages& images);

} // namespace sunfleck::host
