// Precomputed radiance transfer of a rigid mesh (thesis sec. 4.4.1; Sloan et al. 2002): what each vertex makes of light
// from all directions, with the mesh's own shadows and its reflections onto itself.
#pragma once

#include "engine/core/result.h"
#include "engine/scene/mesh_store.h"
#include "gi_module/harmonics/spherical_harmonics.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <span>

namespace sunfleck::gi {

// Light that reaches a vertex at once, after one and after two reflections by the mesh itself.
inline constexpr std::size_t transfer_orders = 3;

// The irradiance at vertex v is, for each colour, the sum over orders k of albedo^k times the dot product of
// coefficients(v, k) and the incident radiance's harmonics, all in the mesh's own space. The thesis assumes white
// meshes; with the orders kept apart any albedo will do.
struct TransferData {
    std::uint32_t vertices = 0;
    std::vector<Harmonics> rows; // vertex by vertex, its orders one after the other

    const Harmonics& coefficients(std::size_t vertex, std::size_t order) const {
        return rows[vertex * transfer_orders + order];
    }
};

struct TransferPrecision {
    std::uint32_t rays = 400; // a vertex; a square number
};

// Casts rays from all vertices, on all cores: about a second for 10,000 vertices. Depends on the mesh alone, not on the
// number of threads. `progress`: share that is done, from any thread but by one at a time; false stops it with an
// error.
Result<TransferData> compute_transfer(const scene::Mesh& mesh, const TransferPrecision& precision,
                                      const std::function<bool(float)>& progress = {});

// Tells meshes and precisions apart.
std::uint64_t transfer_hash(const scene::Mesh& mesh, const TransferPrecision& precision);

// One file for each hash in a folder. Damaged and foreign files are as none.
std::optional<TransferData> read_transfer(const std::filesystem::path& folder, std::uint64_t hash,
                                          std::uint32_t vertices);
Status write_transfer(const std::filesystem::path& folder, std::uint64_t hash, const TransferData& data);

} // namespace sunfleck::gi
