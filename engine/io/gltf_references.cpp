#include "engine/io/gltf_references.h"

#include <algorithm>
#include <span>

namespace sunfleck::io {
namespace {

using nlohmann::json;

// "section[].key" holds the index (or indices) of elements of another section.
struct Reference {
    std::string_view section;
    std::vector<std::string_view> path; // "[]" steps into all elements of an array or object
    std::string_view target;
};

const std::vector<Reference>& references() {
    static const std::vector<Reference> list = {
        {"accessors", {"bufferView"}, "bufferViews"},
        {"accessors", {"sparse", "indices", "bufferView"}, "bufferViews"},
        {"accessors", {"sparse", "values", "bufferView"}, "bufferViews"},
        {"bufferViews", {"buffer"}, "buffers"},
        {"images", {"bufferView"}, "bufferViews"},
        {"textures", {"source"}, "images"},
        {"textures", {"sampler"}, "samplers"},
        {"materials", {"pbrMetallicRoughness", "baseColorTexture", "index"}, "textures"},
        {"materials", {"pbrMetallicRoughness", "metallicRoughnessTexture", "index"}, "textures"},
        {"materials", {"normalTexture", "index"}, "textures"},
        {"materials", {"occlusionTexture", "index"}, "textures"},
        {"materials", {"emissiveTexture", "index"}, "textures"},
        {"meshes", {"primitives", "[]", "material"}, "materials"},
        {"meshes", {"primitives", "[]", "indices"}, "accessors"},
        {"meshes", {"primitives", "[]", "attributes", "[]"}, "accessors"},
        {"meshes", {"primitives", "[]", "targets", "[]", "[]"}, "accessors"},
        {"nodes", {"mesh"}, "meshes"},
        {"nodes", {"camera"}, "cameras"},
        {"nodes", {"skin"}, "skins"},
        {"nodes", {"children", "[]"}, "nodes"},
        {"scenes", {"nodes", "[]"}, "nodes"},
        {"skins", {"joints", "[]"}, "nodes"},
        {"skins", {"skeleton"}, "nodes"},
        {"skins", {"inverseBindMatrices"}, "accessors"},
        {"animations", {"samplers", "[]", "input"}, "accessors"},
        {"animations", {"samplers", "[]", "output"}, "accessors"},
        {"animations", {"channels", "[]", "target", "node"}, "nodes"}};
    return list;
}

// Those of extensions, which their readers check: here they only tell what is used.
const std::vector<Reference>& extension_references() {
    static const std::vector<Reference> list = {
        {"nodes", {"extensions", "EXT_mesh_gpu_instancing", "attributes", "[]"}, "accessors"},
        {"meshes", {"primitives", "[]", "extensions", "KHR_draco_mesh_compression", "bufferView"}, "bufferViews"},
        {"meshes",
         {"primitives", "[]", "extensions", "KHR_materials_variants", "mappings", "[]", "material"},
         "materials"},
        {"bufferViews", {"extensions", "EXT_meshopt_compression", "buffer"}, "buffers"}};
    return list;
}

std::size_t section_size(const json& file, std::string_view name) {
    const auto found = file.find(std::string(name));
    return found != file.end() && found->is_array() ? found->size() : 0;
}

Status check_reference(const json& at, const Reference& reference, std::size_t step, std::size_t targets,
                       const std::string& place) {
    if (step == reference.path.size()) {
        if (!at.is_number_integer() || at.get<std::int64_t>() < 0 || std::uint64_t(at.get<std::int64_t>()) >= targets)
            return Error{place + " is " + at.dump().substr(0, 40) + ", but there are " + std::to_string(targets) + " " +
                         std::string(reference.target)};
        return {};
    }
    const std::string_view key = reference.path[step];
    if (key == "[]") {
        if (!at.is_array() && !at.is_object())
            return Error{place + " must be a list"};
        for (const auto& [name, value] : at.items())
            SUNFLECK_TRY(check_reference(
                value, reference, step + 1, targets,
                std::string(place).append(at.is_array() ? "[" : ".").append(name).append(at.is_array() ? "]" : "")));
        return {};
    }
    if (!at.is_object())
        return Error{place + " must be an object"};
    const auto found = at.find(std::string(key));
    if (found == at.end())
        return {};
    return check_reference(*found, reference, step + 1, targets, place + "." + std::string(key));
}

// Calls found(index) for each index that the reference holds, whether it exists or not.
template <typename Found>
void each_index(const json& at, const Reference& reference, std::size_t step, const Found& found) {
    if (step == reference.path.size()) {
        if (at.is_number_integer() && at.get<std::int64_t>() >= 0)
            found(std::size_t(at.get<std::int64_t>()));
        return;
    }
    const std::string_view key = reference.path[step];
    if (key == "[]") {
        if (at.is_array() || at.is_object())
            for (const json& value : at)
                each_index(value, reference, step + 1, found);
        return;
    }
    if (!at.is_object())
        return;
    if (const auto next = at.find(std::string(key)); next != at.end())
        each_index(*next, reference, step + 1, found);
}

// An element without references that tinygltf accepts.
json empty_element(std::string_view section) {
    if (section == "accessors")
        return {{"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}};
    if (section == "bufferViews")
        return {{"buffer", 0}, {"byteLength", 1}};
    if (section == "meshes")
        return {{"primitives", json::array()}};
    if (section == "skins")
        return {{"joints", json::array()}};
    return json::object();
}

// The parser ends at the first accessor of a type that glTF does not know, used or not.
Status check_types(const json& accessor, const std::string& place) {
    constexpr std::string_view types[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    const auto type = accessor.is_object() ? accessor.find("type") : accessor.end();
    if (!accessor.is_object() || type == accessor.end() || !type->is_string() ||
        std::ranges::find(types, type->get<std::string>()) == std::end(types))
        return Error{place + ".type is none of glTF's"};
    return {};
}

// Leaves out accessors of unknown type that nothing uses; those that are used are left to the parser, which names them.
void leave_out_unknown_types(json& file, const GltfUsage& usage, std::vector<std::string>& notes) {
    for (std::size_t i = 0; i < section_size(file, "accessors"); ++i) {
        const Status status = check_types(file["accessors"][i], "accessors[" + std::to_string(i) + "]");
        if (status || usage.uses("accessors", i))
            continue;
        file["accessors"][i] = empty_element("accessors");
        notes.push_back(status.error().message + "; nothing uses it, so it is left out");
    }
}

} // namespace

GltfUsage::GltfUsage(const json& file) {
    for (const auto& [name, section] : file.items())
        if (section.is_array())
            used_[name].resize(section.size());
    const bool has_scenes = section_size(file, "scenes") > 0;
    for (const char* root : {has_scenes ? "scenes" : "nodes", "animations"})
        for (std::size_t i = 0; i < section_size(file, root); ++i)
            add(file, root, i);
}

void GltfUsage::add(const json& file, const std::string& section, std::size_t index) {
    // Not recursive: a broken file may chain any number of nodes.
    std::vector<std::pair<std::string, std::size_t>> waiting = {{section, index}};
    while (!waiting.empty()) {
        const auto [name, i] = waiting.back();
        waiting.pop_back();
        const auto used = used_.find(name);
        if (used == used_.end() || i >= used->second.size() || used->second[i])
            continue;
        used->second[i] = true;
        for (const std::vector<Reference>* list : {&references(), &extension_references()})
            for (const Reference& reference : *list)
                if (reference.section == name)
                    each_index(file[name][i], reference, 0, [&](std::size_t target) {
                        waiting.emplace_back(std::string(reference.target), target);
                    });
    }
}

bool GltfUsage::uses(std::string_view section, std::size_t index) const {
    const auto used = used_.find(section);
    return used != used_.end() && index < used->second.size() && used->second[index];
}

Status check_references(json& file, std::vector<std::string>& notes) {
    const GltfUsage usage(file);
    leave_out_unknown_types(file, usage, notes);
    for (const Reference& reference : references()) {
        const auto section = file.find(std::string(reference.section));
        if (section == file.end())
            continue;
        const std::size_t targets = section_size(file, reference.target);
        for (std::size_t i = 0; i < section->size(); ++i) {
            Status status = check_reference((*section)[i], reference, 0, targets,
                                            std::string(reference.section) + "[" + std::to_string(i) + "]");
            if (status)
                continue;
            if (usage.uses(reference.section, i))
                return status;
            (*section)[i] = empty_element(reference.section);
            notes.push_back(status.error().message + "; nothing uses it, so it is left out");
        }
    }
    return {};
}

} // namespace sunfleck::io
