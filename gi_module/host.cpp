// The plain interface for foreign hosts, mirrored into a registry.
#include "engine/gpu/vulkan.h" // before any other header that includes Vulkan's

#include "engine/scene/camera_view.h"
#include "engine/scene/procedural.h"
#include "gi_module/system.h"
#include "sunfleck/host.h"

#include <cstring>
#include <optional>
#include <unordered_map>

namespace sunfleck::host {
namespace {

vec3 vector_of(const Vector3& v) {
    return {v[0], v[1], v[2]};
}

mat4 matrix_of(const Matrix4& m) {
    mat4 result;
    for (int i = 0; i < 16; ++i)
        result[i / 4][i % 4] = m[std::size_t(i)];
    return result;
}

bool is_finite_matrix(const mat4& m) {
    for (int c = 0; c < 4; ++c)
        if (!is_finite(vec3(m[c])))
            return false;
    return true;
}

bool is_strength(const Vector3& v) {
    const vec3 value = vector_of(v);
    return is_finite(value) && value.x >= 0.0f && value.y >= 0.0f && value.z >= 0.0f;
}

scene::CameraView view_of(const Camera& camera) {
    scene::CameraView view;
    view.position = vector_of(camera.position);
    view.target = view.position + vector_of(camera.forward);
    view.up = vector_of(camera.up);
    view.vertical_field_of_view = camera.vertical_field_of_view;
    return view;
}

template <typename... Components>
void remove_if_there(ecs::Registry& registry, ecs::Entity entity) {
    ((registry.has<Components>(entity) ? registry.remove<Components>(entity) : void()), ...);
}

// Looks along -Z, as lights do.
mat4 facing_along(vec3 direction, vec3 position) {
    const float length = glm::length(direction);
    const vec3 z = length > 1e-12f ? -direction / length : vec3(0.0f, 1.0f, 0.0f);
    vec3 x, y;
    orthonormal_basis(z, x, y);
    return mat4(vec4(x, 0.0f), vec4(y, 0.0f), vec4(z, 0.0f), vec4(position, 1.0f));
}

gpu::ImportedImage imported(const char* name, const HostImage& image, VkFormat format, const FrameImages& images) {
    gpu::ImportedImage result;
    result.name = name;
    result.image = image.image;
    result.view = image.view;
    result.description.name = name;
    result.description.format = format;
    result.description.width = images.width;
    result.description.height = images.height;
    result.entry.layout = image.entry.layout;
    result.entry.write_stages = image.entry.stages;
    result.entry.write_access = image.entry.access;
    result.has_exit = true;
    result.exit = gpu::Usage::host;
    result.exit_stages = image.exit.stages;
    result.exit_access = image.exit.access;
    result.exit_layout = image.exit.layout;
    return result;
}

} // namespace

struct Context::Implementation {
    std::unique_ptr<gpu::Device> device;
    gpu::ShaderLibrary shaders;
    std::unique_ptr<gpu::PipelineStore> pipelines;
    std::unique_ptr<gpu::FrameResources> resources;
    std::unique_ptr<gpu::FrameGraph> graph;
    std::unique_ptr<scene::GpuScene> gpu_scene;
    std::unique_ptr<raytrace::RayScene> rays;
    std::unique_ptr<gi::System> system;
    gi::Settings settings;
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::ChangeTracker change_tracker;
    std::vector<ecs::Entity> instances, lights; // null: removed
    std::vector<std::uint32_t> surface_ids;     // by instance
    std::optional<mat4> view_projection;        // of the last frame recorded
    bool updated = false;

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
};

void Context::Implementation::set_light(ecs::Entity entity, const LightData& data) {
    const vec3 strength = vector_of(data.strength);
    place(entity, facing_along(vector_of(data.direction), vector_of(data.position)));
    switch (data.kind) {
    case LightKind::point:
        registry.emplace_or_replace<scene::PointLight>(entity, {strength});
        break;
    case LightKind::spot:
        registry.emplace_or_replace<scene::SpotLight>(entity, {strength, data.inner_angle, data.outer_angle});
        break;
    case LightKind::directional:
        registry.emplace_or_replace<scene::DirectionalLight>(entity, {strength});
        break;
    case LightKind::sky:
        registry.emplace_or_replace<scene::Environment>(entity, {strength});
        break;
    }
}

std::vector<std::string> missing_features(VkPhysicalDevice physical_device) {
    return gpu::missing_features(physical_device);
}

void enable_features(VkPhysicalDeviceFeatures* features, VkPhysicalDeviceVulkan12Features* features12,
                     VkPhysicalDeviceVulkan13Features* features13) {
    const gpu::RequiredFeatures required;
    // Each struct is a header and then nothing but VkBool32.
    const auto enable = [](const void* from, void* to, std::size_t header, std::size_t size) {
        const auto* wanted = reinterpret_cast<const VkBool32*>(static_cast<const char*>(from) + header);
        auto* target = reinterpret_cast<VkBool32*>(static_cast<char*>(to) + header);
        for (std::size_t i = 0; i < (size - header) / sizeof(VkBool32); ++i)
            target[i] = target[i] != VK_FALSE || wanted[i] != VK_FALSE ? VK_TRUE : VK_FALSE;
    };
    if (features != nullptr)
        enable(&required.features.features, features, 0, sizeof *features);
    if (features12 != nullptr)
        enable(&required.features12, features12, offsetof(VkPhysicalDeviceVulkan12Features, samplerMirrorClampToEdge),
               offsetof(VkPhysicalDeviceVulkan12Features, subgroupBroadcastDynamicId) + sizeof(VkBool32));
    if (features13 != nullptr)
        enable(&required.features13, features13, offsetof(VkPhysicalDeviceVulkan13Features, robustImageAccess),
               offsetof(VkPhysicalDeviceVulkan13Features, maintenance4) + sizeof(VkBool32));
}

Matrix4 view_projection(const Camera& camera, std::uint32_t width, std::uint32_t height) {
    const shared::CameraRow row = scene::make_camera_row(view_of(camera), width, height);
    Matrix4 result;
    std::memcpy(result.data(), &row.view_projection, sizeof result);
    return result;
}

Context::Context() : implementation_(std::make_unique<Implementation>()) {}

Context::~Context() {
    // Passes of the last frame refer to the rest.
    implementation_->graph.reset();
}

Result<std::unique_ptr<Context>> Context::create(const VulkanHandles& handles) {
    std::unique_ptr<Context> context(new Context());
    Implementation& self = *context->implementation_;
    gpu::HostDevice host;
    host.instance = handles.instance;
    host.physical_device = handles.physical_device;
    host.device = handles.device;
    host.queue = handles.queue;
    host.queue_family = handles.queue_family;
    SUNFLECK_ASSIGN(self.device, gpu::Device::adopt(host));
    scene::register_components(self.registry);
    self.shaders.add(gi::shaders());
    self.pipelines = std::make_unique<gpu::PipelineStore>(*self.device, self.shaders);
    self.resources = std::make_unique<gpu::FrameResources>(*self.device);
    self.graph = std::make_unique<gpu::FrameGraph>(self.device.get());
    self.gpu_scene = std::make_unique<scene::GpuScene>(*self.device);
    SUNFLECK_ASSIGN(self.rays, raytrace::RayScene::create());
    SUNFLECK_ASSIGN(self.system, gi::System::create(*self.device, *self.pipelines));
    return context;
}

Status Context::set(std::string_view name, std::string_view value) {
    Implementation& self = *implementation_;
    const Field* field = gi::Settings::description().find(name);
    if (field == nullptr)
        return Error{"no setting is called '" + std::string(name) + "'"};
    gi::Settings changed = self.settings;
    SUNFLECK_TRY(field_from_text(*field, &changed, value));
    SUNFLECK_TRY(self.system->set_settings(changed));
    self.settings = changed;
    return {};
}

Result<std::uint32_t> Context::add_mesh(const MeshData& data) {
    scene::Mesh mesh;
    const std::size_t vertices = data.positions.size() / 3;
    if (vertices == 0 || data.positions.size() % 3 != 0 || data.indices.empty() || data.indices.size() % 3 != 0)
        return Error{"a mesh needs three numbers a vertex and three indices a triangle"};
    if (!data.normals.empty() && data.normals.size() != data.positions.size())
        return Error{"a mesh needs one normal a vertex, or none"};
    for (std::size_t i = 0; i < vertices; ++i) {
        mesh.positions.emplace_back(data.positions[i * 3], data.positions[i * 3 + 1], data.positions[i * 3 + 2]);
        if (!is_finite(mesh.positions.back()))
            return Error{"vertex " + std::to_string(i) + " is not finite"};
        if (!data.normals.empty())
            mesh.normals.emplace_back(data.normals[i * 3], data.normals[i * 3 + 1], data.normals[i * 3 + 2]);
        if (!data.normals.empty() && !is_finite(mesh.normals.back()))
            return Error{"normal " + std::to_string(i) + " is not finite"};
    }
    for (const std::uint32_t index : data.indices)
        if (index >= vertices)
            return Error{"index " + std::to_string(index) + " points past the last of " + std::to_string(vertices) +
                         " vertices"};
    mesh.indices.assign(data.indices.begin(), data.indices.end());
    if (mesh.normals.empty())
        scene::compute_normals(mesh);
    return implementation_->meshes.add(std::move(mesh));
}

Result<std::uint32_t> Context::add_instance(const InstanceData& data) {
    Implementation& self = *implementation_;
    const mat4 matrix = matrix_of(data.transform);
    if (data.mesh >= self.meshes.size())
        return Error{"there is no mesh " + std::to_string(data.mesh)};
    if (!is_finite_matrix(matrix) || !is_strength(data.albedo) || !is_strength(data.emission))
        return Error{"an instance's transform, albedo and emission must be finite, the latter two not negative"};
    const ecs::Entity entity = self.registry.create();
    scene::Material material;
    material.base_colour = glm::min(vector_of(data.albedo), vec3(1.0f));
    material.emission = vector_of(data.emission);
    self.registry.emplace<scene::MeshInstance>(entity, {data.mesh});
    self.registry.emplace<scene::Material>(entity, material);
    if (data.mobility == Mobility::moving)
        self.registry.emplace<scene::Mover>(entity, {});
    self.place(entity, matrix);
    self.instances.push_back(entity);
    return std::uint32_t(self.instances.size() - 1);
}

Status Context::set_transform(std::uint32_t instance, const Matrix4& transform) {
    SUNFLECK_ASSIGN(const ecs::Entity entity, implementation_->find(implementation_->instances, instance, "instance"));
    if (!is_finite_matrix(matrix_of(transform)))
        return Error{"a transform must be finite"};
    implementation_->place(entity, matrix_of(transform));
    return {};
}

Status Context::set_surface(std::uint32_t instance, const Vector3& albedo, const Vector3& emission) {
    SUNFLECK_ASSIGN(const ecs::Entity entity, implementation_->find(implementation_->instances, instance, "instance"));
    if (!is_strength(albedo) || !is_strength(emission))
        return Error{"albedo and emission must be finite and not negative"};
    implementation_->registry.patch<scene::Material>(entity, [&](scene::Material& material) {
        material.base_colour = glm::min(vector_of(albedo), vec3(1.0f));
        material.emission = vector_of(emission);
    });
    return {};
}

Status Context::remove_instance(std::uint32_t instance) {
    SUNFLECK_ASSIGN(const ecs::Entity entity, implementation_->find(implementation_->instances, instance, "instance"));
    implementation_->registry.destroy(entity);
    implementation_->instances[instance] = ecs::null_entity;
    return {};
}

Result<std::uint32_t> Context::add_light(const LightData& data) {
    Implementation& self = *implementation_;
    self.lights.push_back(self.registry.create());
    const std::uint32_t number = std::uint32_t(self.lights.size() - 1);
    if (const Status status = set_light(number, data); !status) {
        self.registry.destroy(self.lights.back());
        self.lights.pop_back();
        return status.error();
    }
    return number;
}

Status Context::set_light(std::uint32_t light, const LightData& data) {
    Implementation& self = *implementation_;
    SUNFLECK_ASSIGN(const ecs::Entity entity, self.find(self.lights, light, "light"));
    if (!is_strength(data.strength) || !is_finite(vector_of(data.position)) || !is_finite(vector_of(data.direction)))
        return Error{"a light's strength, position and direction must be finite, its strength not negative"};
    // Another kind takes the place of the old one.
    remove_if_there<scene::PointLight, scene::SpotLight, scene::DirectionalLight, scene::Environment>(self.registry,
                                                                                                      entity);
    self.set_light(entity, data);
    return {};
}

Status Context::remove_light(std::uint32_t light) {
    SUNFLECK_ASSIGN(const ecs::Entity entity, implementation_->find(implementation_->lights, light, "light"));
    implementation_->registry.destroy(entity);
    implementation_->lights[light] = ecs::null_entity;
    return {};
}

Status Context::update(const Frame& frame) {
    Implementation& self = *implementation_;
    self.updated = false;
    self.resources->begin_frame(frame.serial, frame.completed_serial);
    const scene::SceneChanges& changes = self.change_tracker.collect(self.registry, self.meshes);
    SUNFLECK_TRY(self.rays->update(changes, self.meshes));
    SUNFLECK_TRY(self.gpu_scene->stage_meshes(self.meshes, *self.resources));
    SUNFLECK_TRY(self.gpu_scene->update(changes, self.meshes, *self.resources));
    gi::FrameInput input;
    input.serial = frame.serial;
    input.completed_serial = frame.completed_serial;
    input.map_budget = frame.map_budget;
    input.progress = frame.progress;
    input.view_projection = self.view_projection;
    SUNFLECK_TRY(self.system->update(self.registry, changes, self.meshes, *self.gpu_scene, *self.rays, input));
    std::unordered_map<ecs::Entity, std::uint32_t> rows;
    for (const scene::DrawItem& item : self.gpu_scene->draws())
        rows[item.entity] = item.row;
    self.surface_ids.assign(self.instances.size(), 0);
    for (std::size_t i = 0; i < self.instances.size(); ++i)
        if (const auto found = rows.find(self.instances[i]); found != rows.end())
            self.surface_ids[i] = found->second + 1;
    self.updated = true;
    return {};
}

std::uint32_t Context::surface_id(std::uint32_t instance) const {
    const auto& ids = implementation_->surface_ids;
    return instance < ids.size() ? ids[instance] : 0;
}

Status Context::record(VkCommandBuffer commands, const Camera& camera, const FrameImages& images) {
    Implementation& self = *implementation_;
    if (!self.updated)
        return Error{"record needs an update before it, each frame"};
    self.updated = false;
    if (images.width == 0 || images.height == 0)
        return Error{"the images have no size"};
    const shared::CameraRow camera_row = scene::make_camera_row(view_of(camera), images.width, images.height);
    self.view_projection = camera_row.view_projection;
    SUNFLECK_ASSIGN(const gpu::UploadSlice row, self.resources->upload_value(camera_row));
    gpu::FrameGraph& graph = *self.graph;
    graph.reset();
    self.gpu_scene->add_passes(graph);
    gi::GBufferInput g_buffer;
    g_buffer.depth = graph.import_host_image(imported("host depth", images.depth, VK_FORMAT_D32_SFLOAT, images));
    g_buffer.normals = graph.import_host_image(imported("host normals", images.normals, VK_FORMAT_R32G32_UINT, images));
    g_buffer.surface =
        graph.import_host_image(imported("host surface ids", images.surface, VK_FORMAT_R32_UINT, images));
    g_buffer.width = images.width;
    g_buffer.height = images.height;
    const gpu::ResourceId output =
        graph.import_host_image(imported("host irradiance", images.irradiance, VK_FORMAT_R16G16B16A16_SFLOAT, images));
    SUNFLECK_TRY(self.system->add_passes(graph, *self.gpu_scene, g_buffer, row, output));
    SUNFLECK_TRY(graph.compile());
    return graph.execute(commands, *self.resources, nullptr);
}

} // namespace sunfleck::host
