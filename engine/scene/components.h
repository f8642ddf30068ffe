// The components of a scene. Radiometric RGB, linear Rec. 709; metres, seconds, radians. World space unless said.
#pragma once

#include "engine/ecs/registry.h"

#include <string>

namespace sunfleck::scene {

struct Name {
    std::string name;
    static const TypeDescription& description();
};

// Relative to the parent, or to the world without one.
struct Transform {
    vec3 position{0.0f};
    quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
    vec3 scale{1.0f};
    bool operator==(const Transform&) const = default;
    static const TypeDescription& description();

    mat4 matrix() const {
        return glm::translate(mat4(1.0f), position) * glm::mat4_cast(rotation) * glm::scale(mat4(1.0f), scale);
    }
};

struct Parent {
    ecs::Entity parent;
    static const TypeDescription& description();
};

// Derived by update_world_transforms; never edited or saved.
struct WorldTransform {
    static constexpr bool derived = true;
    mat4 matrix{1.0f};
    bool operator==(const WorldTransform&) const = default;
};

struct MeshInstance {
    std::uint32_t mesh = 0; // index in the MeshStore
    static const TypeDescription& description();
};

// opaque: alpha is ignored. mask: cut out where alpha is below the cutoff. blend: alpha is the fraction of light
// blocked.
enum class AlphaMode : std::uint32_t { opaque, mask, blend };

// BSDF of the entity's mesh: Lambertian and GGX as in glTF 2.0, or smooth glass where transmission is above zero.
struct Material {
    vec3 base_colour{0.8f};
    float metallic = 0.0f;
    float roughness = 1.0f;
    vec3 emission{0.0f}; // radiance, W/(sr m2), on the front side
    float transmission = 0.0f;
    float index_of_refraction = 1.5f;
    bool specular = false; // dielectric GGX layer over the diffuse base; off: purely Lambertian unless metallic
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha = 1.0f;
    float alpha_cutoff = 0.5f; // of mask
    bool double_sided = true;  // false: invisible from behind in images; light transport treats both sides as solid
    bool unlit = false;        // images show its base colour unlit; in light transport it is Lambertian
    bool operator==(const Material&) const = default;
    static const TypeDescription& description();
};

// A texture (index in the TextureStore) and its KHR_texture_transform.
struct TextureUse {
    std::int32_t texture = -1; // -1: none
    std::uint32_t set = 0;     // of texture coordinates, 0 or 1
    vec2 offset{0.0f}, scale{1.0f};
    float rotation = 0.0f; // rad, counter-clockwise on the image

    explicit operator bool() const { return texture >= 0; }
    // The transform without its offset, as a column-major matrix.
    glm::mat2 matrix() const {
        const float c = std::cos(rotation), s = std::sin(rotation);
        return glm::mat2(c * scale.x, -s * scale.x, s * scale.y, c * scale.y);
    }
    // `both`: the mesh's two sets.
    vec2 coordinates(vec4 both) const {
        return matrix() * (set == 0 ? vec2(both.x, both.y) : vec2(both.z, both.w)) + offset;
    }
    bool operator==(const TextureUse&) const = default;
};

// Textures that scale the values of the entity's Material, as in glTF 2.0.
struct MaterialTextures {
    TextureUse base_colour;        // rgb and alpha
    TextureUse metallic_roughness; // blue and green
    TextureUse normal;             // tangent space
    TextureUse emission;           // rgb
    TextureUse transmission;       // red
    float normal_scale = 1.0f;     // of x and y
    vec3 emission_average{1.0f};   // mean of the emission texture, which samplers use for the whole mesh
    bool operator==(const MaterialTextures&) const = default;
};

struct Camera {
    float vertical_field_of_view = 0.9f;
    static const TypeDescription& description();
};

struct Exposure {
    float ev100 = 8.0f;
    static const TypeDescription& description();
};

enum class AreaShape : std::uint32_t { rectangle, disc, sphere };

// An area light of simple shape: rectangle and disc lie in the local XY plane and radiate along +Z; the sphere radiates
// outwards. Its entity also has the mesh of the shape, with the same emission, for cameras and rays to see.
struct AreaLight {
    AreaShape shape = AreaShape::rectangle;
    float width = 1.0f;  // rectangle, along X
    float height = 1.0f; // rectangle, along Y
    float radius = 0.5f; // disc and sphere
    vec3 radiance{1.0f}; // W/(sr m2), Lambertian
    bool operator==(const AreaLight&) const = default;
    static const TypeDescription& description();
};

struct PointLight {
    vec3 intensity{1.0f}; // radiant intensity, W/sr
    bool operator==(const PointLight&) const = default;
    static const TypeDescription& description();
};

// Radiates along the local -Z axis; intensity falls between the cones as in KHR_lights_punctual.
struct SpotLight {
    vec3 intensity{1.0f}; // radiant intensity on the axis, W/sr
    float inner_angle = 0.3f;
    float outer_angle = 0.6f;
    bool operator==(const SpotLight&) const = default;
    static const TypeDescription& description();
};

// Light from infinity, travelling along the local -Z axis.
struct DirectionalLight {
    vec3 irradiance{1.0f}; // on a plane that faces it, W/m2
    bool operator==(const DirectionalLight&) const = default;
    static const TypeDescription& description();
};

// Light from the surroundings, for rays that hit nothing.
struct Environment {
    vec3 radiance{0.0f}; // W/(sr m2)
    bool lights = true;  // false: a visible background only, whose light comes from area lights in the windows
    bool operator==(const Environment&) const = default;
    static const TypeDescription& description();
};

enum class MoverPath : std::uint32_t { none, line, circle, spin, hinge, spline };
// Easing along a line or hinge: sinusoidal like a pendulum, at constant speed, or resting a quarter of the time at both
// ends.
enum class MoverEasing : std::uint32_t { sine, linear, dwell };
// clock: always. near: moves to its far end while a person is within `reach`, then back. use: when a person uses it.
// sensor: to its far end while every LightSensor that names it is open, then back.
enum class MoverActivation : std::uint32_t { clock, near, use, sensor };

// A moving entity. On the clock, its pose is a function of the simulation step alone, relative to its initial
// transform; when activated, it moves from there to the end of its line or hinge in half a period, and back.
struct Mover {
    MoverPath path = MoverPath::none;
    vec3 travel{1.0f, 0.0f, 0.0f}; // line: half of the travel, m; activated: all of it
    vec3 centre{0.0f};             // circle: centre, in the plane normal to `axis`; hinge: a point on its axis
    vec3 axis{0.0f, 1.0f, 0.0f};   // circle, spin and hinge
    float angle = 1.5f;            // hinge: rad, to both sides; activated: to one side
    float period = 8.0f;           // s for one full cycle
    float phase = 0.0f;            // fraction of a period
    float spin_period = 0.0f;      // s for one revolution about its own vertical axis; 0: no spin
    MoverEasing easing = MoverEasing::sine;
    MoverActivation activation = MoverActivation::clock;
    float reach = 1.8f; // m, for `near`
    static const TypeDescription& description();
};

// The mover's transform when the simulation began; set by the simulation.
struct MoverOrigin {
    static constexpr bool derived = true;
    Transform transform;
};

// A procedural pattern in the mesh's own space, for surfaces without texture coordinates.
enum class PatternKind : std::uint32_t { none, checker, planks, bricks, marble };

struct SurfacePattern {
    PatternKind kind = PatternKind::checker;
    vec3 colour{0.5f};   // the second one; the first is the material's
    float scale = 0.25f; // m, size of a square, plank, brick or vein
    bool operator==(const SurfacePattern&) const = default;
    static const TypeDescription& description();
};

// An entity without this component casts shadows.
struct ShadowCasting {
    bool casts = false; // off for thin objects and lamp housings
    static const TypeDescription& description();
};

// True if neither the entity nor an ancestor has a Mover.
bool is_static(const ecs::Registry& registry, ecs::Entity entity);

// Brings WorldTransform up to date for all entities with a Transform; unchanged ones keep their change tick. A cycle of
// parents is broken where it closes.
void update_world_transforms(ecs::Registry& registry);

// The entity's world matrix, computed from the hierarchy.
mat4 world_matrix(const ecs::Registry& registry, ecs::Entity entity);

// First entity of that name, by index; null if there is none.
ecs::Entity find_by_name(ecs::Registry& registry, std::string_view name);

// Registers every component of this header.
void register_components(ecs::Registry& registry);

} // namespace sunfleck::scene
