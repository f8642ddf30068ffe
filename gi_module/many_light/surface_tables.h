// The visibility database as shaders read it: charts, cells, nodes, rows of pairs, and which instance has which. Kept
// on the GPU; only what changed is copied.
#pragma once

#include "engine/gpu/uploaded_buffer.h"
#include "engine/scene/gpu_scene.h"
#include "gi_module/charts/curved_charts.h"
#include "gi_module/many_light/many_light_scene.h"
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

class SurfaceTables {
public:
    // Uploads what changed in the database. `node_rows` are by node; a change of their number or of the database's
    // generation uploads all.
    Status update(gpu::Device& device, const ManyLightScene& scene, std::span<const shared::NodeRow> node_rows,
                  bool node_rows_changed, gpu::FrameResources& resources);
    void add_passes(gpu::FrameGraph& graph);
    // The next update uploads everything.
    void restart();

    // Storage buffers, and texel buffers of uints.
    const gpu::Buffer& instances() const { return instances_.buffer(); } // SurfaceInstance by instance row
    const gpu::Buffer& charts() const { return charts_.buffer(); }
    const gpu::Buffer& cells() const { return cells_.buffer(); }
    const gpu::Buffer& nodes() const { return nodes_.buffer(); }
    const gpu::Buffer& rows() const { return rows_.buffer(); }
    std::uint64_t memory_bytes() const;

private:
    Status upload_rows(VisibilityDatabase& database, bool all, gpu::FrameResources& resources);

    Status upload_instances(gpu::Device& device, std::vector<shared::SurfaceInstance> rows,
                            gpu::FrameResources& resources);

    gpu::UploadedBuffer instances_, charts_, cells_, nodes_, rows_;
    std::vector<shared::SurfaceInstance> instance_rows_; // uploaded
    std::uint64_t generation_ = 0;
};

} // namespace sunfleck::gi
