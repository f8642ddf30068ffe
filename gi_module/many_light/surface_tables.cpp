#include "gi_module/many_light/surface_tables.h"

#include <cstring>

namespace sunfleck::gi {

Status SurfaceTables::update(gpu::Device& device, const ManyLightScene& scene,
                             std::span<const shared::NodeRow> node_rows, bool node_rows_changed,
                             gpu::FrameResources& resources) {
    VisibilityDatabase& database = scene.database;
    const SurfacePatches& patches = database.patches();
    const bool fresh = generation_ != database.generation();
    generation_ = database.generation();
    if (fresh) {
        const auto charts = std::as_bytes(std::span(patches.chart_rows()));
        const auto cells = std::as_bytes(std::span(patches.cells()));
        SUNFLECK_TRY(charts_.reserve(device, resources, "surface charts", std::max<std::size_t>(charts.size(), 1),
                                     VK_FORMAT_R32G32B32A32_UINT));
        SUNFLECK_TRY(cells_.reserve(device, resources, "surface cells", std::max<std::size_t>(cells.size(), 4),
                                    VK_FORMAT_R32_UINT));
        SUNFLECK_TRY(charts_.write(resources, 0, charts));
        SUNFLECK_TRY(cells_.write(resources, 0, cells));
    }
    SUNFLECK_ASSIGN(const bool nodes_grew,
                    nodes_.reserve(device, resources, "surface nodes", std::as_bytes(node_rows).size(),
                                   VK_FORMAT_R32G32B32A32_UINT));
    if (fresh || nodes_grew || node_rows_changed)
        SUNFLECK_TRY(nodes_.write(resources, 0, std::as_bytes(node_rows)));
    SUNFLECK_ASSIGN(const bool rows_grew, rows_.reserve(device, resources, "visibility rows",
                                                        std::as_bytes(std::span(database.rows())).size()));
    SUNFLECK_TRY(upload_rows(database, fresh || rows_grew, resources));

    std::vector<shared::SurfaceInstance> instances(std::max<std::size_t>(scene.gpu_scene.draws().size(), 1));
    for (const scene::DrawItem& item : scene.gpu_scene.draws()) {
        shared::SurfaceInstance& row = instances[item.row];
        row.first_box_node = shared::no_node;
        if (const shared::SurfaceInstance* known = patches.instance(item.entity); known != nullptr && item.is_static)
            row = *known;
        else
            row.first_box_node = database.mover_node(item.entity);
        row.first_curved_chart = item.is_static ? scene.curved.first_chart(item.entity) : shared::no_node;
    }
    return upload_instances(device, std::move(instances), resources);
}

Status SurfaceTables::upload_instances(gpu::Device& device, std::vector<shared::SurfaceInstance> rows,
                                       gpu::FrameResources& resources) {
    const auto bytes = std::as_bytes(std::span(rows));
    SUNFLECK_ASSIGN(const bool grew, instances_.reserve(device, resources, "surface instances", bytes.size(),
                                                        VK_FORMAT_R32G32B32A32_UINT));
    if (!grew && rows.size() == instance_rows_.size() &&
        std::memcmp(rows.data(), instance_rows_.data(), bytes.size()) == 0)
        return {};
    instance_rows_ = std::move(rows);
    return instances_.write(resources, 0, std::as_bytes(std::span(instance_rows_)));
}

// Neighbouring dirty rows travel together.
Status SurfaceTables::upload_rows(VisibilityDatabase& database, bool all, gpu::FrameResources& resources) {
    const std::uint64_t row_bytes = std::uint64_t(database.words_per_row()) * 4;
    const std::vector<std::uint32_t> dirty = database.take_dirty_rows();
    const auto bytes = std::as_bytes(std::span(database.rows()));
    if (all || dirty.size() * 2 > database.node_count())
        return rows_.write(resources, 0, bytes);
    for (std::size_t i = 0; i < dirty.size();) {
        std::size_t end = i + 1;
        while (end < dirty.size() && dirty[end] <= dirty[end - 1] + 4)
            ++end;
        const std::uint64_t first = dirty[i] * row_bytes;
        SUNFLECK_TRY(rows_.write(resources, first, bytes.subspan(first, (dirty[end - 1] + 1) * row_bytes - first)));
        i = end;
    }
    return {};
}

void SurfaceTables::restart() {
    for (gpu::UploadedBuffer* table : {&instances_, &charts_, &cells_, &nodes_, &rows_})
        table->forget_pieces();
    generation_ = 0;
    instance_rows_.clear();
}

void SurfaceTables::add_passes(gpu::FrameGraph& graph) {
    for (gpu::UploadedBuffer* table : {&instances_, &charts_, &cells_, &nodes_, &rows_})
        table->add_pass(graph);
}

std::uint64_t SurfaceTables::memory_bytes() const {
    return instances_.buffer().size() + charts_.buffer().size() + cells_.buffer().size() + nodes_.buffer().size() +
           rows_.buffer().size();
}

} // namespace sunfleck::gi
