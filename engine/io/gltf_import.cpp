#include "engine/core/file.h"
#include "engine/io/gltf.h"
#include "engine/io/gltf_accessor.h"
#include "engine/io/gltf_animation.h"
#include "engine/scene/procedural.h"

#include <algorithm>
#include <cstring>
#include <set>

namespace sunfleck::io {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t depth_limit = 256; // of JSON nesting and of the node hierarchy

// tinygltf's parser recurses: deep nesting would overflow the stack.
bool nesting_is_sane(std::string_view json) {
    std::size_t depth = 0;
    bool in_text = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_text) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                in_text = false;
        } else if (c == '"') {
            in_text = true;
        } else if (c == '{' || c == '[') {
            if (++depth > depth_limit)
                return false;
        } else if ((c == '}' || c == ']') && depth > 0) {
            --depth;
        }
    }
    return true;
}

// Only regular files inside the glTF file's folder.
bool inside_folder(const std::string& file, const fs::path& folder) {
    std::error_code code;
    const fs::path target = fs::weakly_canonical(file, code);
    const fs::path base = fs::weakly_canonical(folder, code);
    const auto [end, unused] = std::mismatch(base.begin(), base.end(), target.begin(), target.end());
    return !code && end == base.end() && fs::is_regular_file(target, code);
}

tinygltf::FsCallbacks make_callbacks(const fs::path& folder) {
    tinygltf::FsCallbacks callbacks{};
    callbacks.user_data = const_cast<fs::path*>(&folder);
    callbacks.FileExists = [](const std::string& name, void* base) {
        return inside_folder(name, *static_cast<fs::path*>(base));
    };
    callbacks.ExpandFilePath = [](const std::string& name, void*) { return name; };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>* out, std::string* error, const std::string& name,
                                 void* base) {
        if (!inside_folder(name, *static_cast<fs::path*>(base))) {
            *error = "'" + name + "' is not a file in the folder of the glTF file";
            return false;
        }
        const auto content = read_file(name);
        if (!content) {
            *error = content.error().message;
            return false;
        }
        out->assign(content->begin(), content->end());
        return true;
    };
    callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
        return false;
    };
    return callbacks;
}

class Importer {
public:
    Importer(const tinygltf::Model& model, ecs::Registry& registry, scene::MeshStore& meshes)
        : model_(model), registry_(registry), meshes_(meshes) {}

    Status run() {
        SUNFLECK_TRY(read_meshes());
        const int scene = model_.defaultScene >= 0 ? model_.defaultScene : 0;
        if (model_.scenes.empty())
            return Error{"it has no scene"};
        if (scene >= int(model_.scenes.size()))
            return Error{"its default scene does not exist"};
        for (const int node : model_.scenes[std::size_t(scene)].nodes)
            SUNFLECK_TRY(check_node(node, 0));
        for (scene::Mesh& mesh : fresh_meshes_)
            mesh_ids_.push_back(meshes_.add(std::move(mesh)));
        for (const int node : model_.scenes[std::size_t(scene)].nodes)
            add_node(node, ecs::null_entity);
        return {};
    }

    // By node; null for nodes outside the scene.
    const std::vector<ecs::Entity>& entities() const { return entities_; }
    ImportReport report;

private:
    Status read_vectors(int accessor, std::vector<vec3>& target) const {
        SUNFLECK_TRY(each_element(model_, accessor, TINYGLTF_TYPE_VEC3, {TINYGLTF_COMPONENT_TYPE_FLOAT},
                                  [&](std::size_t, const unsigned char* address, int) {
                                      float v[3];
                                      std::memcpy(v, address, sizeof v);
                                      target.emplace_back(v[0], v[1], v[2]);
                                  }));
        if (!std::all_of(target.begin(), target.end(), is_finite))
            return Error{"a vertex is not finite"};
        return {};
    }

    Status read_indices(int accessor, std::size_t vertices, std::vector<std::uint32_t>& target) const {
        SUNFLECK_TRY(each_element(model_, accessor, TINYGLTF_TYPE_SCALAR,
                                  {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                                   TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT},
                                  [&](std::size_t, const unsigned char* address, int type) {
                                      std::uint32_t index = 0;
                                      std::memcpy(&index, address,
                                                  std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(type))));
                                      target.push_back(index);
                                  }));
        for (const std::uint32_t index : target)
            if (index >= vertices)
                return Error{"an index points past the last vertex"};
        return {};
    }

    Status read_primitive(const tinygltf::Primitive& primitive, scene::Mesh& mesh) {
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end())
            return Error{"a primitive has no positions"};
        SUNFLECK_TRY(read_vectors(position->second, mesh.positions));
        if (primitive.indices >= 0) {
            SUNFLECK_TRY(read_indices(primitive.indices, mesh.positions.size(), mesh.indices));
        } else {
            for (std::uint32_t i = 0; i < mesh.positions.size(); ++i)
                mesh.indices.push_back(i);
        }
        mesh.indices.resize(mesh.indices.size() / 3 * 3);
        const auto normal = primitive.attributes.find("NORMAL");
        if (normal != primitive.attributes.end())
            SUNFLECK_TRY(read_vectors(normal->second, mesh.normals));
        if (mesh.normals.size() != mesh.positions.size())
            scene::compute_normals(mesh);
        return {};
    }

    Status read_meshes() {
        for (const tinygltf::Mesh& mesh : model_.meshes) {
            first_primitive_.push_back(fresh_meshes_.size());
            for (const tinygltf::Primitive& primitive : mesh.primitives) {
                fresh_meshes_.emplace_back();
                fresh_meshes_.back().name = mesh.name;
                if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != -1) {
                    report.notes.push_back("mesh '" + mesh.name + "': only triangle lists are drawn");
                    continue;
                }
                const Status status = read_primitive(primitive, fresh_meshes_.back());
                if (!status)
                    return Error{"mesh '" + mesh.name + "': " + status.error().message};
            }
        }
        return {};
    }

    Status check_node(int node, std::size_t depth) {
        if (!in_range(node, model_.nodes))
            return Error{"a node does not exist"};
        if (depth > depth_limit || !visited_.insert(node).second)
            return Error{"its nodes form a cycle, or are nested too deeply"};
        for (const int child : model_.nodes[std::size_t(node)].children)
            SUNFLECK_TRY(check_node(child, depth + 1));
        return {};
    }

    static scene::Transform transform_of(const tinygltf::Node& node) {
        scene::Transform transform;
        if (node.matrix.size() == 16) {
            mat4 m;
            for (int i = 0; i < 16; ++i)
                m[i / 4][i % 4] = float(node.matrix[std::size_t(i)]);
            transform.position = vec3(m[3]);
            transform.scale = vec3(glm::length(vec3(m[0])), glm::length(vec3(m[1])), glm::length(vec3(m[2])));
            if (glm::determinant(mat3(m)) < 0.0f)
                transform.scale.x = -transform.scale.x;
            mat3 r(1.0f);
            for (int i = 0; i < 3; ++i)
                if (transform.scale[i] != 0.0f)
                    r[i] = vec3(m[i]) / transform.scale[i];
            transform.rotation = glm::normalize(glm::quat_cast(r));
            return transform;
        }
        if (node.translation.size() == 3)
            transform.position = vec3(node.translation[0], node.translation[1], node.translation[2]);
        if (node.rotation.size() == 4)
            transform.rotation = quat(float(node.rotation[3]), float(node.rotation[0]), float(node.rotation[1]),
                                      float(node.rotation[2]));
        if (node.scale.size() == 3)
            transform.scale = vec3(node.scale[0], node.scale[1], node.scale[2]);
        return transform;
    }

    static double extension_number(const tinygltf::ExtensionMap& extensions, const char* extension, const char* key,
                                   double fallback) {
        const auto found = extensions.find(extension);
        if (found == extensions.end() || !found->second.Has(key))
            return fallback;
        return found->second.Get(key).GetNumberAsDouble();
    }

    scene::Material material_of(int index) const {
        scene::Material material;
        material.specular = true;
        if (!in_range(index, model_.materials))
            return material;
        const tinygltf::Material& source = model_.materials[std::size_t(index)];
        const auto& pbr = source.pbrMetallicRoughness;
        for (int c = 0; c < 3; ++c) {
            if (pbr.baseColorFactor.size() >= 3)
                material.base_colour[c] = float(pbr.baseColorFactor[std::size_t(c)]);
            if (source.emissiveFactor.size() >= 3)
                material.emission[c] = float(source.emissiveFactor[std::size_t(c)]);
        }
        material.metallic = float(pbr.metallicFactor);
        material.roughness = float(pbr.roughnessFactor);
        material.emission *=
            float(extension_number(source.extensions, "KHR_materials_emissive_strength", "emissiveStrength", 1.0)) /
            luminous_efficacy;
        material.specular = extension_number(source.extensions, "KHR_materials_specular", "specularFactor", 1.0) > 0.0;
        material.index_of_refraction = float(extension_number(source.extensions, "KHR_materials_ior", "ior", 1.5));
        material.transmission =
            float(extension_number(source.extensions, "KHR_materials_transmission", "transmissionFactor", 0.0));
        return material;
    }

    void add_light(const tinygltf::Light& light, ecs::Entity entity) {
        vec3 strength(1.0f);
        if (light.color.size() == 3)
            strength = vec3(light.color[0], light.color[1], light.color[2]);
        strength *= float(light.intensity) / luminous_efficacy;
        if (light.type == "directional")
            registry_.emplace<scene::DirectionalLight>(entity, {strength});
        else if (light.type == "spot")
            registry_.emplace<scene::SpotLight>(
                entity, {strength, float(light.spot.innerConeAngle), float(light.spot.outerConeAngle)});
        else
            registry_.emplace<scene::PointLight>(entity, {strength});
    }

    void add_primitive(int mesh, std::size_t primitive, ecs::Entity entity) {
        const std::size_t place = first_primitive_[std::size_t(mesh)] + primitive;
        registry_.emplace<scene::MeshInstance>(entity, {mesh_ids_[place]});
        registry_.emplace<scene::Material>(
            entity, material_of(model_.meshes[std::size_t(mesh)].primitives[primitive].material));
    }

    void add_node(int index, ecs::Entity parent) {
        const tinygltf::Node& node = model_.nodes[std::size_t(index)];
        const ecs::Entity entity = registry_.create();
        entities_.resize(model_.nodes.size());
        entities_[std::size_t(index)] = entity;
        registry_.emplace<scene::Name>(entity, {node.name});
        registry_.emplace<scene::Transform>(entity, transform_of(node));
        if (!parent.is_null())
            registry_.emplace<scene::Parent>(entity, {parent});
        if (in_range(node.mesh, model_.meshes)) {
            const std::size_t primitives = model_.meshes[std::size_t(node.mesh)].primitives.size();
            for (std::size_t p = 0; p < primitives; ++p) {
                ecs::Entity owner = entity;
                if (p > 0) { // further primitives become children: an entity has one material
                    owner = registry_.create();
                    registry_.emplace<scene::Transform>(owner);
                    registry_.emplace<scene::Parent>(owner, {entity});
                }
                add_primitive(node.mesh, p, owner);
            }
        }
        if (in_range(node.camera, model_.cameras)) {
            const tinygltf::Camera& camera = model_.cameras[std::size_t(node.camera)];
            if (camera.type == "perspective")
                registry_.emplace<scene::Camera>(entity, {float(camera.perspective.yfov)});
        }
        const auto light = node.extensions.find("KHR_lights_punctual");
        if (light != node.extensions.end() && light->second.Has("light")) {
            const int which = light->second.Get("light").GetNumberAsInt();
            if (in_range(which, model_.lights))
                add_light(model_.lights[std::size_t(which)], entity);
        }
        for (const int child : node.children)
            add_node(child, entity);
    }

    const tinygltf::Model& model_;
    ecs::Registry& registry_;
    scene::MeshStore& meshes_;
    std::vector<scene::Mesh> fresh_meshes_;
    std::vector<std::uint32_t> mesh_ids_;
    std::vector<std::size_t> first_primitive_;
    std::set<int> visited_;
    std::vector<ecs::Entity> entities_;
};

Status check_extensions(const tinygltf::Model& model) {
    static const std::set<std::string> known = {"KHR_lights_punctual", "KHR_materials_emissive_strength",
                                                "KHR_materials_specular", "KHR_materials_ior",
                                                "KHR_materials_transmission"};
    for (const std::string& name : model.extensionsRequired)
        if (!known.count(name))
            return Error{"it requires the extension " + name + ", which is not supported"};
    return {};
}

} // namespace

Result<ImportReport> import_gltf(const fs::path& path, ecs::Registry& registry, scene::MeshStore& meshes) {
    const auto failure = [&](const std::string& why) { return Error{"cannot import '" + path.string() + "': " + why}; };
    SUNFLECK_ASSIGN(const std::string bytes, read_file(path));
    if (bytes.empty())
        return failure("the file is empty");
    const bool binary = bytes.compare(0, 4, "glTF") == 0;
    std::string_view json = bytes;
    if (binary) { // 12 bytes of header, then the JSON chunk's length and type; what follows may look like anything
        std::uint32_t length = 0;
        if (bytes.size() >= 20)
            std::memcpy(&length, bytes.data() + 12, sizeof length);
        json = json.substr(std::min<std::size_t>(20, bytes.size()), length);
    }
    if (!nesting_is_sane(json))
        return failure("its JSON is nested too deeply");
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(make_callbacks(folder));
    loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                             void*) { return true; },
                          nullptr);
    tinygltf::Model model;
    std::string error, warning;
    const bool loaded = binary ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                                             reinterpret_cast<const unsigned char*>(bytes.data()),
                                                             unsigned(bytes.size()), folder.string())
                               : loader.LoadASCIIFromString(&model, &error, &warning, bytes.data(),
                                                            unsigned(bytes.size()), folder.string());
    if (!loaded) {
        while (!error.empty() && (error.back() == '\n' || error.back() == '\r'))
            error.pop_back();
        return failure(error.empty() ? "it is not valid glTF" : error);
    }
    if (const Status status = check_extensions(model); !status)
        return failure(status.error().message);
    auto animations = read_animations(model);
    if (!animations)
        return failure(animations.error().message);
    Importer importer(model, registry, meshes);
    if (const Status status = importer.run(); !status)
        return failure(status.error().message);
    if (!model.textures.empty())
        importer.report.notes.push_back("textures are left out");
    if (!model.skins.empty())
        importer.report.notes.push_back("skins are left out");
    if (model.animations.size() > 1)
        importer.report.notes.push_back("of several animations the first plays");
    for (auto& [node, animation] : *animations)
        if (const ecs::Entity entity = importer.entities()[std::size_t(node)]; !entity.is_null()) {
            registry.emplace<scene::Mover>(entity, {});
            registry.emplace<scene::Animation>(entity, std::move(animation));
        }
    return importer.report;
}

} // namespace sunfleck::io
