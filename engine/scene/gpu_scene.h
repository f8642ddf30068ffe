// The registry's geometry on the GPU: one buffer of positions, one of normals, one of indices, and a row an instance.
// Whoever draws the scene (the G-buffer, shadow maps) shares it.
#pragma once

#include "engine/gpu/frame_resources.h"
#include "engine/gpu/submission.h"
#include "engine/scene/components.h"
#include "engine/scene/instance_shared.h"
#include "engine/scene/mesh_store.h"

#include <span>
#include <unordered_map>

namespace sunfleck::scene {

// A range of the index buffer that draws a mesh with less detail.
struct DetailRange {
    std::uint32_t first_index = 0, index_count = 0, vertex_count = 0;
    float error = 0.0f; // m, in the mesh's space
};

struct DrawItem {
    ecs::Entity entity;
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;
    std::int32_t vertex_offset = 0;
    std::uint32_t row = 0;
    std::uint32_t vertex_count = 0;
    std::span<const DetailRange> details; // from fine to coarse; the first is the whole mesh
    bool closed = false;                  // and not mirrored: seen from outside, only front faces show
    float scale = 1.0f;                   // greatest length of the model matrix's axes
    Bounds bounds;                        // world space
    std::uint32_t pattern = 0;            // kind (pattern_shared.h)
    bool casts_shadow = true;             // movers only: static geometry always does
    bool is_static = true;
    // The bounds changed in the last update, or the item is new; previous_bounds is where it was (empty if new).
    bool moved = false;
    Bounds previous_bounds;
};

class GpuScene {
public:
    explicit GpuScene(gpu::Device& device) : device_(device) {}

    // Uploads meshes that are new in the store. Submits and waits when there are any: loading time, not frame time.
    Status update_meshes(const MeshStore& meshes, gpu::Submission& submission);

    // Rewrites the draw list and instance rows from the registry; call once a frame after update_world_transforms.
    Status update(ecs::Registry& registry, const MeshStore& meshes, gpu::FrameResources& resources);

    const std::vector<DrawItem>& draws() const { return draws_; }
    const gpu::Buffer& positions() const { return positions_; }
    const gpu::Buffer& normals() const { return normals_; }
    const gpu::Buffer& indices() const { return indices_; }
    // Rows of this frame, by DrawItem::row; a storage buffer slice.
    const gpu::UploadSlice& rows() const { return rows_; }
    // Box around all static geometry, and around everything.
    const Bounds& static_bounds() const { return static_bounds_; }
    const Bounds& bounds() const { return bounds_; }
    // Geometry that disappeared in the last update.
    const std::vector<Bounds>& removed_bounds() const { return removed_bounds_; }

private:
    struct MeshRange {
        std::uint32_t first_index, index_count, vertex_count;
        std::int32_t vertex_offset;
        std::vector<DetailRange> details;
        bool closed = false;
    };
    struct Previous {
        mat4 model{1.0f};
        Bounds bounds;
        bool seen = false;
    };

    gpu::Device& device_;
    gpu::Buffer positions_, normals_, indices_;
    std::vector<MeshRange> ranges_;
    std::vector<DrawItem> draws_;
    std::vector<Bounds> removed_bounds_;
    gpu::UploadSlice rows_;
    Bounds static_bounds_, bounds_;
    std::unordered_map<ecs::Entity, Previous> previous_;
};

} // namespace sunfleck::scene
