// The host's meshes, materials, instances and lights, mirrored into the registry.
#include "gi_module/host_context.h"

#include "engine/scene/procedural.h"

namespace sunfleck::host {
namespace {

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

// Per vertex: three floats each, or none at all.
Status read_vectors(std::span<const float> from, const char* what, std::vector<vec3>& to) {
    for (std::size_t i = 0; i + 2 < from.size(); i += 3) {
        to.emplace_back(from[i], from[i + 1], from[i + 2]);
        if (!is_finite(to.back()))
            return Error{std::string(what) + " " + std::to_string(i / 3) + " is not finite"};
    }
    return {};
}

Status read_coordinates(std::span<const float> from, std::vector<vec4>& to) {
    for (std::size_t i = 0; i + 1 < from.size(); i += 2) {
        to.emplace_back(from[i], from[i + 1], 0.0f, 0.0f);
        if (!is_finite(vec3(to.back())))
            return Error{"texture coordinate " + std::to_string(i / 2) + " is not finite"};
    }
    return {};
}

Result<scene::Texture> texture_of(const TextureData& data) {
    const std::uint64_t bytes = std::uint64_t(data.width) * data.height * 4;
    if (data.width == 0 || data.height == 0 || data.pixels.size() != bytes)
        return Error{"a texture of " + std::to_string(data.width) + "x" + std::to_string(data.height) + " texels has " +
                     std::to_string(data.pixels.size()) + " bytes; four a texel are needed"};
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
    material.base_colour = glm::min(vector_of(albedo), vec3(1.0f));
    material.emission = vector_of(emission);
    return material;
}

} // namespace

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

Result<std::uint32_t> Context::add_mesh(const MeshData& data) {
    scene::Mesh mesh;
    const std::size_t vertices = data.positions.size() / 3;
    if (vertices == 0 || data.positions.size() % 3 != 0 || data.indices.empty() || data.indices.size() % 3 != 0)
        return Error{"a mesh needs three numbers a vertex and three indices a triangle"};
    if (!data.normals.empty() && data.normals.size() != data.positions.size())
        return Error{"a mesh needs one normal a vertex, or none"};
    if (!data.texture_coordinates.empty() && data.texture_coordinates.size() != 2 * vertices)
        return Error{"a mesh needs two texture coordinates a vertex, or none"};
    SUNFLECK_TRY(read_vectors(data.positions, "vertex", mesh.positions));
    SUNFLECK_TRY(read_vectors(data.normals, "normal", mesh.normals));
    SUNFLECK_TRY(read_coordinates(data.texture_coordinates, mesh.texture_coordinates));
    for (const std::uint32_t index : data.indices)
        if (index >= vertices)
            return Error{"index " + std::to_string(index) + " points past the last of " + std::to_string(vertices) +
                         " vertices"};
    mesh.indices.assign(data.indices.begin(), data.indices.end());
    if (mesh.normals.empty())
        scene::compute_normals(mesh);
    return implementation_->meshes.add(std::move(mesh));
}

// `before`: keeps its texture if the new data has the same one.
Result<Context::Implementation::SharedMaterial> Context::Implementation::make_material(const MaterialData& data,
                                                                                       const SharedMaterial* before) {
    if (!is_strength(data.albedo) || !is_strength(data.emission))
        return Error{"albedo and emission must be finite and not negative"};
    if (!(data.metallic >= 0.0f && data.metallic <= 1.0f && data.roughness >= 0.0f && data.roughness <= 1.0f))
        return Error{"metallic and roughness must lie between 0 and 1"};
    SharedMaterial result;
    result.material = material_of(data.albedo, data.emission);
    result.material.metallic = data.metallic;
    result.material.roughness = data.roughness;
    if (data.albedo_texture.pixels.empty())
        return result;
    SUNFLECK_ASSIGN(scene::Texture texture, texture_of(data.albedo_texture));
    const std::int32_t old = before != nullptr && before->textures ? before->textures->base_colour.texture : -1;
    const bool same = old >= 0 && textures[std::uint32_t(old)].width == texture.width &&
                      textures[std::uint32_t(old)].pixels == texture.pixels;
    result.textures.emplace();
    result.textures->base_colour.texture = same ? old : std::int32_t(textures.add(std::move(texture)));
    return result;
}

void Context::Implementation::set_surface(ecs::Entity entity, const SharedMaterial& surface) {
    registry.emplace_or_replace<scene::Material>(entity, surface.material);
    if (surface.textures)
        registry.emplace_or_replace<scene::MaterialTextures>(entity, *surface.textures);
    else
        remove_if_there<scene::MaterialTextures>(registry, entity);
}

Result<std::uint32_t> Context::add_material(const MaterialData& data) {
    Implementation& self = *implementation_;
    SUNFLECK_ASSIGN(auto material, self.make_material(data, nullptr));
    self.materials.push_back(std::move(material));
    return std::uint32_t(self.materials.size() - 1);
}

Status Context::set_material(std::uint32_t material, const MaterialData& data) {
    Implementation& self = *implementation_;
    if (material >= self.materials.size())
        return Error{"there is no material " + std::to_string(material)};
    SUNFLECK_ASSIGN(self.materials[material], self.make_material(data, &self.materials[material]));
    for (std::size_t i = 0; i < self.instances.size(); ++i)
        if (self.instance_materials[i] == material && !self.instances[i].is_null())
            self.set_surface(self.instances[i], self.materials[material]);
    return {};
}

Result<std::uint32_t> Context::add_instance(const InstanceData& data) {
    Implementation& self = *implementation_;
    const mat4 matrix = matrix_of(data.transform);
    if (data.mesh >= self.meshes.size())
        return Error{"there is no mesh " + std::to_string(data.mesh)};
    if (data.material != no_material && data.material >= self.materials.size())
        return Error{"there is no material " + std::to_string(data.material)};
    if (!is_finite_matrix(matrix) || !is_strength(data.albedo) || !is_strength(data.emission))
        return Error{"an instance's transform, albedo and emission must be finite, the latter two not negative"};
    const ecs::Entity entity = self.registry.create();
    self.registry.emplace<scene::MeshInstance>(entity, {data.mesh});
    self.set_surface(entity, data.material != no_material
                                 ? self.materials[data.material]
                                 : Implementation::SharedMaterial{material_of(data.albedo, data.emission), {}});
    if (data.mobility == Mobility::moving)
        self.registry.emplace<scene::Mover>(entity, {});
    self.place(entity, matrix);
    self.instances.push_back(entity);
    self.instance_materials.push_back(data.material);
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
    Implementation& self = *implementation_;
    SUNFLECK_ASSIGN(const ecs::Entity entity, self.find(self.instances, instance, "instance"));
    if (!is_strength(albedo) || !is_strength(emission))
        return Error{"albedo and emission must be finite and not negative"};
    self.set_surface(entity, {material_of(albedo, emission), {}});
    self.instance_materials[instance] = no_material;
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

} // namespace sunfleck::host
