// Rays against the registry's geometry, by Embree. Static geometry is one scene built once; movers are instances whose
// transforms follow the registry. Queries are thread safe between updates.
#pragma once

#include "engine/core/result.h"
#include "engine/scene/scene_changes.h"
#include "engine/scene/texture_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

namespace sunfleck::raytrace {

struct Ray {
    vec3 origin{0.0f};
    vec3 direction{0.0f, 0.0f, 1.0f}; // need not be unit length; distances are multiples of it
    float minimum = 0.0f;
    float maximum = 1e30f;
    // Blended surfaces let a ray through by chance, in proportion to their transparency; the same ray with another salt
    // takes another chance.
    std::uint32_t salt = 0;
};

struct Hit {
    float distance = 0.0f; // in multiples of the ray's direction
    std::uint32_t instance = 0;
    std::uint32_t primitive = 0;
    float u = 0.0f, v = 0.0f; // barycentric weights of the second and third vertex
};

// What stands at a hit, in the space of the changes that the scene follows (SceneChanges::space): "m" is its unit.
struct SurfacePoint {
    vec3 position{0.0f};
    // The same by its place in the triangle, which is nearer to the triangle's plane where the ray was long, and how
    // far above the surface rays that leave it must start, m; see ray_offset.
    vec3 on_triangle{0.0f};
    float offset = 0.0f;
    vec3 geometric_normal{0.0f}; // of the triangle's front side
    vec3 shading_normal{0.0f};   // interpolated, on the geometric normal's side
    scene::Material material;    // at this point: with its textures and pattern
    ecs::Entity entity;
    bool casts_shadow = true; // false: light passes; see scene::ShadowCasting
};

// How far above a surface rays must start so that rounding does not let them meet it again: some of the spacings
// between floats of the size of the surface's coordinates (C. Waechter and N. Binder, "A Fast and Robust Method for
// Avoiding Self-Intersection", Ray Tracing Gems, 2019), whatever the scene's unit and place. `coordinates`: the largest
// ones.
inline float ray_offset(vec3 coordinates) {
    return 0x1p-17f * std::max({std::abs(coordinates.x), std::abs(coordinates.y), std::abs(coordinates.z)});
}

// Which geometry a ray can meet.
enum class Scope { everything, static_only };

inline constexpr std::size_t packet_size = 16;
struct ShadowPacket {
    std::array<Ray, packet_size> rays;
    std::uint32_t active = 0xffffu; // bit i: ray i takes part
};

class RayScene {
public:
    // `instructions`: the processor's instructions that Embree may use, by its name for them ("sse2", "avx2"), for
    // tests; by default the best. Where rays meet triangles does not depend on them.
    static Result<std::unique_ptr<RayScene>> create(const char* instructions = nullptr);
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;

    // Follows the scene: builds what is new, moves movers, drops what is gone, and does nothing where nothing changed.
    // The static scene is rebuilt only if static geometry changed.
    // Masked and blended surfaces have their holes for all rays. Without `textures`, surfaces are as if they had none.
    // `progress` is called with the share that is done while static geometry or a mover's mesh is built, from any
    // thread, never concurrently; if it returns false, that is an error, and the next update builds what is missing.
    Status update(const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                  const scene::TextureStore* textures = nullptr, const std::function<bool(float)>& progress = {});
    // The same for whoever has no ChangeTracker; world transforms must be up to date.
    Status update(ecs::Registry& registry, const scene::MeshStore& meshes,
                  const scene::TextureStore* textures = nullptr, const std::function<bool(float)>& progress = {});

    // From now on meshes and textures are those of other stores, which hold the same: nothing is built again.
    void continue_with(const scene::MeshStore& meshes, const scene::TextureStore* textures);

    std::optional<Hit> closest_hit(const Ray& ray, Scope scope = Scope::everything) const;
    // Movers that cast no shadow block nothing.
    bool occluded(const Ray& ray, Scope scope = Scope::everything) const;
    // Bit i is set if ray i is occluded. Same answers as `occluded` one by one.
    std::uint32_t occluded(const ShadowPacket& packet, Scope scope = Scope::everything) const;

    // Of each active ray, how far away the first surface that casts shadows is, as a multiple of its direction;
    // infinity where there is none.
    std::array<float, packet_size> blockers(const ShadowPacket& packet, Scope scope = Scope::everything) const;

    SurfacePoint surface(const Ray& ray, const Hit& hit) const;
    // The place of an entity's triangle (weights of the second and third corner), where it is now; none if there is no
    // such entity.
    std::optional<SurfacePoint> surface_on(ecs::Entity entity, std::uint32_t primitive, float u, float v) const;
    // Radiance that an entity's triangle emits on its front at a place (weights of the second and third corner).
    vec3 emission_at(ecs::Entity entity, std::uint32_t primitive, float u, float v) const;

    // How often static geometry was built, for tests of "built once".
    std::uint32_t static_builds() const;
    // Raised when static geometry changed, or how it reflects (what it emits does not count).
    std::uint64_t static_generation() const;
    // Raised when anything changed, movers included.
    std::uint64_t generation() const;
    // ray_offset for points whose triangle is not known: by the largest coordinate of static geometry, m.
    float ray_offset_anywhere() const;
    // Area of all static triangles, m2.
    float static_area() const;

private:
    RayScene();
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace sunfleck::raytrace
