// From a checked document to entities. Everything that can fail comes first; then the registry is filled.
#include "engine/core/file.h"
#include "engine/io/gltf.h"
#include "engine/io/gltf_animation.h"
#include "engine/io/gltf_checks.h"
#include "engine/io/gltf_materials.h"
#include "engine/io/gltf_meshes.h"
#include "engine/io/gltf_nodes.h"
#include "engine/io/gltf_writer.h"
#include "engine/io/uri.h"

#include <algorithm>
#include <exception>

namespace sunfleck::io {
namespace {

namespace fs = std::filesystem;

Result<int> find_variant(const tinygltf::Model& model, const std::string& wanted, ImportReport& report) {
    const auto found = model.extensions.find("KHR_materials_variants");
    if (found != model.extensions.end() && found->second.Has("variants")) {
        const tinygltf::Value& list = found->second.Get("variants");
        for (std::size_t i = 0; list.IsArray() && i < list.ArrayLen(); ++i) {
            const tinygltf::Value& entry = list.Get(int(i));
            const bool named = entry.Has("name") && entry.Get("name").IsString();
            report.variants.push_back(named ? entry.Get("name").Get<std::string>() : "variant " + std::to_string(i));
        }
    }
    if (wanted.empty())
        return -1;
    const auto place = std::find(report.variants.begin(), report.variants.end(), wanted);
    if (place == report.variants.end())
        return Error{"it has no material variant '" + wanted + "'"};
    return int(place - report.variants.begin());
}

Status read_skins(const GltfDocument& document, GltfContent& content) {
    const tinygltf::Model& model = document.model;
    for (std::size_t i = 0; i < model.skins.size(); ++i) {
        const tinygltf::Skin& source = model.skins[i];
        const std::string place = "skin " + std::to_string(i);
        ImportedSkin skin;
        skin.joints = source.joints;
        if (skin.joints.empty() && document.usage.uses("skins", i))
            return Error{place + " has no joints"};
        skin.inverse_bind_matrices.assign(skin.joints.size(), mat4(1.0f));
        if (source.inverseBindMatrices >= 0) {
            auto elements =
                read_floats(model, source.inverseBindMatrices, {{TINYGLTF_TYPE_MAT4}, {TINYGLTF_COMPONENT_TYPE_FLOAT}});
            if (!elements)
                return Error{place + ": " + elements.error().message};
            if (elements->count() < skin.joints.size())
                return Error{place + " has fewer inverse bind matrices than joints"};
            for (std::size_t j = 0; j < skin.joints.size(); ++j)
                for (int c = 0; c < 16; ++c)
                    skin.inverse_bind_matrices[j][c / 4][c % 4] = (*elements)[j][c];
        }
        content.skins.push_back(std::move(skin));
    }
    return {};
}

// Without them, there is nothing to draw (glTF 2.0, sec. 3.7.2.1).
bool has_positions(const tinygltf::Primitive& primitive) {
    return primitive.attributes.count("POSITION") > 0 || primitive.extensions.count("KHR_draco_mesh_compression") > 0;
}

Status read_meshes(const GltfDocument& document, GltfContent& content, ImportReport& report,
                   const std::function<bool(float)>& progress) {
    const tinygltf::Model& model = document.model;
    for (std::size_t m = 0; m < model.meshes.size(); ++m) {
        if (progress && !progress(float(m) / float(model.meshes.size())))
            return Error{"stopped"};
        const tinygltf::Mesh& mesh = model.meshes[m];
        content.meshes.emplace_back();
        for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
            if (!has_positions(mesh.primitives[p])) {
                report.notes.push_back("mesh " + std::to_string(m) + " ('" + mesh.name + "'), primitive " +
                                       std::to_string(p) + ": it has no POSITION and is not drawn");
                continue;
            }
            auto primitive = read_primitive(model, mesh.primitives[p], report.variants.size());
            if (!primitive) {
                const std::string problem = "mesh " + std::to_string(m) + " ('" + mesh.name + "'), primitive " +
                                            std::to_string(p) + ": " + primitive.error().message;
                if (document.usage.uses("meshes", m))
                    return Error{problem, primitive.error().code};
                report.notes.push_back(problem + "; nothing uses it, so it is left out");
                continue;
            }
            primitive->mesh.rest.name = mesh.name.empty() ? "mesh " + std::to_string(m) : mesh.name;
            if (!primitive->drawn)
                report.notes.push_back("mesh '" + primitive->mesh.rest.name +
                                       "': has too many points or lines and is not drawn");
            content.meshes.back().push_back(std::move(*primitive));
        }
    }
    return {};
}

// Joint indices beyond the skin would read past its end.
Status check_skinned_nodes(const tinygltf::Model& model, const GltfContent& content) {
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        const tinygltf::Node& node = model.nodes[i];
        if (!in_range(node.skin, content.skins) || !in_range(node.mesh, content.meshes))
            continue;
        const std::size_t joints = content.skins[std::size_t(node.skin)].joints.size();
        for (const ImportedPrimitive& primitive : content.meshes[std::size_t(node.mesh)])
            for (const std::uint32_t joint : primitive.mesh.joints)
                if (joint >= joints)
                    return Error{"node " + std::to_string(i) + ": a vertex names joint " + std::to_string(joint) +
                                 " of " + std::to_string(joints)};
    }
    return {};
}

void add_tangents(GltfContent& content) {
    for (auto& mesh : content.meshes)
        for (ImportedPrimitive& primitive : mesh) {
            const scene::MaterialTextures& textures = content.materials.material(primitive.material).textures;
            scene::Mesh& rest = primitive.mesh.rest;
            if (textures.normal && rest.tangents.empty() && !rest.texture_coordinates.empty())
                generate_tangents(rest, int(textures.normal.set));
        }
}

std::vector<int> roots_of(const tinygltf::Model& model, int scene) {
    if (in_range(scene, model.scenes))
        return model.scenes[std::size_t(scene)].nodes;
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes)
        for (const int child : node.children)
            is_child[std::size_t(child)] = true;
    std::vector<int> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i)
        if (!is_child[i])
            roots.push_back(int(i));
    return roots;
}

Result<int> choose_scene(const tinygltf::Model& model, const ImportOptions& options, ImportReport& report) {
    for (std::size_t i = 0; i < model.scenes.size(); ++i)
        report.scenes.push_back(model.scenes[i].name.empty() ? "scene " + std::to_string(i) : model.scenes[i].name);
    if (options.scene >= 0 && !in_range(options.scene, model.scenes))
        return Error{"it has no scene " + std::to_string(options.scene) + " (it has " +
                     std::to_string(model.scenes.size()) + ")"};
    if (options.scene >= 0)
        return options.scene;
    if (model.defaultScene >= 0 && !in_range(model.defaultScene, model.scenes))
        return Error{"its default scene " + std::to_string(model.defaultScene) + " does not exist"};
    if (model.scenes.empty())
        report.notes.push_back("it has no scene: all its nodes are imported");
    return model.defaultScene >= 0 ? model.defaultScene : 0;
}

Result<int> choose_animation(const tinygltf::Model& model, const ImportOptions& options, ImportReport& report) {
    for (std::size_t i = 0; i < model.animations.size(); ++i) {
        const std::string& name = model.animations[i].name;
        report.animations.push_back(name.empty() ? "animation " + std::to_string(i) : name);
    }
    if (options.animation >= int(model.animations.size()) && options.animation > 0)
        return Error{"it has no animation " + std::to_string(options.animation) + " (it has " +
                     std::to_string(model.animations.size()) + ")"};
    // What had been played is no longer in the scene that was saved.
    if (options.animation == 0 && !model.animations.empty() && is_marked(model.animations[0].extras, mark_not_played))
        return -1;
    return options.animation;
}

// Animations that nothing plays need not be whole.
void read_other_animations(const tinygltf::Model& model, int played, GltfContent& content, ImportReport& report) {
    content.for_saving = true;
    for (int i = 0; i < int(model.animations.size()); ++i) {
        if (i == played)
            continue;
        if (auto other = read_animation(model, i))
            content.other_animations.push_back(std::move(*other));
        else
            report.notes.push_back(other.error().message + "; it is not played, and is not kept");
    }
}

void note_extensions(const tinygltf::Model& model, ImportReport& report) {
    for (const std::string& name : model.extensionsUsed)
        if (!is_known_extension(name))
            report.notes.push_back("extension " + name + " is ignored");
    bool relative = false;
    for (const tinygltf::Material& material : model.materials) {
        const auto& factor = material.emissiveFactor;
        relative = relative || (!material.extensions.count("KHR_materials_emissive_strength") &&
                                std::any_of(factor.begin(), factor.end(), [](double v) { return v > 0.0; }));
    }
    if (relative)
        report.notes.push_back(
            "emission without KHR_materials_emissive_strength has no unit: 1 is read as 0.5 W/(sr m2)");
}

void count_content(const GltfContent& content, const scene::TextureStore& textures, std::uint32_t first_texture,
                   ImportReport& report) {
    for (const auto& mesh : content.meshes)
        for (const ImportedPrimitive& primitive : mesh) {
            const scene::Mesh& rest = primitive.mesh.rest;
            report.counts["triangles"] += rest.triangle_count();
            report.memory_bytes["indices"] += rest.indices.size() * sizeof(std::uint32_t);
            report.memory_bytes["vertices"] +=
                rest.positions.size() * 2 * sizeof(vec3) +
                (rest.texture_coordinates.size() + rest.tangents.size() + rest.colours.size()) * sizeof(vec4);
        }
    for (std::uint32_t i = first_texture; i < textures.size(); ++i)
        report.memory_bytes["textures"] += textures[i].pixels.size();
    report.counts["textures"] = textures.size() - first_texture;
}

// One half of the whole, from `begin` on.
std::function<bool(float)> part_of(const std::function<bool(float)>& progress, float begin) {
    if (!progress)
        return {};
    return [&progress, begin](float share) { return progress(begin + 0.5f * share); };
}

Result<ImportReport> import_document(Result<GltfDocument> read, ecs::Registry& registry, scene::MeshStore& meshes,
                                     scene::TextureStore& textures, const ImportOptions& options) {
    if (!read)
        return read.error();
    const GltfDocument& document = *read;
    const tinygltf::Model& model = document.model;
    ImportReport report;
    report.notes = document.notes;
    note_extensions(model, report);
    SUNFLECK_ASSIGN(const int scene, choose_scene(model, options, report));
    GltfContent content;
    SUNFLECK_ASSIGN(content.variant, find_variant(model, options.variant, report));
    // Which of both takes longer cannot be told beforehand.
    SUNFLECK_ASSIGN(content.materials, MaterialImport::read(document, part_of(options.progress, 0.0f)));
    report.notes.insert(report.notes.end(), content.materials.notes.begin(), content.materials.notes.end());
    SUNFLECK_TRY(read_meshes(document, content, report, part_of(options.progress, 0.5f)));
    SUNFLECK_TRY(read_skins(document, content));
    SUNFLECK_TRY(check_skinned_nodes(model, content));
    SUNFLECK_ASSIGN(const int played, choose_animation(model, options, report));
    SUNFLECK_ASSIGN(content.animations, read_animation(model, played));
    if (options.for_saving)
        read_other_animations(model, played, content, report);
    add_tangents(content);
    SUNFLECK_ASSIGN(NodeImport nodes, NodeImport::read(model, std::move(content)));
    const std::uint32_t first_texture = textures.size();
    nodes.add_to(registry, meshes, textures, roots_of(model, scene));
    report.notes.insert(report.notes.end(), nodes.notes.begin(), nodes.notes.end());
    report.counts["nodes"] = model.nodes.size();
    report.counts["meshes"] = model.meshes.size();
    report.counts["materials"] = model.materials.size();
    report.counts["images"] = document.images.size();
    report.counts["skins"] = model.skins.size();
    report.counts["cameras"] = model.cameras.size();
    report.counts["lights"] = model.lights.size();
    count_content(nodes.content(), textures, first_texture, report);
    if (model.animations.size() > 1 && played >= 0)
        report.notes.push_back("of " + std::to_string(model.animations.size()) + " animations, '" +
                               report.animations[std::size_t(played)] + "' is played");
    return report;
}

template <typename Import>
Result<ImportReport> guarded(const std::string& what, const Import& import) {
    // tinygltf, Draco and containers throw; no exception leaves this function.
    try {
        auto report = import();
        return report ? std::move(report)
                      : Error{"cannot import " + what + ": " + one_line(report.error().message), report.error().code};
    } catch (const std::bad_alloc&) {
        return Error{"cannot import " + what + ": out of memory", ErrorCode::memory};
    } catch (const std::exception& exception) {
        return Error{"cannot import " + what + ": it is not valid glTF (" + exception.what() + ")"};
    }
}

} // namespace

Result<ImportReport> import_gltf(const fs::path& path, ecs::Registry& registry, scene::MeshStore& meshes,
                                 scene::TextureStore& textures, const ImportOptions& options) {
    const fs::path folder = real_folder(path);
    const FileAccess access{options.root.empty() ? folder : options.root, options.allow_outside, options.content_hash};
    FileAccess named = access; // the user's choice, unless a scene file names it
    named.allow_outside = options.root.empty() || options.allow_outside;
    return guarded("'" + path.string() + "'", [&]() -> Result<ImportReport> {
        SUNFLECK_ASSIGN(std::string bytes, named.read(path));
        return import_document(parse_gltf_document(std::move(bytes), folder, access), registry, meshes, textures,
                               options);
    });
}

Result<ImportReport> import_gltf_bytes(std::string bytes, ecs::Registry& registry, scene::MeshStore& meshes,
                                       scene::TextureStore& textures, const ImportOptions& options) {
    return guarded("the file", [&] {
        return import_document(parse_gltf_document(std::move(bytes), {}, {}), registry, meshes, textures, options);
    });
}

} // namespace sunfleck::io
