// Precomputed transfer on disk: computed once for each content of a mesh.
#include "engine/core/file.h"
#include "engine/core/hash.h"
#include "gi_module/transfer/transfer_data.h"

#include <cstring>

namespace sunfleck::gi {
namespace {

constexpr char magic[8] = {'S', 'F', 'T', 'R', 'N', 'S', '0', '1'};

struct Header {
    char magic[8];
    std::uint64_t hash;
    std::uint64_t checksum; // of what follows
    std::uint32_t vertices, orders, coefficients, unused;
};

std::filesystem::path file_of(const std::filesystem::path& folder, std::uint64_t hash) {
    return folder / (hash_text(hash) + ".transfer");
}

Header header_of(std::uint64_t hash, const TransferData& data) {
    Header header{};
    std::memcpy(header.magic, magic, sizeof magic);
    header.hash = hash;
    header.checksum = hash_bytes(hash_start, data.rows.data(), data.rows.size() * sizeof(Harmonics));
    header.vertices = data.vertices;
    header.orders = std::uint32_t(transfer_orders);
    header.coefficients = std::uint32_t(harmonics_padded);
    return header;
}

} // namespace

std::uint64_t transfer_hash(const scene::Mesh& mesh, const TransferPrecision& precision) {
    std::uint64_t hash = hash_bytes(hash_start, &precision.rays, sizeof precision.rays);
    hash = hash_bytes(hash, mesh.positions.data(), mesh.positions.size() * sizeof(vec3));
    hash = hash_bytes(hash, mesh.normals.data(), mesh.normals.size() * sizeof(vec3));
    return hash_bytes(hash, mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
}

std::optional<TransferData> read_transfer(const std::filesystem::path& folder, std::uint64_t hash,
                                          std::uint32_t vertices) {
    const std::size_t bytes = std::size_t(vertices) * transfer_orders * sizeof(Harmonics);
    const auto content = read_file(file_of(folder, hash), sizeof(Header) + bytes);
    if (!content || content->size() != sizeof(Header) + bytes)
        return std::nullopt;
    TransferData data;
    data.vertices = vertices;
    data.rows.resize(std::size_t(vertices) * transfer_orders);
    std::memcpy(data.rows.data(), content->data() + sizeof(Header), bytes);
    const Header expected = header_of(hash, data);
    if (std::memcmp(content->data(), &expected, sizeof expected) != 0)
        return std::nullopt;
    return data;
}

Status write_transfer(const std::filesystem::path& folder, std::uint64_t hash, const TransferData& data) {
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    if (code)
        return Error{"cannot create folder '" + folder.string() + "': " + code.message()};
    const Header header = header_of(hash, data);
    std::string content(reinterpret_cast<const char*>(&header), sizeof header);
    content.append(reinterpret_cast<const char*>(data.rows.data()), data.rows.size() * sizeof(Harmonics));
    return write_file(file_of(folder, hash), content);
}

} // namespace sunfleck::gi
