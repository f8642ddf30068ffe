// What the host says of meshes, materials, instances and lights: kept in its words, and mirrored into the registry.
#include "gi_module/host_context.h"

#include "engine/core/memory_limit.h"
#include "engine/scene/procedural.h"

#include <algorithm>
#include <map>

namespace sunfleck::host {
namespace {

template <typename... Components>
void remove_if_there(ecs::Registry& registry, ecs::Entity entity) {
    ((registry.has<Components>(entity) ? registry.remove<Components>(entity) : void()), ...);
}

// Looks along -Z, as lights do. Kinds without a direction may have any.
mat4 facing_along(vec3 direction, vec3 position) {
    const float length = glm::length(direction);
    const vec3 z = length > 0.0f && is_finite(direction / length) ? -direction / length : vec3(0.0f, 1.0f, 0.0f);
    vec3 x, y;
    orthonormal_basis(z, x, y);
    return mat4(vec4(x, 0.0f), vec4(y, 0.0f), vec4(z, 0.0f), vec4(is_finite(position) ? position : vec3(0.0f), 1.0f));
}

std::vector<vec3> vectors_of(std::span<const float> from) {
    std::vector<vec3> to;
    to.reserve(from.size() / 3);
    for (std::size_t i = 0; i + 2 < from.size(); i += 3)
        to.emplace_back(from[i], from[i + 1], from[i + 2]);
    return to;
}

scene::Mesh mesh_of(const MeshData& data) {
    scene::Mesh mesh;
    mesh.positions = vectors_of(data.positions);
    mesh.normals = vectors_of(data.normals);
    for (vec3& normal : mesh.normals)
        normal = glm::normalize(normal);
    mesh.texture_coordinates.reserve(data.texture_coordinates.size() / 2);
    for (std::size_t i = 0; i + 1 < data.texture_coordinates.size(); i += 2)
        mesh.texture_coordinates.emplace_back(data.texture_coordinates[i], data.texture_coordinates[i + 1], 0.0f, 0.0f);
    mesh.indices.assign(data.indices.begin(), data.indices.end());
    if (mesh.normals.empty())
        scene::compute_normals(mesh);
    return mesh;
}

// Of the copies.
Status check_memory_of(const MeshData& data) {
    const std::uint64_t vertices = data.positions.size() / 3;
    const std::uint64_t bytes_per_vertex = 2 * sizeof(vec3) + (data.texture_coordinates.empty() ? 0 : sizeof(vec4));
    return check_memory(vertices * bytes_per_vertex + data.indices.size_bytes(),
                        "MeshData of " + std::to_string(vertices) + " vertices", "its detail");
}

Status check_memory_of(const TextureData& data) {
    return check_memory(data.pixels.size_bytes(),
                        "TextureData of " + std::to_string(data.width) + "x" + std::to_string(data.height) + " texels",
                        "its size");
}

scene::Texture texture_of(const TextureData& data) {
    scene::Texture texture;
    texture.name = "host texture";
    texture.width = data.width;
    texture.height = data.height;
    texture.srgb = true;
    texture.pixels.assign(data.pixels.begin(), data.pixels.end());
    return texture;
}

scene::Material material_of(const Vector3& albedo, const Vector3& emission) {
    scene::Material material;
    material.base_colour = vector_of(albedo);
    material.emission = vector_of(emission);
    return material;
}

Status check_mesh_there(const Description& description, std::uint32_t mesh) {
    if (mesh < description.meshes.size() &&
        std::find(description.removed_meshes.begin(), description.removed_meshes.end(), mesh) ==
            description.removed_meshes.end() &&
        !description.meshes[mesh].indices.empty())
        return {};
    return wrong("there is no mesh " + std::to_string(mesh));
}

Status check_material_there(const Description& description, std::uint32_t material) {
    if (material < description.materials.size())
        return {};
    return wrong("there is no material " + std::to_string(material));
}

} // namespace

Mirror::Mirror(const Description& description) {
    scene::register_components(registry);
    // In the order in which they were added.
    using Add = void (Mirror::*)(const Description&, std::uint32_t);
    std::map<std::uint64_t, std::pair<Add, std::uint32_t>> ordered;
    const auto list = [&](const auto& entries, Add add_entry) {
        for (const auto& [number, entry] : entries)
            ordered.emplace(entry.order, std::pair(add_entry, number));
    };
    list(description.instances, &Mirror::add);
    list(description.lights, &Mirror::add_light);
    list(description.sensors, &Mirror::add_sensor);
    for (const auto& [order, entry] : ordered)
        (this->*entry.first)(description, entry.second);
}

void Mirror::add(const Description& description, std::uint32_t number) {
    const Description::Instance& instance = description.instances[number];
    const ecs::Entity entity = registry.create();
    instances.add_as(number, {entity});
    registry.emplace<scene::MeshInstance>(entity, {instance.mesh});
    set_surface(entity, description.surface_of(instance));
    if (instance.mobility == Mobility::moving)
        registry.emplace<scene::Mover>(entity, {});
    place(entity, instance.transform);
}

void Mirror::add_light(const Description& description, std::uint32_t number) {
    lights.add_as(number, registry.create());
    set_light(lights[number], description.lights[number].data);
}

// In place of a light of another kind. One of the same kind changes where it is.
template <typename Light>
static void become(ecs::Registry& registry, ecs::Entity entity, const Light& light) {
    const auto remove = [&]<typename Other>(std::type_identity<Other>) {
        if constexpr (!std::is_same_v<Other, Light>)
            remove_if_there<Other>(registry, entity);
    };
    remove(std::type_identity<scene::PointLight>());
    remove(std::type_identity<scene::SpotLight>());
    remove(std::type_identity<scene::DirectionalLight>());
    remove(std::type_identity<scene::Environment>());
    registry.emplace_or_replace<Light>(entity, light);
}

void Mirror::set_light(ecs::Entity entity, const LightData& data) {
    const vec3 strength = vector_of(data.strength);
    place(entity, facing_along(vector_of(data.direction), vector_of(data.position)));
    switch (data.kind) {
    case LightKind::point:
        return become(registry, entity, scene::PointLight{strength});
    case LightKind::spot:
        return become(registry, entity, scene::SpotLight{strength, data.inner_angle, data.outer_angle});
    case LightKind::directional:
        return become(registry, entity, scene::DirectionalLight{strength});
    case LightKind::sky:
        return become(registry, entity, scene::Environment{strength});
    }
}

void Mirror::set_surface(ecs::Entity entity, const SharedMaterial& surface) {
    registry.emplace_or_replace<scene::Material>(entity, surface.material);
    if (surface.textures)
        registry.emplace_or_replace<scene::MaterialTextures>(entity, *surface.textures);
    else
        remove_if_there<scene::MaterialTextures>(registry, entity);
}

Result<std::uint32_t> Context::add_mesh(const MeshData& data) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Result<std::uint32_t> {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_mesh(data));
        SUNFLECK_TRY(check_memory_of(data));
        return self.description.meshes.add(mesh_of(data));
    });
}

Status Context::remove_mesh(std::uint32_t mesh) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_mesh_there(self.description, mesh));
        for (const auto& [number, instance] : self.description.instances)
            if (instance.mesh == mesh)
                return wrong("instance " + std::to_string(number) + " has mesh " + std::to_string(mesh) +
                             "; remove the instance first");
        // Whoever follows the scene may still look at it, until the next update.
        self.description.removed_meshes.push_back(mesh);
        return {};
    });
}

// `before`: keeps its texture if the new data has the same one.
Result<SharedMaterial> Context::Implementation::make_material(const MaterialData& data, const SharedMaterial* before) {
    SUNFLECK_TRY(check_material(data, device->traits().max_image_size));
    SharedMaterial result;
    result.material = material_of(data.albedo, data.emission);
    result.material.metallic = data.metallic;
    result.material.roughness = data.roughness;
    if (data.albedo_texture.pixels.empty())
        return result;
    scene::TextureStore& textures = description.textures;
    SUNFLECK_TRY(check_memory_of(data.albedo_texture));
    scene::Texture texture = texture_of(data.albedo_texture);
    const std::int32_t old = before != nullptr && before->textures ? before->textures->base_colour.texture : -1;
    const bool same = old >= 0 && textures[std::uint32_t(old)].width == texture.width &&
                      textures[std::uint32_t(old)].pixels == texture.pixels;
    result.textures.emplace();
    result.textures->base_colour.texture = same ? old : std::int32_t(textures.add(std::move(texture)));
    return result;
}

Result<std::uint32_t> Context::add_material(const MaterialData& data) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Result<std::uint32_t> {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_ASSIGN(auto material, self.make_material(data, nullptr));
        self.description.materials.push_back(material);
        return std::uint32_t(self.description.materials.size() - 1);
    });
}

Status Context::set_material(std::uint32_t material, const MaterialData& data) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_material_there(self.description, material));
        SharedMaterial& changed = self.description.materials[material];
        SUNFLECK_ASSIGN(changed, self.make_material(data, &changed));
        self.mirror([&](Mirror& mirror) {
            for (const auto& [number, instance] : self.description.instances)
                if (instance.material == material)
                    mirror.set_surface(mirror.instances[number].entity, changed);
        });
        return {};
    });
}

Result<std::uint32_t> Context::add_instance(const InstanceData& data) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Result<std::uint32_t> {
        Description& description = self.description;
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_mesh_there(description, data.mesh));
        if (data.material != no_material)
            SUNFLECK_TRY(check_material_there(description, data.material));
        if (data.mobility != Mobility::fixed && data.mobility != Mobility::moving)
            return wrong("InstanceData::mobility is " + std::to_string(int(data.mobility)) + ", which is no Mobility");
        SUNFLECK_TRY(check_transform("InstanceData::transform", data.transform, description.meshes.bounds(data.mesh)));
        SUNFLECK_TRY(check_albedo("InstanceData::albedo", data.albedo));
        SUNFLECK_TRY(check_strength("InstanceData::emission", data.emission));
        const std::uint32_t number =
            description.instances.add(Description::Instance{description.next_order++,
                                                            data.mesh,
                                                            matrix_of(data.transform),
                                                            data.mobility,
                                                            data.material,
                                                            {material_of(data.albedo, data.emission), {}}});
        self.mirror([&](Mirror& mirror) { mirror.add(description, number); });
        return number;
    });
}

Status Context::set_transform(std::uint32_t instance, const Matrix4& transform) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_there(self.description.instances, instance, "instance"));
        Description::Instance& changed = self.description.instances[instance];
        SUNFLECK_TRY(check_transform("transform", transform, self.description.meshes.bounds(changed.mesh)));
        changed.transform = matrix_of(transform);
        self.mirror([&](Mirror& mirror) { mirror.place(mirror.instances[instance].entity, changed.transform); });
        return {};
    });
}

Status Context::set_surface(std::uint32_t instance, const Vector3& albedo, const Vector3& emission) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_there(self.description.instances, instance, "instance"));
        SUNFLECK_TRY(check_albedo("albedo", albedo));
        SUNFLECK_TRY(check_strength("emission", emission));
        Description::Instance& changed = self.description.instances[instance];
        changed.own = {material_of(albedo, emission), {}};
        changed.material = no_material;
        self.mirror([&](Mirror& mirror) { mirror.set_surface(mirror.instances[instance].entity, changed.own); });
        return {};
    });
}

Status Context::remove_instance(std::uint32_t instance) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_there(self.description.instances, instance, "instance"));
        self.description.instances.remove(instance);
        self.mirror([&](Mirror& mirror) {
            mirror.registry.destroy(mirror.instances[instance].entity);
            mirror.instances.remove(instance);
        });
        return {};
    });
}

Result<std::uint32_t> Context::add_light(const LightData& data) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Result<std::uint32_t> {
        Description& description = self.description;
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_light(data));
        const std::uint32_t number = description.lights.add(Description::Light{description.next_order++, data});
        self.mirror([&](Mirror& mirror) { mirror.add_light(description, number); });
        return number;
    });
}

Status Context::set_light(std::uint32_t light, const LightData& data) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_there(self.description.lights, light, "light"));
        SUNFLECK_TRY(check_light(data));
        self.description.lights[light].data = data;
        self.mirror([&](Mirror& mirror) { mirror.set_light(mirror.lights[light], data); });
        return {};
    });
}

Status Context::remove_light(std::uint32_t light) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_there(self.description.lights, light, "light"));
        self.description.lights.remove(light);
        self.mirror([&](Mirror& mirror) {
            mirror.registry.destroy(mirror.lights[light]);
            mirror.lights.remove(light);
        });
        return {};
    });
}

Status Context::clear() {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        // Nothing of the follower looks at the description before the next update makes another one.
        self.description = {};
        self.damaged = true;
        return {};
    });
}

} // namespace sunfleck::host
