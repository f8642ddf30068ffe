// Where baked light has texels on static surfaces that are not flat (the thesis's light maps, sec. 4.3.2, lie on flat
// patches alone).
//
// What of a mesh lies in no flat chart, or is flat but shaded as if it was curved, is looked at along the six
// directions of the world's axes. Each direction has a chart: a grid of points of the outermost surface that it sees. A
// pixel reads the chart nearest to its geometric normal, whose points may be up to 66 degrees off, so that neighbouring
// charts overlap. Surfaces further in, steps between two surfaces and places where two are close together are left out:
// pixels there find a height that is not theirs.
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
    std::uint32_t surface = 0; // whose nodes light it: see nodes()
    std::uint32_t direction = 0;
    shared::CurvedChartRow row{};  // first texel: the first of its points
    std::uint32_t first_point = 0; // rows of columns
    std::uint32_t columns = 0, rows = 0;
};

class CurvedCharts {
public:
    // Finds the charts of all static instances. Those with normal maps have none: points know vertex normals alone.
    // `texel_side`, m: of large surfaces, smaller ones have finer texels; larger if there would be more than
    // `max_points`.
    void build(ecs::Registry& registry, const scene::MeshStore& meshes, const SurfacePatches& patches, float texel_side,
               std::uint64_t max_points);

    // `shared::curved_directions` in a row for an instance; empty charts have no columns.
    const std::vector<CurvedChart>& charts() const { return charts_; }
    const std::vector<shared::CurvedPoint>& points() const { return points_; }
    // Of the database: all that points of a chart's surface may lie on.
    std::span<const std::uint32_t> nodes(const CurvedChart& chart) const { return nodes_[chart.surface]; }
    // shared::no_node if the entity has none.
    std::uint32_t first_chart(ecs::Entity entity) const;

private:
    std::vector<CurvedChart> charts_;
    std::vector<shared::CurvedPoint> points_;
    std::vector<std::vector<std::uint32_t>> nodes_;
    std::unordered_map<ecs::Entity, std::uint32_t> first_chart_;
};

} // namespace sunfleck::gi
