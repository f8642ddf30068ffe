#include "engine/core/file.h"
#include "engine/io/gltf.h"
#include "engine/io/image.h"

#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace sunfleck::io {
namespace {

// A power of light as glTF has it: a photometric strength and a colour of at most 1.
struct Brightness {
    double photometric = luminous_efficacy;
    std::vector<double> colour;
};

// The strength is a power of two times the luminous efficacy, so that the product of both is read as it was, to the
// bit.
Brightness brightness_of(vec3 power) {
    int exponent = 0;
    std::frexp(std::max({power.x, power.y, power.z}), &exponent);
    Brightness result;
    result.photometric *= std::ldexp(1.0, exponent);
    for (int c = 0; c < 3; ++c)
        result.colour.push_back(std::ldexp(double(power[c]), -exponent));
    return result;
}

class Exporter {
public:
    Exporter(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore& textures)
        : registry_(registry), meshes_(meshes), textures_(textures) {
        model_.asset.version = "2.0";
        model_.asset.generator = "sunfleck";
        model_.buffers.emplace_back();
    }

    Result<tinygltf::Model> run() {
        SUNFLECK_TRY(add_textures());
        for (const ecs::Entity entity : registry_.entities())
            if (registry_.has<scene::Name>(entity))
                node_of_[entity] = add_node(entity);
        if (!node_of_.empty()) { // glTF has no empty scenes
            model_.scenes.emplace_back();
            model_.defaultScene = 0;
        }
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
        if (model_.buffers[0].data.empty())
            model_.buffers.clear(); // nor empty buffers
        return std::move(model_);
    }

private:
    int add_view(const void* bytes, std::size_t size, int target) {
        std::vector<unsigned char>& data = model_.buffers[0].data;
        data.resize((data.size() + 3) / 4 * 4); // accessors begin at multiples of their components' size
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = data.size();
        view.byteLength = size;
        view.target = target;
        const auto* first = static_cast<const unsigned char*>(bytes);
        data.insert(data.end(), first, first + size);
        model_.bufferViews.push_back(view);
        return int(model_.bufferViews.size() - 1);
    }

    // Every texture of the store with its own sampler, under its own index.
    Status add_textures() {
        for (std::uint32_t i = 0; i < textures_.size(); ++i) {
            const scene::Texture& source = textures_[i];
            SUNFLECK_ASSIGN(const std::string png, encode_png(source.width, source.height, source.pixels));
            tinygltf::Image image;
            image.name = source.name;
            image.mimeType = "image/png";
            image.bufferView = add_view(png.data(), png.size(), 0);
            model_.images.push_back(image);
            tinygltf::Sampler sampler;
            sampler.wrapS = wrap_mode(source.wrap_u);
            sampler.wrapT = wrap_mode(source.wrap_v);
            sampler.magFilter = source.nearest ? TINYGLTF_TEXTURE_FILTER_NEAREST : TINYGLTF_TEXTURE_FILTER_LINEAR;
            sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
            model_.samplers.push_back(sampler);
            tinygltf::Texture texture;
            texture.source = texture.sampler = int(i);
            model_.textures.push_back(texture);
        }
        return {};
    }

    static int wrap_mode(scene::TextureWrap wrap) {
        return wrap == scene::TextureWrap::repeat            ? TINYGLTF_TEXTURE_WRAP_REPEAT
               : wrap == scene::TextureWrap::mirrored_repeat ? TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT
                                                             : TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    }

    template <typename T>
    int add_accessor(const std::vector<T>& values, int type, int component, int target) {
        tinygltf::Accessor accessor;
        accessor.bufferView = add_view(values.data(), values.size() * sizeof(T), target);
        accessor.componentType = component;
        accessor.type = type;
        accessor.count = values.size();
        model_.accessors.push_back(accessor);
        return int(model_.accessors.size() - 1);
    }

    void add_optional_attributes(const scene::Mesh& mesh, tinygltf::Primitive& primitive) {
        const auto add = [&](const char* name, const auto& values, int type) {
            primitive.attributes[name] =
                add_accessor(values, type, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
        };
        if (!mesh.texture_coordinates.empty()) {
            std::vector<vec2> sets[2];
            for (const vec4 both : mesh.texture_coordinates) {
                sets[0].emplace_back(both.x, both.y);
                sets[1].emplace_back(both.z, both.w);
            }
            add("TEXCOORD_0", sets[0], TINYGLTF_TYPE_VEC2);
            add("TEXCOORD_1", sets[1], TINYGLTF_TYPE_VEC2);
        }
        if (!mesh.tangents.empty())
            add("TANGENT", mesh.tangents, TINYGLTF_TYPE_VEC4);
        if (!mesh.colours.empty())
            add("COLOR_0", mesh.colours, TINYGLTF_TYPE_VEC4);
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
            add_optional_attributes(mesh, primitive);
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

    template <typename Info>
    void set_texture(Info& target, const scene::TextureUse& use) {
        if (!use)
            return;
        target.index = use.texture;
        target.texCoord = int(use.set);
        if (use.offset == vec2(0.0f) && use.scale == vec2(1.0f) && use.rotation == 0.0f)
            return;
        const auto pair = [](vec2 value) {
            return tinygltf::Value(
                tinygltf::Value::Array{tinygltf::Value(double(value.x)), tinygltf::Value(double(value.y))});
        };
        tinygltf::Value::Object transform;
        transform["offset"] = pair(use.offset);
        transform["scale"] = pair(use.scale);
        transform["rotation"] = tinygltf::Value(double(use.rotation));
        target.extensions["KHR_texture_transform"] = tinygltf::Value(transform);
        used_extensions_.insert("KHR_texture_transform");
    }

    void set_extension(tinygltf::ExtensionMap& extensions, const std::string& name, const std::string& key,
                       tinygltf::Value value) {
        tinygltf::Value::Object object;
        object[key] = std::move(value);
        extensions[name] = tinygltf::Value(object);
        used_extensions_.insert(name);
    }

    int add_material(const scene::Material& source, const scene::MaterialTextures* textures, const std::string& name) {
        tinygltf::Material material;
        material.name = name;
        material.pbrMetallicRoughness.baseColorFactor = {double(source.base_colour.x), double(source.base_colour.y),
                                                         double(source.base_colour.z), double(source.alpha)};
        material.doubleSided = source.double_sided;
        if (source.alpha_mode != scene::AlphaMode::opaque)
            material.alphaMode = source.alpha_mode == scene::AlphaMode::mask ? "MASK" : "BLEND";
        material.alphaCutoff = double(source.alpha_cutoff);
        if (source.unlit) {
            material.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object());
            used_extensions_.insert("KHR_materials_unlit");
        }
        if (textures != nullptr) {
            set_texture(material.pbrMetallicRoughness.baseColorTexture, textures->base_colour);
            set_texture(material.pbrMetallicRoughness.metallicRoughnessTexture, textures->metallic_roughness);
            set_texture(material.normalTexture, textures->normal);
            material.normalTexture.scale = double(textures->normal_scale);
            set_texture(material.emissiveTexture, textures->emission);
        }
        material.pbrMetallicRoughness.metallicFactor = double(source.metallic);
        material.pbrMetallicRoughness.roughnessFactor = double(source.roughness);
        if (source.emission != vec3(0.0f)) {
            const Brightness emission = brightness_of(source.emission);
            material.emissiveFactor = emission.colour;
            set_extension(material.extensions, "KHR_materials_emissive_strength", "emissiveStrength",
                          tinygltf::Value(emission.photometric));
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
        const Brightness brightness = brightness_of(strength);
        tinygltf::Light light;
        light.name = node.name;
        light.type = type;
        light.intensity = brightness.photometric;
        light.color = brightness.colour;
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
            node.mesh =
                add_mesh(instance->mesh,
                         material != nullptr
                             ? add_material(*material, registry_.try_get<scene::MaterialTextures>(entity), node.name)
                             : -1);
        }
        if (const auto* camera = registry_.try_get<scene::Camera>(entity)) {
            tinygltf::Camera target;
            target.name = node.name;
            target.type = "perspective";
            target.perspective.yfov = double(camera->vertical_field_of_view);
            target.perspective.znear = 0.01;
            target.perspective.zfar = 1000.0; // optional in glTF, but tinygltf always writes one
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
    const scene::TextureStore& textures_;
    tinygltf::Model model_;
    std::map<ecs::Entity, int, ByIndex> node_of_;
    std::map<std::uint32_t, tinygltf::Primitive> geometry_;
    std::set<std::string> used_extensions_;
};

} // namespace

Status export_gltf(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes,
                   const scene::TextureStore& textures) {
    auto model = Exporter(registry, meshes, textures).run();
    if (!model)
        return Error{"cannot write '" + path.string() + "': " + model.error().message};
    std::ostringstream stream;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&*model, stream, false, true))
        return Error{"cannot write '" + path.string() + "' as glTF"};
    return write_file(path, stream.str());
}

} // namespace sunfleck::io
