// Precomputed radiance transfer of a rigid mesh (thesis sec. 4.4.1; Sloan et al. 2002): how each vertex responds to
// light from all directions, including the mesh's own shadows and reflections onto itself.
#pragma once

#include "engine/core/result.h"
#include "engine/scene/mesh_store.h"
#include "gi_module/harmonics/spherical_harmonics.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <span>

namespace sunfleck::gi {

// Light that reaches a vertex directly, and after one and two reflections by the mesh itself.
inline constexpr std::size_t transfer_orders = 3;

// The irradiance at vertex v is, for each colour channel, the sum over orders k of albedo^k times the dot product of
// coefficients(v, k) and the incident radiance's harmonics, all in object space. The thesis assumes white meshes; since
// the orders are kept apart here, any albedo works.
struct TransferData {
    std::uint32_t vertices = 0;
    std::vector<Harmonics> rows; // by vertex, then by order

    const Harmonics& coefficients(std::size_t vertex, std::size_t order) const {
        return rows[vertex * transfer_orders + order];
    }
};

struct TransferPrecision {
    std::uint32_t rays = 400; // per vertex; a square number
};

// Casts rays from all vertices, on all cores: about a second for 10,000 vertices. The result depends on the mesh only,
// not on the number of threads. `progress`: called with the fraction that is done, from any thread but never
// concurrently; if it returns false, the computation stops with an error.
Result<TransferData> compute_transfer(const scene::Mesh& mesh, const TransferPrecision& precision,
                                      const std::function<bool(float)>& progress = {});

// Identifies a mesh and a precision.
std::uint64_t transfer_hash(const scene::Mesh& mesh, const TransferPrecision& precision);

// One file per hash in a folder. Damaged and foreign files are ignored.
std::optional<TransferData> read_transfer(const std::filesystem::path& folder, std::uint64_t hash,
                                          std::uint32_t vertices);
Status write_transfer(const std::filesystem::path& folder, std::uint64_t hash, const TransferData& data);

} // namespace sunfleck::gi
