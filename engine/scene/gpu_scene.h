// The registry's geometry on the GPU: one buffer of positions, one of normals, one of indices, and a row an instance.
// Whoever draws the scene (the G-buffer, shadow maps) shares it.
#pragma once

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/frame_resources.h"
#include "engine/gpu/submission.h"
#include "engine/scene/components.h"
#include "engine/scene/gpu_textures.h"
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"
#include "engine/scene/scene_changes.h"

#include <functional>
#include <memory>
#include <span>
#include <unordered_map>

namespace sunfleck::scene {

// A range of the index buffer that draws a mesh with less detail.
struct DetailRange {
    std::uint32_t first_index = 0, index_count = 0, vertex_count = 0;
    float error = 0.0f; // m, in the mesh's space
};

// How a surface is shaded in the geometry pass; kinds below `textured` are patterns (pattern_shared.h).
inline constexpr std::uint32_t surface_kind_textured = 5, surface_kind_holes = 6, surface_kinds = 7;

struct DrawItem {
    ecs::Entity entity;
    std::uint32_t mesh = 0, revision = 0; // of the store, and of the mesh
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;
    std::int32_t vertex_offset = 0;
    std::uint32_t row = 0;
    std::uint32_t vertex_count = 0;
    std::span<const DetailRange> details;        // from fine to coarse; the first is the whole mesh
    bool closed = false;                         // is_solid, and not mirrored: from outside, only front faces show
    bool single_sided = false;                   // pictures do not show it from behind
    bool mirrored = false;                       // the model matrix turns triangles round
    float scale = 1.0f;                          // greatest length of the model matrix's axes
    Bounds bounds;                               // world space
    std::uint32_t kind = 0;                      // of its surface
    std::int32_t textures[4] = {-1, -1, -1, -1}; // base colour, normal, emission, metallic and roughness
    shared::DrawConstants constants{};
    bool casts_shadow = true; // movers only: static geometry always does
    bool is_static = true;
    // The bounds changed in the last update, or the item is new; previous_bounds is where it was (empty if new).
    bool moved = false;
    Bounds previous_bounds;
    float displacement = 0.0f; // m: how far any corner of its box moved in the last update
};

class GpuScene {
public:
    explicit GpuScene(gpu::Device& device) : device_(device), textures_(device) {}

    // Uploads meshes that are new in the store. Submits and waits when there are any: loading time, not frame time.
    // `progress` is called with the share that is done while there are any; if it returns false, that is an error, and
    // the next call begins again.
    Status update_meshes(const MeshStore& meshes, gpu::Submission& submission,
                         const std::function<bool(float)>& progress = {});
    // The same without submitting anything: add_passes copies them in this frame. For hosts with loops of their own.
    Status stage_meshes(const MeshStore& meshes, gpu::FrameResources& resources,
                        const std::function<bool(float)>& progress = {});
    Status update_textures(const TextureStore& textures, gpu::Submission& submission);

    // Brings the draw list and the instance rows up to date; once a frame. Only what changed is described again, and
    // the list is laid out again where entities came, went or changed places in it.
    Status update(const SceneChanges& changes, const MeshStore& meshes, gpu::FrameResources& resources);
    // The same for whoever has no ChangeTracker; world transforms must be up to date.
    Status update(ecs::Registry& registry, const MeshStore& meshes, gpu::FrameResources& resources) {
        return update(tracker_.collect(registry, meshes), meshes, resources);
    }

    // Adds the pass that copies vertices of deformed meshes, if there are any; before whatever draws them.
    void add_passes(gpu::FrameGraph& graph);

    const std::vector<DrawItem>& draws() const { return draws_; }
    const DrawItem* find(ecs::Entity entity) const {
        const auto place = place_of_.find(entity);
        return place == place_of_.end() ? nullptr : &draws_[place->second];
    }
    const gpu::Buffer& positions() const { return positions_; }
    const gpu::Buffer& normals() const { return normals_; }
    const gpu::Buffer& indices() const { return indices_; }
    // vec4 each: both sets of texture coordinates; tangent; colour as RGBA8.
    const gpu::Buffer& texture_coordinates() const { return texture_coordinates_; }
    const gpu::Buffer& tangents() const { return tangents_; }
    const gpu::Buffer& colours() const { return colours_; }
    const GpuTextures& textures() const { return textures_; }
    // MaterialRows of this frame, by InstanceRow::material.x.
    const gpu::UploadSlice& materials() const { return materials_; }
    // Some surface's emission has a texture.
    bool has_emission_textures() const { return has_emission_textures_; }
    // Some surface reflects by microfacets (surface_glossy); and the metallic or roughness of some has a texture.
    bool has_glossy_surfaces() const { return has_glossy_surfaces_; }
    bool has_gloss_textures() const { return has_gloss_textures_; }
    // Some surface is blended (surface_stippled).
    bool has_stippled_surfaces() const { return has_stippled_surfaces_; }
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
        std::uint32_t revision = 0; // that is on the GPU, or
        static constexpr std::uint32_t no_revision = ~0u;
    };
    struct Staged {
        std::shared_ptr<gpu::Buffer> source;
        const gpu::Buffer* target = nullptr;
    };
    // All meshes in the form of the buffers.
    struct Geometry {
        std::vector<vec3> positions, normals;
        std::vector<vec4> coordinates, tangents;
        std::vector<std::uint32_t> colours, indices;
    };
    bool has_all(const MeshStore& meshes) const {
        return ranges_.size() == meshes.size() && removals_ == meshes.removals() && indices_;
    }
    void forget_meshes(gpu::FrameResources* resources);
    Result<Geometry> gather(const MeshStore& meshes, const std::function<bool(float)>& progress);
    struct VertexCopy {
        gpu::UploadSlice positions, normals, tangents;
        bool has_tangents = false;
        std::uint32_t mesh = 0, first = 0; // vertex
    };
    Status update_vertices(std::uint32_t mesh, const MeshStore& meshes, gpu::FrameResources& resources);
    Status update_deformed(const SceneChanges& changes, const MeshStore& meshes, gpu::FrameResources& resources);
    void settle();
    bool needs_layout(const SceneChanges& changes, const MeshStore& meshes) const;
    void lay_out(const SceneChanges& changes, const MeshStore& meshes);
    void refresh(const SceneChanges& changes, const MeshStore& meshes);
    void describe(const Drawable& drawable, const MeshStore& meshes, DrawItem& item, shared::InstanceRow& row);
    void describe_place(const Drawable& drawable, const MeshStore& meshes, DrawItem& item,
                        shared::InstanceRow& row) const;
    void find_bounds(bool static_ones);
    void find_surface_kinds();
    Status copy_vertices(gpu::PassContext& context) const;
    Status copy_staged(gpu::PassContext& context);
    // Calls make(buffer, its name, its values, its usage) for all of them.
    template <typename Make>
    Status for_each_buffer(const Geometry& geometry, const Make& make) {
        constexpr VkBufferUsageFlags vertices = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
        SUNFLECK_TRY(make(positions_, "mesh positions", geometry.positions, vertices));
        SUNFLECK_TRY(make(normals_, "mesh normals", geometry.normals, vertices));
        SUNFLECK_TRY(make(texture_coordinates_, "texture coordinates", geometry.coordinates, vertices));
        SUNFLECK_TRY(make(tangents_, "mesh tangents", geometry.tangents, vertices));
        SUNFLECK_TRY(make(colours_, "mesh colours", geometry.colours, vertices));
        return make(indices_, "mesh indices", geometry.indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    }
    gpu::Device& device_;
    GpuTextures textures_;
    gpu::Buffer positions_, normals_, indices_, texture_coordinates_, tangents_, colours_;
    gpu::UploadSlice materials_;
    bool has_emission_textures_ = false, has_glossy_surfaces_ = false, has_gloss_textures_ = false,
         has_stippled_surfaces_ = false;
    std::vector<VertexCopy> copies_; // until they were recorded
    std::vector<Staged> staged_;
    std::vector<MeshRange> ranges_;
    bool ranges_changed_ = false; // since the draw list was laid out
    std::uint64_t removals_ = 0;  // of the store, that ranges_ has seen
    ChangeTracker tracker_;       // of the update without changes
    ChangeCursor cursor_;
    std::vector<DrawItem> draws_;
    std::vector<shared::InstanceRow> instance_rows_;          // of draws_
    std::vector<shared::MaterialRow> material_rows_;          // by InstanceRow::material.x
    std::unordered_map<ecs::Entity, std::uint32_t> place_of_; // in draws_
    std::vector<std::uint32_t> movers_, moved_; // places in draws_; those that moved did so in the last update
    std::vector<Bounds> removed_bounds_;
    gpu::UploadSlice rows_;
    Bounds static_bounds_, bounds_;
};

} // namespace sunfleck::scene
