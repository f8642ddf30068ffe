#include "engine/core/file.h"
#include "engine/io/encoded_textures.h"
#include "engine/io/gltf.h"
#include "engine/io/gltf_motion_export.h"

#include <cmath>
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
    }

    Result<tinygltf::Model> run(EncodedTextures& encoded) {
        SUNFLECK_TRY(add_textures(encoded));
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
        SUNFLECK_TRY(motion_.finish(node_of_));
        for (const std::string& name : file_.extensions)
            model_.extensionsUsed.push_back(name);
        if (model_.buffers[0].data.empty())
            model_.buffers.clear(); // nor empty buffers
        return std::move(model_);
    }

private:
    // Every texture of the store with its own sampler, under its own index.
    Status add_textures(EncodedTextures& encoded) {
        SUNFLECK_ASSIGN(const auto pictures, encoded.of(textures_));
        for (std::uint32_t i = 0; i < textures_.size(); ++i) {
            const scene::Texture& source = textures_[i];
            const std::string& png = *pictures[i];
            tinygltf::Image image;
            image.name = source.name;
            image.mimeType = "image/png";
            image.bufferView = file_.add_view(png.data(), png.size(), 0);
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

    void add_optional_attributes(const scene::Mesh& mesh, tinygltf::Primitive& primitive) {
        const auto add = [&](const char* name, const auto& values, int type) {
            primitive.attributes[name] =
                file_.add_accessor(values, type, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
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

    tinygltf::Primitive primitive_of(const scene::Mesh& mesh) {
        tinygltf::Primitive primitive;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        const int positions = file_.add_accessor(mesh.positions, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                                 TINYGLTF_TARGET_ARRAY_BUFFER);
        file_.add_bounds(positions, mesh.positions, 3);
        primitive.attributes["POSITION"] = positions;
        primitive.attributes["NORMAL"] = file_.add_accessor(
            mesh.normals, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
        add_optional_attributes(mesh, primitive);
        primitive.indices = file_.add_accessor(mesh.indices, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                               TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
        return primitive;
    }

    // One glTF mesh for each entity, whose material it has. Meshes that deform are written in their rest pose.
    int add_mesh(std::uint32_t index, const scene::Deformation* deformation, int material) {
        const scene::Mesh& mesh = deformation != nullptr ? deformation->source->rest : meshes_[index];
        const auto [known, is_new] = geometry_.try_emplace(&mesh);
        if (is_new) {
            known->second = primitive_of(mesh);
            if (deformation != nullptr)
                motion_.add_deformation(*deformation->source, known->second);
        }
        tinygltf::Mesh target;
        target.name = mesh.name;
        target.primitives.push_back(known->second);
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
        file_.extensions.insert("KHR_texture_transform");
    }

    void set_extension(tinygltf::ExtensionMap& extensions, const std::string& name, const std::string& key,
                       tinygltf::Value value) {
        tinygltf::Value::Object object;
        object[key] = std::move(value);
        extensions[name] = tinygltf::Value(object);
        file_.extensions.insert(name);
    }

    void add_transmission(const scene::Material& source, const scene::MaterialTextures* textures,
                          tinygltf::Material& material) {
        const bool has_texture = textures != nullptr && textures->transmission;
        if (source.transmission <= 0.0f && !has_texture)
            return;
        tinygltf::Value::Object object;
        object["transmissionFactor"] = tinygltf::Value(double(source.transmission));
        if (has_texture) {
            tinygltf::TextureInfo info;
            set_texture(info, textures->transmission);
            tinygltf::Value::Object texture;
            texture["index"] = tinygltf::Value(info.index);
            texture["texCoord"] = tinygltf::Value(info.texCoord);
            if (!info.extensions.empty())
                texture["extensions"] = tinygltf::Value(info.extensions);
            object["transmissionTexture"] = tinygltf::Value(texture);
        }
        material.extensions["KHR_materials_transmission"] = tinygltf::Value(object);
        file_.extensions.insert("KHR_materials_transmission");
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
            file_.extensions.insert("KHR_materials_unlit");
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
        add_transmission(source, textures, material);
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

    void place(const scene::Transform& transform, tinygltf::Node& node) {
        const vec3 p = transform.position, s = transform.scale;
        const quat q = transform.rotation;
        node.translation = {double(p.x), double(p.y), double(p.z)};
        node.rotation = {double(q.x), double(q.y), double(q.z), double(q.w)};
        node.scale = {double(s.x), double(s.y), double(s.z)};
    }

    int add_node(ecs::Entity entity) {
        tinygltf::Node node;
        node.name = registry_.get<scene::Name>(entity).name;
        const auto* instance = registry_.try_get<scene::MeshInstance>(entity);
        const auto* deformation = instance != nullptr ? deformation_of(registry_, entity) : nullptr;
        const bool skinned = deformation != nullptr && deformation->source->influences > 0;
        // Other programs ignore the places of nodes with skins, which the format's validator warns of.
        const auto* transform = registry_.try_get<scene::Transform>(entity);
        if (transform != nullptr && !(skinned && transform->matrix() == mat4(1.0f)))
            place(*transform, node);
        if (instance != nullptr) {
            const auto* material = registry_.try_get<scene::Material>(entity);
            node.mesh =
                add_mesh(instance->mesh, deformation,
                         material != nullptr
                             ? add_material(*material, registry_.try_get<scene::MaterialTextures>(entity), node.name)
                             : -1);
        }
        if (deformation != nullptr)
            motion_.add_node(*deformation, int(model_.nodes.size()), node);
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

    ecs::Registry& registry_;
    const scene::MeshStore& meshes_;
    const scene::TextureStore& textures_;
    GltfWriter file_;
    tinygltf::Model& model_ = file_.model;
    MotionExport motion_{file_, registry_};
    NodeNumbers node_of_;
    std::map<const scene::Mesh*, tinygltf::Primitive> geometry_;
};

} // namespace

Result<std::string> gltf_bytes(ecs::Registry& registry, const scene::MeshStore& meshes,
                               const scene::TextureStore& textures, EncodedTextures* encoded) {
    EncodedTextures once;
    SUNFLECK_ASSIGN(tinygltf::Model model,
                    Exporter(registry, meshes, textures).run(encoded != nullptr ? *encoded : once));
    std::ostringstream stream;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model, stream, false, true))
        return Error{"it cannot be expressed as glTF"};
    return std::move(stream).str();
}

Status export_gltf(const std::filesystem::path& path, ecs::Registry& registry, const scene::MeshStore& meshes,
                   const scene::TextureStore& textures) {
    const auto bytes = gltf_bytes(registry, meshes, textures);
    if (!bytes)
        return Error{"cannot write '" + path.string() + "': " + bytes.error().message, bytes.error().code};
    return write_file(path, *bytes);
}

} // namespace sunfleck::io
