// "What changed since the last frame?", answered once for all who follow a scene.
//
// A ChangeTracker keeps a copy of what it last saw of a registry. Change ticks and the log of removals name candidates;
// only where a candidate's values differ from the copy has it changed, so that a patch without effect costs nothing
// further on, and a frame in which nothing was stamped looks at no entity at all. Trackers take nothing from the
// registry: any number of them follow one registry, each at its own rate.
//
//     const SceneChanges& changes = tracker.collect(registry, meshes);    // once a frame
//     rays.update(changes, meshes, textures);                              // and whoever else follows the scene
//     gpu_scene.update(changes, meshes, resources);
//
// Followers keep a ChangeCursor. It tells whether they saw all changes before these; if not (the first frame, another
// tracker, a frame that failed), they compare everything in `all` with what they hold.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/environment_map.h"
#include "engine/scene/mesh_store.h"
#include "engine/scene/scene_space.h"

#include <deque>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <vector>

namespace sunfleck::scene {

// An entity that has a mesh of the store and a place, and all that decides how it is drawn and what it does to light.
struct Drawable {
    ecs::Entity entity;
    std::uint32_t mesh = 0;
    std::uint32_t revision = 0; // of the mesh
    mat4 matrix{1.0f};          // to the space of the changes
    Bounds bounds;              // in that space
    Material material;
    MaterialTextures textures;
    SurfacePattern pattern{PatternKind::none};
    bool has_textures = false, has_pattern = false;
    bool is_lamp = false; // has an AreaLight
    bool is_static = true;
    bool casts_shadow = true; // static geometry always does
};

struct DrawableChange {
    ecs::Entity entity;
    const Drawable* before = nullptr; // null: it is new
    const Drawable* now = nullptr;    // null: it is gone

    bool added() const { return before == nullptr; }
    bool removed() const { return now == nullptr; }
    bool is_mover() const { return (now != nullptr && !now->is_static) || (before != nullptr && !before->is_static); }
    bool is_static() const { return (now != nullptr && now->is_static) || (before != nullptr && before->is_static); }
    // Its shape or place in the world; true for what is new or gone.
    bool moved() const;
    // Material, textures, pattern, or whether it is a lamp.
    bool surface_changed() const;
};

// Valid until the next collect of its tracker.
struct SceneChanges {
    std::uint64_t tracker = 0; // differs from tracker to tracker
    std::uint64_t serial = 0;  // of this collect, from 1
    // The first collect, one of another registry, mesh store or space, or one that was forced: all drawables and
    // emitters are listed as new, and what was known before is not listed as removed.
    bool everything = false;
    // Where matrices and bounds lie: the world, unless the tracker finds a space for the scene.
    SceneSpace space;
    bool order_changed = false; // `all` has other entities, or the same ones in another order
    // Static geometry came, went, moved, or has other holes; or a drawable became static or ceased to be.
    bool static_geometry = false;
    std::span<const DrawableChange> drawables; // by entity
    std::span<const std::uint32_t> meshes;     // whose vertices were replaced
    // Entities, in order, whose light changed, came or went: what they emit, from where, or whether they move. Where it
    // is empty, collect_emitters would find the same as before (if scene bounds and `keep_dark` are the same, too).
    std::span<const ecs::Entity> emitters;
    bool emitters_changed() const { return !emitters.empty(); }
    // Every drawable, in the order of a loop over MeshInstance and WorldTransform.
    std::span<const Drawable* const> all;
    std::size_t examined = 0; // entities looked at to find this
};

// How far somebody follows a tracker.
class ChangeCursor {
public:
    // False: `changes` is not all that is new to the follower.
    bool follows(const SceneChanges& changes) const {
        return !changes.everything && changes.tracker == tracker_ && changes.serial == serial_ + 1;
    }
    void saw(const SceneChanges& changes) {
        tracker_ = changes.tracker;
        serial_ = changes.serial;
    }

private:
    std::uint64_t tracker_ = 0, serial_ = 0;
};

class ChangeTracker {
public:
    // of_scene: space_of(static geometry), computed again whenever that changes.
    enum class Space { world, of_scene };
    explicit ChangeTracker(Space space = Space::world);
    ChangeTracker(const ChangeTracker&) = delete;
    ChangeTracker& operator=(const ChangeTracker&) = delete;

    // What changed since the last call. World transforms must be up to date. Advances the registry's tick.
    const SceneChanges& collect(ecs::Registry& registry, const MeshStore& meshes);
    // The next collect lists everything.
    void force_everything() { forced_ = true; }

private:
    // All that collect_emitters reads of an entity.
    struct EmitterState {
        std::optional<AreaLight> area;
        std::optional<PointLight> point;
        std::optional<SpotLight> spot;
        std::optional<DirectionalLight> directional;
        std::optional<Environment> environment;
        std::optional<EnvironmentMap> map;
        std::optional<mat4> matrix;
        std::optional<std::uint32_t> mesh; // of the store
        std::uint32_t revision = 0;
        vec3 emission{0.0f};
        bool textured = false;
        vec3 texture_average{1.0f};
        bool moves = false;
        bool operator==(const EmitterState&) const = default;

        bool has_light() const { return area || point || spot || directional || environment; }
    };

    void compare_all(ecs::Registry& registry, const MeshStore& meshes);
    SceneSpace find_space(ecs::Registry& registry, const MeshStore& meshes) const;
    void forget(const ecs::Registry& registry);
    void find_candidates(ecs::Registry& registry, const MeshStore& meshes);
    template <typename T>
    void add_stamped(ecs::Registry& registry, std::vector<ecs::Entity>& to);
    void add_known();
    void add_affected_by_hierarchy(ecs::Registry& registry);
    void add_users_of_changed_meshes(const ecs::Registry& registry, const MeshStore& meshes);
    void follow_mesh_of(const ecs::Registry& registry, ecs::Entity entity);
    void follow_parent_of(const ecs::Registry& registry, ecs::Entity entity);
    void compare_drawable(const ecs::Registry& registry, const MeshStore& meshes, ecs::Entity entity);
    void compare_emitter(const ecs::Registry& registry, const MeshStore& meshes, ecs::Entity entity);
    void list_all(ecs::Registry& registry);
    // Of loops over drawables: which pool leads them, and the version of its order.
    static std::pair<int, std::uint64_t> order_of(const ecs::Registry& registry);

    SceneChanges changes_;
    Space wanted_space_;
    SceneSpace space_;
    bool forced_ = false;
    std::uint64_t registry_ = 0;
    const MeshStore* meshes_ = nullptr;
    ecs::Tick seen_ = 0;
    std::uint64_t mesh_edits_ = 0;
    std::vector<std::uint32_t> revisions_; // by mesh
    std::pair<int, std::uint64_t> order_{-1, 0};

    std::unordered_map<ecs::Entity, Drawable> drawables_;
    // Whatever emits, or did once: a light that is out may be kept by those who sample it.
    std::unordered_map<ecs::Entity, EmitterState> emitters_;
    std::unordered_map<ecs::Entity, std::uint32_t> mesh_of_;
    std::set<std::pair<std::uint32_t, ecs::Entity>> users_; // mesh, entity
    std::unordered_map<ecs::Entity, ecs::Entity> parent_of_;
    std::set<std::pair<ecs::Entity, ecs::Entity>> children_; // parent, child

    std::vector<ecs::Entity> candidates_;
    std::deque<Drawable> before_; // of changes_.drawables; pointers to elements stay good
    std::vector<DrawableChange> changed_drawables_;
    std::vector<ecs::Entity> changed_emitters_;
    std::vector<std::uint32_t> changed_meshes_;
    std::vector<const Drawable*> all_;
};

} // namespace sunfleck::scene
