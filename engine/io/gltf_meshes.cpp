#include "engine/io/gltf_meshes.h"

#include "engine/core/memory_limit.h"
#include "engine/io/gltf_mesh_shapes.h"

#include "engine/io/draco_mesh.h"
#include "engine/scene/procedural.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sunfleck::io {
namespace {

constexpr int type_float = TINYGLTF_COMPONENT_TYPE_FLOAT, type_byte = TINYGLTF_COMPONENT_TYPE_BYTE,
              type_ubyte = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, type_short = TINYGLTF_COMPONENT_TYPE_SHORT,
              type_ushort = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, type_uint = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;

// With the types that KHR_mesh_quantization adds.
const AccessorUse position_use{
    {TINYGLTF_TYPE_VEC3}, {type_float, type_byte, type_ubyte, type_short, type_ushort}, true};
const AccessorUse normal_use{{TINYGLTF_TYPE_VEC3}, {type_float, type_byte, type_short}, false};
const AccessorUse tangent_use{{TINYGLTF_TYPE_VEC4}, {type_float, type_byte, type_short}, false};
const AccessorUse coordinate_use{
    {TINYGLTF_TYPE_VEC2}, {type_float, type_byte, type_ubyte, type_short, type_ushort}, true};
const AccessorUse colour_use{{TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4}, {type_float, type_ubyte, type_ushort}, false};
const AccessorUse weight_use{{TINYGLTF_TYPE_VEC4}, {type_float, type_ubyte, type_ushort}, false};

vec3 vector_at(const FloatElements& elements, std::size_t i) {
    return {elements[i][0], elements[i][1], elements[i][2]};
}

// Attributes of one primitive, from accessors or Draco data.
class Attributes {
public:
    Attributes(const tinygltf::Model& model, const tinygltf::Primitive& primitive)
        : model_(model), primitive_(primitive) {}

    Status decompress() {
        const auto found = primitive_.extensions.find("KHR_draco_mesh_compression");
        if (found == primitive_.extensions.end())
            return {};
        const tinygltf::Value& extension = found->second;
        if (!extension.IsObject() || !extension.Has("bufferView") || !extension.Get("bufferView").IsNumber() ||
            !extension.Has("attributes") || !extension.Get("attributes").IsObject())
            return Error{"its KHR_draco_mesh_compression is not valid"};
        SUNFLECK_ASSIGN(const std::span<const unsigned char> bytes,
                        view_bytes(model_, extension.Get("bufferView").GetNumberAsInt()));
        std::map<std::string, int> ids;
        const tinygltf::Value& attributes = extension.Get("attributes");
        for (const std::string& name : attributes.Keys())
            ids[name] = attributes.Get(name).IsNumber() ? attributes.Get(name).GetNumberAsInt() : -1;
        SUNFLECK_ASSIGN(draco_, decode_draco(bytes, ids, [](std::uint64_t size) {
                            return check_memory(size, "its Draco data", level_detail);
                        }));
        compressed_ = true;
        return {};
    }

    bool has(const std::string& name) const { return primitive_.attributes.count(name) != 0; }

    Result<FloatElements> read(const std::string& name, const AccessorUse& use) const {
        if (const auto found = draco_.attributes.find(name); found != draco_.attributes.end())
            return FloatElements{found->second.values, found->second.width};
        auto elements = read_floats(model_, primitive_.attributes.at(name), use);
        return elements ? std::move(elements)
                        : Result<FloatElements>(Error{name + ": " + elements.error().message, elements.error().code});
    }

    Result<std::vector<std::uint32_t>> indices(std::size_t vertices) const {
        std::vector<std::uint32_t> result;
        if (compressed_) {
            result = draco_.indices;
        } else if (primitive_.indices < 0) {
            result.resize(vertices);
            std::iota(result.begin(), result.end(), 0u);
        } else {
            SUNFLECK_ASSIGN(result, read_integers(model_, primitive_.indices, TINYGLTF_TYPE_SCALAR,
                                                  {type_ubyte, type_ushort, type_uint}));
        }
        for (const std::uint32_t index : result)
            if (index >= vertices)
                return Error{"index " + std::to_string(index) + " points past the last of " + std::to_string(vertices) +
                             " vertices"};
        return result;
    }

    bool compressed() const { return compressed_; }

private:
    const tinygltf::Model& model_;
    const tinygltf::Primitive& primitive_;
    DracoMesh draco_;
    bool compressed_ = false;
};

// Strips and fans as separate triangles, with the winding of glTF 2.0, sec. 3.7.2.1.
std::vector<std::uint32_t> as_triangles(const std::vector<std::uint32_t>& indices, int mode) {
    std::vector<std::uint32_t> result;
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
        for (std::size_t i = 0; i + 2 < indices.size(); ++i)
            result.insert(result.end(), {indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    else if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
        for (std::size_t i = 1; i + 1 < indices.size(); ++i)
            result.insert(result.end(), {indices[i], indices[i + 1], indices[0]});
    else
        result.assign(indices.begin(), indices.begin() + std::ptrdiff_t(indices.size() / 3 * 3));
    return result;
}

// Normalises; zero normals are replaced by the average of the adjacent faces.
void repair_normals(scene::Mesh& mesh) {
    scene::Mesh smooth;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const float length = glm::length(mesh.normals[i]);
        if (length > 1e-6f && std::isfinite(length)) {
            if (std::abs(length - 1.0f) > 1e-4f)
                mesh.normals[i] /= length;
            continue;
        }
        if (smooth.positions.empty()) {
            smooth.positions = mesh.positions;
            smooth.indices = mesh.indices;
            scene::compute_normals(smooth);
        }
        mesh.normals[i] = smooth.normals[i];
    }
}

Status expect_count(const char* what, std::size_t count, std::size_t vertices) {
    if (count == vertices)
        return {};
    return Error{std::string(what) + " has " + std::to_string(count) + " elements for " + std::to_string(vertices) +
                 " vertices"};
}

Status read_coordinates(const Attributes& attributes, scene::Mesh& mesh) {
    for (const int set : {0, 1}) {
        const std::string name = "TEXCOORD_" + std::to_string(set);
        if (!attributes.has(name))
            continue;
        SUNFLECK_ASSIGN(const FloatElements elements, attributes.read(name, coordinate_use));
        SUNFLECK_TRY(expect_count(name.c_str(), elements.count(), mesh.positions.size()));
        mesh.texture_coordinates.resize(mesh.positions.size(), vec4(0.0f));
        for (std::size_t i = 0; i < elements.count(); ++i) {
            mesh.texture_coordinates[i][set * 2] = elements[i][0];
            mesh.texture_coordinates[i][set * 2 + 1] = elements[i][1];
        }
    }
    return {};
}

Status read_vertices(const Attributes& attributes, scene::Mesh& mesh) {
    if (!attributes.has("POSITION"))
        return Error{"it has no POSITION"};
    SUNFLECK_ASSIGN(const FloatElements positions, attributes.read("POSITION", position_use));
    const std::size_t count = positions.count();
    for (std::size_t i = 0; i < count; ++i)
        mesh.positions.push_back(vector_at(positions, i));
    if (attributes.has("NORMAL")) {
        SUNFLECK_ASSIGN(const FloatElements normals, attributes.read("NORMAL", normal_use));
        SUNFLECK_TRY(expect_count("NORMAL", normals.count(), count));
        for (std::size_t i = 0; i < count; ++i)
            mesh.normals.push_back(vector_at(normals, i));
    }
    if (attributes.has("TANGENT") && !mesh.normals.empty()) {
        SUNFLECK_ASSIGN(const FloatElements tangents, attributes.read("TANGENT", tangent_use));
        SUNFLECK_TRY(expect_count("TANGENT", tangents.count(), count));
        for (std::size_t i = 0; i < count; ++i)
            mesh.tangents.emplace_back(vector_at(tangents, i), tangents[i][3] < 0.0f ? -1.0f : 1.0f);
    }
    if (attributes.has("COLOR_0")) {
        SUNFLECK_ASSIGN(const FloatElements colours, attributes.read("COLOR_0", colour_use));
        SUNFLECK_TRY(expect_count("COLOR_0", colours.count(), count));
        for (std::size_t i = 0; i < count; ++i)
            mesh.colours.emplace_back(glm::clamp(vector_at(colours, i), 0.0f, 1.0f),
                                      colours.width == 4 ? std::clamp(colours[i][3], 0.0f, 1.0f) : 1.0f);
    }
    return read_coordinates(attributes, mesh);
}

Status read_targets(const tinygltf::Model& model, const tinygltf::Primitive& primitive, scene::DeformableMesh& mesh) {
    for (const auto& attributes : primitive.targets) {
        scene::MorphTarget target;
        SUNFLECK_TRY(check_memory(mesh.rest.positions.size() * sizeof(vec3), "a morph target", level_detail));
        target.positions.assign(mesh.rest.positions.size(), vec3(0.0f));
        if (const auto found = attributes.find("POSITION"); found != attributes.end()) {
            SUNFLECK_ASSIGN(const FloatElements elements, read_floats(model, found->second, position_use));
            SUNFLECK_TRY(expect_count("a morph target", elements.count(), mesh.rest.positions.size()));
            for (std::size_t i = 0; i < elements.count(); ++i)
                target.positions[i] = vector_at(elements, i);
        }
        if (const auto found = attributes.find("NORMAL"); found != attributes.end()) {
            SUNFLECK_ASSIGN(const FloatElements elements, read_floats(model, found->second, normal_use));
            SUNFLECK_TRY(expect_count("a morph target", elements.count(), mesh.rest.positions.size()));
            for (std::size_t i = 0; i < elements.count(); ++i)
                target.normals.push_back(vector_at(elements, i));
        }
        mesh.targets.push_back(std::move(target));
    }
    return {};
}

// JOINTS_n and WEIGHTS_n, four influences per set; weights are normalised to sum to 1.
Status read_influences(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const Attributes& attributes,
                       scene::DeformableMesh& mesh) {
    const std::size_t vertices = mesh.rest.positions.size();
    std::vector<std::vector<std::uint32_t>> joints;
    std::vector<FloatElements> weights;
    for (int set = 0; set < 4; ++set) {
        const std::string joint_name = "JOINTS_" + std::to_string(set), weight_name = "WEIGHTS_" + std::to_string(set);
        if (!attributes.has(joint_name) || !attributes.has(weight_name))
            break;
        if (attributes.compressed()) {
            SUNFLECK_ASSIGN(const FloatElements numbers, attributes.read(joint_name, weight_use));
            joints.emplace_back(numbers.values.begin(), numbers.values.end());
        } else {
            SUNFLECK_ASSIGN(auto numbers, read_integers(model, primitive.attributes.at(joint_name), TINYGLTF_TYPE_VEC4,
                                                        {type_ubyte, type_ushort}));
            joints.push_back(std::move(numbers));
        }
        SUNFLECK_ASSIGN(FloatElements elements, attributes.read(weight_name, weight_use));
        SUNFLECK_TRY(expect_count(weight_name.c_str(), elements.count(), vertices));
        SUNFLECK_TRY(expect_count(joint_name.c_str(), joints.back().size() / 4, vertices));
        weights.push_back(std::move(elements));
    }
    mesh.influences = std::uint32_t(joints.size() * 4);
    for (std::size_t v = 0; v < vertices && mesh.influences > 0; ++v) {
        float sum = 0.0f;
        for (const FloatElements& set : weights)
            for (std::size_t i = 0; i < 4; ++i)
                sum += std::max(set[v][i], 0.0f);
        if (std::abs(sum - 1.0f) < 1e-6f)
            sum = 1.0f; // weights stay to the bit, however often they are saved
        for (std::size_t set = 0; set < joints.size(); ++set)
            for (std::size_t i = 0; i < 4; ++i) {
                mesh.joints.push_back(joints[set][v * 4 + i]);
                const bool first = set == 0 && i == 0;
                mesh.weights.push_back(sum > 0.0f ? std::max(weights[set][v][i], 0.0f) / sum : first ? 1.0f : 0.0f);
            }
    }
    return {};
}

// KHR_materials_variants: the material of each variant, -1 for the primitive's own.
std::vector<int> variant_materials(const tinygltf::Primitive& primitive, std::size_t variants) {
    std::vector<int> result(variants, -1);
    const auto found = primitive.extensions.find("KHR_materials_variants");
    if (found == primitive.extensions.end() || !found->second.Has("mappings"))
        return result;
    const tinygltf::Value& mappings = found->second.Get("mappings");
    for (std::size_t i = 0; mappings.IsArray() && i < mappings.ArrayLen(); ++i) {
        const tinygltf::Value& mapping = mappings.Get(int(i));
        if (!mapping.Has("material") || !mapping.Has("variants") || !mapping.Get("variants").IsArray())
            continue;
        const tinygltf::Value& numbers = mapping.Get("variants");
        for (std::size_t k = 0; k < numbers.ArrayLen(); ++k) {
            const int variant = numbers.Get(int(k)).IsNumber() ? numbers.Get(int(k)).GetNumberAsInt() : -1;
            if (in_range(variant, result))
                result[std::size_t(variant)] =
                    mapping.Get("material").IsNumber() ? mapping.Get("material").GetNumberAsInt() : -1;
        }
    }
    return result;
}

} // namespace

Result<ImportedPrimitive> read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                         std::size_t variants) {
    ImportedPrimitive result;
    result.material = primitive.material;
    result.material_of_variant = variant_materials(primitive, variants);
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN)
        return Error{"mode " + std::to_string(mode) + " does not exist"};
    scene::DeformableMesh& mesh = result.mesh;
    Attributes attributes(model, primitive);
    SUNFLECK_TRY(attributes.decompress());
    SUNFLECK_TRY(read_vertices(attributes, mesh.rest));
    SUNFLECK_ASSIGN(const std::vector<std::uint32_t> indices, attributes.indices(mesh.rest.positions.size()));
    const bool thin = mode < TINYGLTF_MODE_TRIANGLES && !attributes.compressed();
    if (!thin)
        mesh.rest.indices = as_triangles(indices, attributes.compressed() ? TINYGLTF_MODE_TRIANGLES : mode);
    SUNFLECK_TRY(read_targets(model, primitive, mesh));
    SUNFLECK_TRY(read_influences(model, primitive, attributes, mesh));
    if (thin)
        result.drawn = make_solid(mesh, indices, mode);
    else if (mesh.rest.normals.empty())
        make_flat(mesh);
    else
        repair_normals(mesh.rest);
    return result;
}

void generate_tangents(scene::Mesh& mesh, int set) {
    std::vector<vec3> along(mesh.positions.size(), vec3(0.0f)), across(mesh.positions.size(), vec3(0.0f));
    const auto coordinates = [&](std::uint32_t v) {
        const vec4 both = mesh.texture_coordinates[v];
        return set == 0 ? vec2(both.x, both.y) : vec2(both.z, both.w);
    };
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const std::uint32_t* v = &mesh.indices[t];
        const vec3 e1 = mesh.positions[v[1]] - mesh.positions[v[0]], e2 = mesh.positions[v[2]] - mesh.positions[v[0]];
        const vec2 d1 = coordinates(v[1]) - coordinates(v[0]), d2 = coordinates(v[2]) - coordinates(v[0]);
        const float determinant = d1.x * d2.y - d2.x * d1.y;
        if (std::abs(determinant) < 1e-20f)
            continue;
        const float sign = determinant < 0.0f ? -1.0f : 1.0f; // large triangles count more
        for (int k = 0; k < 3; ++k) {
            along[v[k]] += sign * (d2.y * e1 - d1.y * e2);
            across[v[k]] += sign * (d1.x * e2 - d2.x * e1);
        }
    }
    mesh.tangents.resize(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const vec3 normal = mesh.normals[i];
        vec3 tangent = along[i] - glm::dot(along[i], normal) * normal, other;
        const float length = glm::length(tangent);
        if (length > 1e-20f)
            tangent /= length;
        else
            orthonormal_basis(normal, tangent, other);
        // Normal maps have Y up while v runs down: the bitangent is along decreasing v.
        const float handedness = glm::dot(glm::cross(normal, tangent), across[i]) > 0.0f ? -1.0f : 1.0f;
        mesh.tangents[i] = vec4(tangent, handedness);
    }
}

} // namespace sunfleck::io
