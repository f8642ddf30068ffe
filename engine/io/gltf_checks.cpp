#include "engine/io/gltf_checks.h"

#include "engine/io/gltf_references.h"

#include <algorithm>
#include <array>
#include <set>

namespace sunfleck::io {
namespace {

using nlohmann::json;
constexpr std::size_t section_limit = 1u << 20; // elements of a section

constexpr std::array known_extensions = {
    std::string_view("KHR_lights_punctual"),       std::string_view("KHR_materials_emissive_strength"),
    std::string_view("KHR_materials_unlit"),       std::string_view("KHR_materials_ior"),
    std::string_view("KHR_materials_specular"),    std::string_view("KHR_materials_transmission"),
    std::string_view("KHR_materials_variants"),    std::string_view("KHR_texture_transform"),
    std::string_view("KHR_mesh_quantization"),     std::string_view("KHR_node_visibility"),
    std::string_view("EXT_mesh_gpu_instancing"),   std::string_view("EXT_meshopt_compression"),
    std::string_view("KHR_draco_mesh_compression")};

// A property whose type tinygltf does not check. `kinds`: n number, s string, b boolean, a list of numbers, o object.
struct Property {
    std::string_view section;
    std::vector<std::string_view> path;
    char kind;
};

const std::vector<Property>& properties() {
    static const std::vector<Property> list = {
        {"accessors", {"count"}, 'n'},
        {"accessors", {"componentType"}, 'n'},
        {"accessors", {"byteOffset"}, 'n'},
        {"accessors", {"normalized"}, 'b'},
        {"accessors", {"type"}, 's'},
        {"animations", {"samplers", "[]", "interpolation"}, 's'},
        {"animations", {"channels", "[]", "target", "path"}, 's'},
        {"bufferViews", {"byteStride"}, 'n'},
        {"cameras", {"type"}, 's'},
        {"materials", {"emissiveFactor"}, 'a'},
        {"materials", {"alphaMode"}, 's'},
        {"materials", {"alphaCutoff"}, 'n'},
        {"materials", {"doubleSided"}, 'b'},
        {"materials", {"extensions"}, 'o'},
        {"materials", {"normalTexture", "scale"}, 'n'},
        {"materials", {"pbrMetallicRoughness", "baseColorFactor"}, 'a'},
        {"materials", {"pbrMetallicRoughness", "metallicFactor"}, 'n'},
        {"materials", {"pbrMetallicRoughness", "roughnessFactor"}, 'n'},
        {"materials", {"pbrMetallicRoughness", "baseColorTexture", "texCoord"}, 'n'},
        {"materials", {"pbrMetallicRoughness", "baseColorTexture", "extensions"}, 'o'},
        {"materials", {"pbrMetallicRoughness", "baseColorTexture", "extensions", "KHR_texture_transform"}, 'o'},
        {"materials",
         {"pbrMetallicRoughness", "baseColorTexture", "extensions", "KHR_texture_transform", "offset"},
         'a'},
        {"materials",
         {"pbrMetallicRoughness", "baseColorTexture", "extensions", "KHR_texture_transform", "scale"},
         'a'},
        {"materials",
         {"pbrMetallicRoughness", "baseColorTexture", "extensions", "KHR_texture_transform", "rotation"},
         'n'},
        {"meshes", {"weights"}, 'a'},
        {"meshes", {"primitives", "[]", "mode"}, 'n'},
        {"nodes", {"matrix"}, 'a'},
        {"nodes", {"translation"}, 'a'},
        {"nodes", {"rotation"}, 'a'},
        {"nodes", {"scale"}, 'a'},
        {"nodes", {"weights"}, 'a'},
        {"nodes", {"extensions"}, 'o'},
        {"samplers", {"wrapS"}, 'n'},
        {"samplers", {"wrapT"}, 'n'}};
    return list;
}

Status check_kind(const json& at, char kind, const std::string& place) {
    const bool right =
        kind == 'n'   ? at.is_number()
        : kind == 's' ? at.is_string()
        : kind == 'b' ? at.is_boolean()
        : kind == 'o' ? at.is_object()
                      : at.is_array() && std::all_of(at.begin(), at.end(), [](const json& v) { return v.is_number(); });
    const char* expected = kind == 'n'   ? "a number"
                           : kind == 's' ? "text"
                           : kind == 'b' ? "true or false"
                           : kind == 'o' ? "an object"
                                         : "a list of numbers";
    if (right)
        return {};
    return Error{place + " is " + at.dump(-1, ' ', true, json::error_handler_t::replace).substr(0, 40) + "; " +
                 expected + " is needed"};
}

Status check_property(const json& at, const Property& property, std::size_t step, const std::string& place) {
    if (step == property.path.size())
        return check_kind(at, property.kind, place);
    const std::string_view key = property.path[step];
    if (key == "[]") {
        for (const auto& [name, value] : at.items())
            SUNFLECK_TRY(
                check_property(value, property, step + 1, std::string(place).append("[").append(name).append("]")));
        return {};
    }
    if (!at.is_object())
        return Error{place + " must be an object"};
    const auto found = at.find(std::string(key));
    return found == at.end() ? Status() : check_property(*found, property, step + 1, place + "." + std::string(key));
}

Status check_names(const json& file, const char* section) {
    const auto found = file.find(section);
    if (found == file.end())
        return {};
    for (std::size_t i = 0; i < found->size(); ++i)
        if (const auto name = (*found)[i].find("name"); name != (*found)[i].end())
            SUNFLECK_TRY(check_kind(*name, 's', std::string(section) + "[" + std::to_string(i) + "].name"));
    return {};
}

Status check_sections(const json& file) {
    for (const char* section : {"accessors", "animations", "bufferViews", "buffers", "cameras", "images", "materials",
                                "meshes", "nodes", "samplers", "scenes", "skins", "textures"}) {
        const auto found = file.find(section);
        if (found == file.end())
            continue;
        if (!found->is_array() || found->size() > section_limit)
            return Error{std::string("'") + section + "' must be a list of at most " + std::to_string(section_limit) +
                         " elements"};
        for (const json& element : *found)
            if (!element.is_object())
                return Error{std::string("'") + section + "' must hold objects"};
    }
    return {};
}

// A node has at most one parent, so the nodes form trees unless there is a cycle.
Status check_nodes(const json& file) {
    const auto nodes = file.find("nodes");
    if (nodes == file.end())
        return {};
    std::vector<std::int64_t> parent(nodes->size(), -1);
    for (std::size_t i = 0; i < nodes->size(); ++i)
        if (const auto children = (*nodes)[i].find("children"); children != (*nodes)[i].end())
            for (const json& child : *children) {
                const std::size_t index = child.get<std::size_t>();
                if (parent[index] >= 0 || index == i)
                    return Error{"node " + std::to_string(index) + " has two parents or is its own"};
                parent[index] = std::int64_t(i);
            }
    for (std::size_t i = 0; i < parent.size(); ++i) {
        std::int64_t at = parent[i];
        for (std::size_t depth = 0; at >= 0; ++depth, at = parent[std::size_t(at)])
            if (depth > nesting_limit)
                return Error{"node " + std::to_string(i) + " is nested more than " + std::to_string(nesting_limit) +
                             " deep, or in a cycle"};
    }
    return {};
}

// Views may be equal, nested or overlap in any way, and what is read of them may add up to much more than the file has:
// that is counted where it is taken (check_memory).
Status check_views(const json& file) {
    const auto views = file.find("bufferViews");
    if (views == file.end())
        return {};
    for (std::size_t i = 0; i < views->size(); ++i) {
        const json& view = (*views)[i];
        const auto number = [&](const char* key, std::int64_t fallback) -> std::int64_t {
            const auto found = view.find(key);
            return found == view.end() ? fallback : found->is_number_integer() ? found->get<std::int64_t>() : -1;
        };
        const std::int64_t buffer = number("buffer", -1), begin = number("byteOffset", 0),
                           length = number("byteLength", -1);
        constexpr std::int64_t limit = std::int64_t(1) << 40;
        if (buffer < 0 || begin < 0 || length < 1 || begin > limit || length > limit)
            return Error{"buffer view " + std::to_string(i) + " has no valid buffer, offset or length"};
    }
    return {};
}

Status check_extensions(const json& file) {
    const auto required = file.find("extensionsRequired");
    if (required == file.end())
        return {};
    if (!required->is_array())
        return Error{"'extensionsRequired' must be a list"};
    for (const json& name : *required)
        if (!name.is_string() || !is_known_extension(name.get<std::string>()))
            return Error{"it requires the extension " + name.dump() + ", which is not supported"};
    return {};
}

Status check_version(const json& file) {
    const auto asset = file.find("asset");
    if (asset == file.end() || !asset->is_object() || !asset->contains("version") || !(*asset)["version"].is_string())
        return Error{"it names no glTF version"};
    for (const char* key : {"minVersion", "version"}) {
        const auto found = asset->find(key);
        if (found == asset->end())
            continue;
        const std::string version = found->is_string() ? found->get<std::string>() : "";
        const bool right = std::string_view(key) == "version" ? version.compare(0, 2, "2.") == 0 : version == "2.0";
        return right ? Status() : Status(Error{"it is glTF " + version + "; version 2.0 is needed"});
    }
    return {};
}

} // namespace

bool nesting_is_sane(std::string_view text) {
    std::size_t depth = 0;
    bool in_text = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_text) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                in_text = false;
        } else if (c == '"') {
            in_text = true;
        } else if (c == '{' || c == '[') {
            if (++depth > nesting_limit)
                return false;
        } else if ((c == '}' || c == ']') && depth > 0) {
            --depth;
        }
    }
    return true;
}

bool is_known_extension(std::string_view name) {
    return std::find(known_extensions.begin(), known_extensions.end(), name) != known_extensions.end();
}

Status check_gltf_json(json& file, std::vector<std::string>& notes) {
    if (!file.is_object())
        return Error{"its JSON is not an object"};
    SUNFLECK_TRY(check_version(file));
    SUNFLECK_TRY(check_extensions(file));
    SUNFLECK_TRY(check_sections(file));
    SUNFLECK_TRY(check_references(file, notes));
    for (const char* section : {"accessors", "animations", "bufferViews", "buffers", "cameras", "images", "materials",
                                "meshes", "nodes", "samplers", "scenes", "skins", "textures"})
        SUNFLECK_TRY(check_names(file, section));
    for (const Property& property : properties())
        if (const auto section = file.find(std::string(property.section)); section != file.end())
            for (std::size_t i = 0; i < section->size(); ++i)
                SUNFLECK_TRY(check_property((*section)[i], property, 0,
                                            std::string(property.section) + "[" + std::to_string(i) + "]"));
    SUNFLECK_TRY(check_nodes(file));
    return check_views(file);
}

} // namespace sunfleck::io
