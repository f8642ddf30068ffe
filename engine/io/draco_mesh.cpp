#include "engine/io/draco_mesh.h"

#include <cmath>
#include <draco/compression/decode.h>

namespace sunfleck::io {
namespace {

constexpr std::size_t element_limit = 50u << 20;

Result<DracoMesh::Attribute> read_attribute(const draco::Mesh& mesh, int id, const std::string& name) {
    const draco::PointAttribute* attribute = id >= 0 ? mesh.GetAttributeByUniqueId(std::uint32_t(id)) : nullptr;
    if (attribute == nullptr || attribute->num_components() < 1 || attribute->num_components() > 4)
        return Error{"its Draco data has no attribute " + name};
    DracoMesh::Attribute result;
    result.width = std::size_t(attribute->num_components());
    result.values.resize(mesh.num_points() * result.width);
    for (std::uint32_t point = 0; point < mesh.num_points(); ++point) {
        float value[4] = {};
        const draco::AttributeValueIndex at = attribute->mapped_index(draco::PointIndex(point));
        if (at.value() >= attribute->size() ||
            !attribute->ConvertValue(at, std::int8_t(attribute->num_components()), value))
            return Error{"its Draco data is damaged"};
        for (std::size_t c = 0; c < result.width; ++c) {
            if (!std::isfinite(value[c]))
                return Error{"its Draco data holds a number that is not finite"};
            result.values[point * result.width + c] = value[c];
        }
    }
    return result;
}

} // namespace

Result<DracoMesh> decode_draco(std::span<const unsigned char> bytes, const std::map<std::string, int>& attributes,
                               AllowDracoMemory allow) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (!kind.ok() || kind.value() != draco::TRIANGULAR_MESH)
        return Error{"its Draco data is not a mesh"};
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        return Error{"its Draco data is damaged: " + decoded.status().error_msg_string()};
    const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
    if (mesh->num_points() > element_limit || mesh->num_faces() > element_limit)
        return Error{"its Draco data is too large"};
    SUNFLECK_TRY(allow(mesh->num_points() * attributes.size() * sizeof(float[4]) +
                       mesh->num_faces() * sizeof(std::uint32_t[3])));
    DracoMesh result;
    for (const auto& [name, id] : attributes) {
        SUNFLECK_ASSIGN(result.attributes[name], read_attribute(*mesh, id, name));
    }
    for (std::uint32_t face = 0; face < mesh->num_faces(); ++face)
        for (const draco::PointIndex& point : mesh->face(draco::FaceIndex(face))) {
            if (point.value() >= mesh->num_points())
                return Error{"its Draco data is damaged"};
            result.indices.push_back(point.value());
        }
    return result;
}

} // namespace sunfleck::io
