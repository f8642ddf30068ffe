// What a RayScene holds: Embree's scenes and the instances in them. Only for its own files.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "engine/raytrace/surface_materials.h"

#include <atomic>
#include <embree3/rtcore.h>
#include <exception>
#include <map>
#include <unordered_map>

namespace sunfleck::raytrace {

// Embree ends the program where a ray's coordinates are beyond 1.8e18, also in the space of a mover's mesh: none goes
// that far in the world.
inline constexpr float greatest_coordinate = 1e11f;

struct DeviceRelease {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using ScenePointer = std::unique_ptr<RTCSceneTy, SceneRelease>;

// A mesh instance as rays see it. Static ones hold world-space vertices in the static scene.
struct Instance {
    ecs::Entity entity;
    std::uint32_t mesh = 0;
    mat4 matrix{1.0f};
    mat3 normals{1.0f};
    SurfaceDescription surface;
    bool is_static = true;
    std::uint32_t revision = 0; // of the mesh
    bool casts_shadow = true;

    // Others of the same mesh cannot share its triangles.
    bool needs_triangles_of_its_own() const { return surface.has_holes() || !casts_shadow; }
};

// What a filter function needs to tell whether a ray goes through a hole.
struct HoleFilter {
    SurfaceDescription surface;
    const scene::MeshStore* meshes = nullptr;
    const scene::TextureStore* textures = nullptr;
    std::uint32_t mesh = 0;

    bool stops(vec3 origin, vec3 direction, std::uint32_t primitive, float u, float v, std::uint32_t salt) const {
        const float alpha = alpha_at(surface, textures, {(*meshes)[mesh], primitive, u, v});
        if (surface.material.alpha_mode == scene::AlphaMode::mask)
            return alpha >= surface.material.alpha_cutoff;
        return alpha > hole_threshold(origin, direction, primitive, salt);
    }
};

// Asks whoever waits for a build whether it shall go on. Embree does so from any of its threads, and an exception must
// not go through it.
class BuildWatch {
public:
    explicit BuildWatch(const std::function<bool(float)>& progress) : progress_(progress) {}
    // From now on a build is the part of all work from `begin` to `end`.
    void begin_part(float begin, float end) { begin_ = begin, end_ = end; }
    bool go_on(double share);
    void watch(RTCScene scene);
    void end_watch(RTCScene scene) const;
    bool stopped() const { return stopped_; }
    // An error if it was stopped; or the exception.
    Status end();

private:
    const std::function<bool(float)>& progress_;
    float begin_ = 0.0f, end_ = 1.0f;
    std::atomic_flag asking_;
    std::atomic<bool> stopped_{false};
    std::exception_ptr exception_;
};

struct RayScene::Implementation {
    struct MeshScene {
        ScenePointer scene;
        std::uint32_t revision = 0;
    };
    // How the instances differ from what changed entities are now.
    struct Differences {
        bool static_geometry = false, static_reflection = false, static_emission = false;
        bool movers = false;              // came, went, or have other triangles
        std::vector<std::uint32_t> moved; // movers, in `instances`
        void compare(const Instance* had, const Instance* now);
    };

    std::unique_ptr<RTCDeviceTy, DeviceRelease> device;
    ScenePointer static_scene, top_scene;
    // Of movers, by mesh; where a surface has holes or casts no shadow, also by entity.
    std::map<std::pair<std::uint32_t, EntityBits>, MeshScene> mesh_scenes;
    std::vector<std::unique_ptr<HoleFilter>> static_filters, mover_filters;
    std::vector<Instance> instances; // static ones first; geometry id in static_scene = place in this list
    std::uint32_t static_count = 0;
    std::uint32_t static_builds = 0;
    bool static_unbuilt = false, top_unbuilt = false; // a build was stopped
    std::uint64_t static_generation = 0;
    std::uint64_t generation = 0;
    float static_area = 0.0f;
    Bounds bounds; // of static geometry, or of movers at first, where there is none
    const scene::MeshStore* meshes = nullptr;
    const scene::TextureStore* textures = nullptr;
    std::unordered_map<ecs::Entity, std::uint32_t> place_of; // in instances
    scene::ChangeTracker tracker;                            // of the update without changes
    scene::ChangeCursor cursor;

    ScenePointer new_scene() const;
    void attach_triangles(RTCScene target, const Instance& instance, const mat4& matrix, std::uint32_t id,
                          std::vector<std::unique_ptr<HoleFilter>>& filters) const;
    void measure_bounds();
    Status commit(RTCScene scene, BuildWatch& watch) const;
    Status build_static(BuildWatch& watch);
    Result<RTCScene> mesh_scene(const Instance& instance, BuildWatch& watch);
    ScenePointer placed_scene(const Instance& instance);
    void attach_instance(RTCScene target, const mat4& matrix, std::uint32_t id) const;
    Status build_top(BuildWatch& watch);
    void move_in_top(std::span<const std::uint32_t> moved);
    std::vector<scene::DrawableChange> compare_all(const scene::SceneChanges& changes) const;
    Differences take_over(std::span<const scene::DrawableChange> changes);
    void list_instances(const scene::SceneChanges& changes, bool static_ones);
    Status check_size() const;
    Status rebuild(const Differences& differences, BuildWatch& watch);
    // The instance of an Embree hit, by its two numbers.
    std::uint32_t instance_at(std::uint32_t geometry, std::uint32_t placed, Scope scope) const {
        return scope == Scope::static_only || placed == 0 ? geometry : static_count + placed - 1;
    }
    std::array<vec3, 3> corners(const Instance& instance, std::uint32_t primitive) const;
    void place(Hit& hit, const Ray& ray) const;
    SurfacePoint describe(const Instance& instance, const TrianglePlace& place, const vec3* position) const;

    RTCScene scope_scene(Scope scope) const {
        return scope == Scope::static_only ? static_scene.get() : top_scene.get();
    }
};

} // namespace sunfleck::raytrace
