#include "engine/core/file.h"
#include "engine/io/gltf.h"

#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <map>
#include <set>
#include <sstream>

namespace sunfleck::io {
namespace {

class Exporter {
public:
    Exporter(ecs::Registry& registry, const scene::MeshStore& meshes) : registry_(registry), meshes_(meshes) {
        model_.asset.version = "2.0";
        model_.asset.generator = "sunfleck";
        model_.buffers.emplace_back();
        model_.scenes.emplace_back();
        model_.defaultScene = 0;
    }

    tinygltf::Model run() {
        for (const ecs::Entity entity : registry_.entities())
            if (registry_.has<scene::Name>(entity))
                node_of_[entity] = add_node(entity);
        for (const auto& [entity, node] : node_of_) {
            const scene::Parent* parent = registry_.try_get<scene::Parent>(entity);
            const auto found = parent != nullptr ? node_of_.find(parent->parent) : node_of_.end();
            if (found != node_of_.end())
                model_.nodes[std::size_t(found->second)].children.push_back(node);
            else
                model_.scenes[0].nodes.push_back(node);
        }
        for (const std::string& name : used_extensions_)
            model_.extensionsUsed.push_back(name);
        return std::move(model_);
    }

private:
    template <typename T>
    int add_accessor(const std::vector<T>& values, int type, int component, int target) {
        std::vector<unsigned char>& data = model_.buffers[0].data;
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = data.size();
        view.byteLength = values.size() * sizeof(T);
        view.target = target;
        const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
        data.insert(data.end(), bytes, bytes + view.byteLength);
        model_.bufferViews.push_back(view);
        tinygltf::Accessor accessor;
        accessor.bufferView = int(model_.bufferViews.size() - 1);
        accessor.componentType = component;
        accessor.type = type;
        accessor.count = values.size();
        model_.accessors.push_back(accessor);
        return int(model_.accessors.size() - 1);
    }

    // One glTF mesh for each pair of mesh and material.
    int add_mesh(std::uint32_t index, int material) {
        const scene::Mesh& mesh = meshes_[index];
        if (!geometry_.count(index)) {
            tinygltf::Primitive primitive;
            primitive.mode = TINYGLTF_MODE_TRIANGLES;
            primitive.attributes["POSITION"] = add_accessor(
                mesh.positions, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
            const Bounds bounds = meshes_.bounds(index);
            for (int c = 0; c < 3; ++c) {
                model_.accessors.back().minValues.push_back(double(bounds.minimum[c]));
                model_.accessors.back().maxValues.push_back(double(bounds.maximum[c]));
            }
            primitive.attributes["NORMAL"] = add_accessor(mesh.normals, TINYGLTF_TYPE_VEC3,
                                                          TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
            primitive.indices = add_accessor(mesh.indices, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                             TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
            geometry_[index] = primitive;
        }
        tinygltf::Mesh target;
        target.name = mesh.name;
        target.primitives.push_back(geometry_[index]);
        target.primitives[0].material = material;
        model_.meshes.push_back(target);
        return int(model_.meshes.size() - 1);
    }

    void set_extension(tinygltf::ExtensionMap& extensions, const std::string& name, const std::string& key,
                       tinygltf::Value value) {
        tinygltf::Value::Object object;
        object[key] = std::move(value);
        extensions[name] = tinygltf::Value(object);
        used_extensions_.insert(name);
    }

    int add_material(const scene::Material& source, const std::string& name) {
        tinygltf::Material material;
        material.name = name;
        material.pbrMetallicRoughness.baseColorFactor = {double(source.base_colour.x), double(source.base_colour.y),
                                                         double(source.base_colour.z), 1.0};
        material.pbrMetallicRoughness.metallicFactor = double(source.metallic);
        material.pbrMetallicRoughness.roughnessFactor = double(source.roughness);
        const vec3 nits = source.emission * luminous_efficacy;
        const float strength = std::max({nits.x, nits.y, nits.z});
        if (strength > 0.0f) {
            const vec3 factor = nits / strength;
            material.emissiveFactor = {double(factor.x), double(factor.y), double(factor.z)};
            set_extension(material.extensions, "KHR_materials_emissive_strength", "emissiveStrength",
                          tinygltf::Value(double(strength)));
        }
        if (!source.specular)
            set_extension(material.extensions, "KHR_materials_specular", "specularFactor", tinygltf::Value(0.0));
        if (source.transmission > 0.0f)
            set_extension(material.extensions, "KHR_materials_transmission", "transmissionFactor",
                          tinygltf::Value(double(source.transmission)));
        if (source.index_of_refraction != 1.5f)
            set_extension(material.extensions, "KHR_materials_ior", "ior",
                          tinygltf::Value(double(source.index_of_refraction)));
        model_.materials.push_back(material);
        return int(model_.materials.size() - 1);
    }

    void add_light(tinygltf::Node& node, const char* type, vec3 strength, const scene::SpotLight* spot) {
        const vec3 photometric = strength * luminous_efficacy;
        const float intensity = std::max({photometric.x, photometric.y, photometric.z, 1e-20f});
        tinygltf::Light light;
        light.name = node.name;
        light.type = type;
        light.intensity = double(intensity);
        for (int c = 0; c < 3; ++c)
            light.color.push_back(double(photometric[c] / intensity));
        if (spot != nullptr) {
            light.spot.innerConeAngle = double(spot->inner_angle);
            light.spot.outerConeAngle = double(spot->outer_angle);
        }
        model_.lights.push_back(light);
        set_extension(node.extensions, "KHR_lights_punctual", "light", tinygltf::Value(int(model_.lights.size() - 1)));
    }

    int add_node(ecs::Entity entity) {
        tinygltf::Node node;
        node.name = registry_.get<scene::Name>(entity).name;
        if (const auto* transform = registry_.try_get<scene::Transform>(entity)) {
            const vec3 p = transform->position, s = transform->scale;
            const quat q = transform->rotation;
            node.translation = {double(p.x), double(p.y), double(p.z)};
            node.rotation = {double(q.x), double(q.y), double(q.z), double(q.w)};
            node.scale = {double(s.x), double(s.y), double(s.z)};
        }
        if (const auto* instance = registry_.try_get<scene::MeshInstance>(entity)) {
            const auto* material = registry_.try_get<scene::Material>(entity);
            node.mesh = add_mesh(instance->mesh, material != nullptr ? add_material(*material, node.name) : -1);
        }
        if (const auto* camera = registry_.try_get<scene::Camera>(entity)) {
            tinygltf::Camera target;
            target.name = node.name;
            target.type = "perspective";
            target.perspective.yfov = double(camera->vertical_field_of_view);
            target.perspective.znear = 0.01;
            target.perspective.zfar = 1000.0; // glTF allows none, but tinygltf writes one always
            model_.cameras.push_back(target);
            node.camera = int(model_.cameras.size() - 1);
        }
        if (const auto* light = registry_.try_get<scene::PointLight>(entity))
            add_light(node, "point", light->intensity, nullptr);
        if (const auto* light = registry_.try_get<scene::SpotLight>(entity))
            add_light(node, "spot", light->intensity, light);
        if (const auto* light = registry_.try_get<scene::DirectionalLight>(entity))
            add_light(node, "directional", light->irradiance, nullptr);
        model_.nodes.push_back(node);
        return int(model_.nodes.size() - 1);
    }

    struct ByIndex {
        bool operator()(ecs::Entity a, ecs::Entity b) const { return a.index < b.index; }
    };
    ecs::Registry& registry_;
    const scene::MeshStore& meshes_;
    tinygltf::Model model_;
    std::map<ecs::Entity, int, ByIndex> node_of_;
    std::map<std::uint32_t, tinygltf::Primitive> geometry_;
    std::set<std::string> used_extensions_;
};

} // namespace

Status export_gltf(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes) {
    const tinygltf::Model model = Exporter(registry, meshes).run();
    std::ostringstream stream;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model, stream, false, true))
        return Error{"cannot write '" + path.string() + "' as glTF"};
    return write_file(path, stream.str());
}

} // namespace sunfleck::io
