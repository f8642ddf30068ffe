// Complex movers lit by precomputed transfer, with irradiance at their vertices, instead of light samples per pixel.
#pragma once

#include "engine/gpu/frame_resources.h"
#include "gi_module/transfer/environment_probe.h"
#include "gi_module/transfer/transfer_data.h"

#include <map>

namespace sunfleck::gi {

// A mover to draw, with the irradiance of its vertices.
struct TransferDraw {
    scene::DrawItem item;
    gpu::UploadSlice irradiance; // a vec4 per vertex, W/m2 without albedo
};

struct TransferLightingOptions {
    std::uint32_t points = 4;            // of the grid, along each axis
    std::uint32_t reflections = 2;       // of light from the mover onto itself, at most transfer_orders - 1
    std::filesystem::path cache;         // folder for precomputed transfer; empty: none
    std::function<bool(float)> progress; // of precomputation
};

class TransferLighting {
public:
    // A mesh is supported if it has at least so many triangles and at most so many vertices.
    static constexpr std::uint32_t min_triangles = 128, max_vertices = 65536;

    // Whether a mover is supported: rigid, opaque, uniformly scaled, and complex enough.
    static bool supports(const scene::DrawItem& item, const mat4& matrix, const scene::MeshStore& meshes,
                         std::uint32_t mesh);

    // Once a frame: makes the draws of all supported movers. Meshes are precomputed when they first appear.
    Status update(const ecs::Registry& registry, const scene::MeshStore& meshes, const ProbeScene& scene,
                  const TransferLightingOptions& options, gpu::FrameResources& resources);
    const std::vector<TransferDraw>& draws() const { return draws_; }
    void clear() { draws_.clear(); }
    std::uint64_t vertices() const;
    // Of the transfer data.
    std::uint64_t memory_bytes() const;

private:
    Result<const TransferData*> transfer_of(const scene::MeshStore& meshes, std::uint32_t mesh,
                                            const TransferLightingOptions& options);

    std::map<std::uint32_t, TransferData> transfers_; // by mesh
    std::vector<TransferDraw> draws_;
};

} // namespace sunfleck::gi
