// Texels of baked light on static surfaces that are not flat (the thesis's light maps, sec. 4.3.2, cover flat patches
// only).
//
// The parts of a mesh that lie in no flat chart, or are flat but smooth-shaded, are projected along the six directions
// of the world axes. Each direction has a chart: a grid of points on the outermost surface that it sees. A pixel reads
// the chart whose direction is nearest to its geometric normal; a chart covers normals up to 66 degrees off, so
// neighbouring charts overlap. Surfaces further in, steps between two surfaces and places where two surfaces are close
// together are left out: pixels there find a height that does not match theirs.
#pragma once

#include "engine/ecs/registry.h"
#include "engine/scene/mesh_store.h"
#include "gi_module/charts/curved_charts_shared.h"
#include "gi_module/visibility/surface_patches.h"

#include <span>
#include <unordered_map>
#include <vector>

namespace sunfleck::gi {

struct CurvedChart {
    std::uint32_t surface = 0; // whose nodes light it, see nodes()
    std::uint32_t direction = 0;
    shared::CurvedChartRow row{};  // its first texel is its first point
    std::uint32_t first_point = 0; // in row-major order
    std::uint32_t columns = 0, rows = 0;
};

class CurvedCharts {
public:
    // Makes the charts of all static instances, except those with normal maps: points only have vertex normals.
    // `texel_side`, m: for large surfaces, while small ones get finer texels; increased if there would be more than
    // `max_points`.
    void build(ecs::Registry& registry, const scene::MeshStore& meshes, const SurfacePatches& patches, float texel_side,
               std::uint64_t max_points);

    // `shared::curved_directions` consecutive charts per instance; empty charts have no columns.
    const std::vector<CurvedChart>& charts() const { return charts_; }
    const std::vector<shared::CurvedPoint>& points() const { return points_; }
    // Nodes of the database on which points of the chart's surface may lie.
    std::span<const std::uint32_t> nodes(const CurvedChart& chart) const { return nodes_[chart.surface]; }
    // shared::no_node if the entity has no charts.
    std::uint32_t first_chart(ecs::Entity entity) const;

private:
    std::vector<CurvedChart> charts_;
    std::vector<shared::CurvedPoint> points_;
    std::vector<std::vector<std::uint32_t>> nodes_;
    std::unordered_map<ecs::Entity, std::uint32_t> first_chart_;
};

} // namespace sunfleck::gi
