// Static surfaces as trees of patches: flat pieces become charts, divided into quadtrees of rectangles; the rest of a
// mesh is known by boxes. Thesis sec. 4.3.1, "hierarchical subdivision".
//
// The trees' roots depend on static geometry alone. Who knows the occlusion (VisibilityDatabase) splits them further.
#pragma once

#include "engine/ecs/registry.h"
#include "engine/scene/components.h"
#include "engine/scene/scene_space.h"
#include "gi_module/visibility/chart_cuts.h"
#include "gi_module/visibility/surface_lookup_shared.h"

#include <unordered_map>

namespace sunfleck::gi {

// A node of the forest of surface patches.
struct SurfacePatch {
    std::uint32_t parent = shared::no_node;
    std::uint32_t first_child = shared::no_node; // four in a row; no_node in leaves
    std::uint32_t level = 0;
    bool planar = true;
    std::uint32_t chart = 0;                      // planar
    vec4 place{0.0f};                             // planar: lowest u, v and their extents, in the chart
    std::array<dvec3, 4> corners;                 // planar, counter-clockwise about the normal
    dvec3 normal{0.0};                            // planar
    OrientedBox box;                              // not planar
    std::uint32_t body = StaticBlockers::no_body; // not planar: the convex body that it is a part of
    Bounds bounds;
    ecs::Entity entity;

    bool is_leaf() const { return first_child == shared::no_node; }
};

struct Chart : ChartRectangle {
    ecs::Entity entity;
    std::uint32_t cut_sides = 0; // shared::chart_cut_low_u and the like
    std::uint32_t root_columns = 1, root_rows = 1, first_root = 0;
    std::uint32_t levels = 0; // of subdivision at most
    std::uint32_t first_cell = 0;

    std::uint32_t columns() const { return root_columns << levels; }
    std::uint32_t rows() const { return root_rows << levels; }
};

struct PatchOptions {
    std::uint32_t levels = 3; // of subdivision at most
    float smallest = 0.2f;    // m: patches are not divided below this side
    scene::SceneSpace space;  // where patches lie
};

class SurfacePatches {
public:
    // Finds charts and boxes of all static mesh instances, and fills `blockers` with the same geometry. `progress` is
    // called with the share that is done; if it returns false, the build stops, and what there is must not be used.
    // False: it was stopped.
    bool build(ecs::Registry& registry, const scene::MeshStore& meshes, const PatchOptions& options,
               StaticBlockers& blockers, const std::function<bool(float)>& progress = {});

    const scene::SceneSpace& space() const { return space_; }
    const std::vector<SurfacePatch>& nodes() const { return nodes_; }
    const std::vector<Chart>& charts() const { return charts_; }
    std::uint32_t roots() const { return roots_; } // the first nodes are the roots
    std::uint32_t leaves() const;

    bool can_split(std::uint32_t node) const;
    // Adds four children.
    void split(std::uint32_t node);
    // After the last split: the cells of all charts.
    void finish();

    // What shaders read. The table by instance row is the caller's to order: rows change from frame to frame.
    const std::vector<shared::SurfaceChart>& chart_rows() const { return chart_rows_; }
    const std::vector<std::uint32_t>& cells() const { return cells_; }
    // Nothing if the entity is not static geometry.
    const shared::SurfaceInstance* instance(ecs::Entity entity) const;
    // Whether the entity's mesh encloses a volume; if not, it can be seen from behind.
    bool is_closed(ecs::Entity entity) const;

    // The node at a point of a surface, as shaders find it; no_node if there is none.
    std::uint32_t node_at(ecs::Entity entity, vec3 position, vec3 geometric_normal) const;

private:
    // What an instance's charts and boxes are made from, once all that may stand on them is known.
    struct Surface {
        ecs::Entity entity;
        std::vector<ChartRectangle> rectangles;
        Bounds bounds; // empty if charts are all of it
        std::uint32_t body = StaticBlockers::no_body;
        bool closed = false;
    };
    static Surface surface_of(ecs::Entity entity, const FlatMesh& mesh, std::uint32_t body);
    void add_surface(const Surface& surface, const StaticBlockers& blockers, const PatchOptions& options);
    void add_chart(Chart chart, const PatchOptions& options);
    void add_boxes(const Surface& surface, shared::SurfaceInstance& instance);
    SurfacePatch patch_of(const Chart& chart, std::uint32_t chart_index, vec4 place) const;

    std::vector<SurfacePatch> nodes_;
    std::vector<Chart> charts_;
    scene::SceneSpace space_;
    std::uint32_t roots_ = 0;
    std::vector<shared::SurfaceChart> chart_rows_;
    std::vector<std::uint32_t> cells_;
    struct Instance {
        shared::SurfaceInstance row;
        bool closed = false;
    };
    std::unordered_map<ecs::Entity, Instance> instances_;
};

} // namespace sunfleck::gi
