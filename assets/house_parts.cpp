// Furniture, lamps and things that move.
#include "assets/house_parts.h"

#include "engine/scene/summer_sky.h"

#include <algorithm>

namespace sunfleck::assets {
namespace {

const vec3 dark_cord(0.06f);

} // namespace

void House::sky(vec3 radiance) {
    const ecs::Entity entity = group("sky", vec3(0.0f));
    s_.registry().emplace<scene::Environment>(entity, {radiance, false});
    s_.registry().emplace<scene::EnvironmentMap>(entity,
                                                 {std::string(scene::summer_sky_name), 0.0f, scene::summer_sky()});
}

void House::player_start(vec3 foot, vec3 looking_at) {
    const ecs::Entity entity = group("player start", foot);
    s_.registry().patch<scene::Transform>(entity, [&](scene::Transform& t) { t.rotation = facing(foot - looking_at); });
    s_.registry().emplace<scene::PlayerStart>(entity, {});
}

ecs::Entity House::add(const std::string& name, scene::Mesh mesh, vec3 colour, vec3 position) {
    scene::Transform transform;
    transform.position = position;
    return s_.add(name, std::move(mesh), diffuse(colour), transform);
}

void House::pattern(const std::string& name, const scene::SurfacePattern& pattern) {
    s_.registry().emplace<scene::SurfacePattern>(scene::find_by_name(s_.registry(), name), pattern);
}

void House::table(const std::string& name, vec3 foot, float height, float radius, vec3 colour) {
    add(name + " top", scene::make_cylinder(radius, 0.05f, 32), colour, foot + vec3(0.0f, height - 0.025f, 0.0f));
    add(name + " leg", scene::make_cylinder(0.05f, height - 0.05f, 16), colour,
        foot + vec3(0.0f, 0.5f * (height - 0.05f), 0.0f));
}

void House::wall_lamp(const std::string& name, vec3 centre, vec3 facing_to, float width, float height, vec3 radiance) {
    scene::AreaLight light;
    light.width = width;
    light.height = height;
    light.radiance = radiance;
    scene::Transform transform;
    transform.position = centre;
    transform.rotation = facing(facing_to);
    s_.area_light(name, light, transform);
}

ecs::Entity House::sphere_light(const std::string& name, vec3 centre, float radius, vec3 radiance) {
    scene::AreaLight light;
    light.shape = scene::AreaShape::sphere;
    light.radius = radius;
    light.radiance = radiance;
    scene::Transform transform;
    transform.position = centre;
    return s_.area_light(name, light, transform);
}

void House::globe_lamp(const std::string& name, vec3 centre, float radius, vec3 radiance, vec3 stem) {
    sphere_light(name, centre, radius, radiance);
    add(name + " stem", scene::make_cylinder(0.03f, 0.05f, 12), stem, centre - vec3(0.0f, radius + 0.025f, 0.0f));
}

void House::light_switch(const std::string& name, vec3 centre, vec3 facing_to, const std::string& lamps) {
    const vec3 half = glm::mix(vec3(0.045f), vec3(0.012f), glm::abs(facing_to)) + vec3(0.0f, 0.025f, 0.0f);
    const ecs::Entity entity = boxes(name, {{centre - half, centre + half}}, vec3(0.85f, 0.83f, 0.76f));
    s_.registry().emplace<scene::LightSwitch>(entity, {lamps, true});
}

ecs::Entity House::group(const std::string& name, vec3 position) {
    ecs::Registry& registry = s_.registry();
    const ecs::Entity entity = registry.create();
    registry.emplace<scene::Name>(entity, {name});
    scene::Transform transform;
    transform.position = position;
    registry.emplace<scene::Transform>(entity, transform);
    return entity;
}

// A part of a moving object, without collision.
ecs::Entity House::part(const std::string& name, ecs::Entity parent, scene::Mesh mesh, vec3 colour, vec3 position) {
    const ecs::Entity entity = add(name, std::move(mesh), colour, position);
    s_.registry().emplace<scene::Parent>(entity, {parent});
    s_.registry().emplace<scene::ShadowCasting>(entity, {false});
    body(entity, scene::BodyShape::none, 0.0f);
    return entity;
}

void House::body(ecs::Entity entity, scene::BodyShape shape, float mass) {
    scene::RigidBody described;
    described.shape = shape;
    described.mass = mass;
    s_.registry().emplace<scene::RigidBody>(entity, described);
}

void House::sliding_door(const std::string& name, vec3 centre, vec3 size, vec3 travel, vec3 colour) {
    const ecs::Entity door = add(name, scene::make_box(size), colour, centre);
    scene::Mover mover;
    mover.path = scene::MoverPath::line;
    mover.travel = travel;
    mover.period = 1.8f;
    mover.activation = scene::MoverActivation::near;
    mover.reach = 2.1f;
    s_.mover(door, mover);
    s_.registry().emplace<scene::SurfacePattern>(door, {PatternKind::planks, vec3(0.34f, 0.21f, 0.11f), 0.18f});
}

void House::swinging_door(const std::string& name, vec3 centre, vec3 size, vec3 hinge, float angle, vec3 colour) {
    const ecs::Entity door = add(name, scene::make_box(size), colour, centre);
    scene::Mover mover;
    mover.path = scene::MoverPath::hinge;
    mover.centre = hinge;
    mover.angle = angle;
    mover.period = 2.6f;
    mover.activation = scene::MoverActivation::use;
    s_.mover(door, mover);
}

void House::lift(const std::string& name, const Box& platform, float low, float high, float period, vec3 colour) {
    const vec3 size = platform.highest - platform.lowest;
    const float half = 0.5f * (high - low);
    const vec3 middle(0.5f * (platform.lowest.x + platform.highest.x), low + half - 0.5f * size.y,
                      0.5f * (platform.lowest.z + platform.highest.z));
    const ecs::Entity entity = add(name, scene::make_box(size), colour, middle);
    scene::Mover mover;
    mover.path = scene::MoverPath::line;
    mover.travel = vec3(0.0f, half, 0.0f);
    mover.period = period;
    mover.phase = -0.25f; // starts at the bottom
    mover.easing = scene::MoverEasing::dwell;
    s_.mover(entity, mover);
}

void House::turning_panel(const std::string& name, vec3 centre, vec3 size, float period, vec3 colour) {
    const ecs::Entity panel = add(name, scene::make_box(size), colour, centre);
    scene::Mover mover;
    mover.path = scene::MoverPath::spin;
    mover.period = period;
    s_.mover(panel, mover);
}

void House::swinging_lamp(const std::string& name, vec3 pivot, float length, vec3 radiance, vec3 colour) {
    const ecs::Entity lamp = group(name, pivot);
    scene::Mover mover;
    mover.path = scene::MoverPath::hinge;
    mover.centre = pivot;
    mover.axis = vec3(0.35f, 0.0f, 1.0f);
    mover.angle = 0.34f;
    mover.period = 6.0f;
    s_.mover(lamp, mover);
    part(name + " cord", lamp, scene::make_cylinder(0.012f, length - 0.1f, 8), dark_cord,
         vec3(0.0f, -0.5f * (length - 0.1f), 0.0f));
    part(name + " shade", lamp, scene::make_cylinder(0.24f, 0.08f, 28), colour, vec3(0.0f, -length + 0.05f, 0.0f));
    scene::AreaLight light;
    light.shape = scene::AreaShape::disc;
    light.radius = 0.2f;
    light.radiance = radiance;
    scene::Transform transform;
    transform.position = vec3(0.0f, -length, 0.0f);
    transform.rotation = glm::angleAxis(0.5f * pi, vec3(1.0f, 0.0f, 0.0f)); // maps +Z to -Y
    const ecs::Entity disc = s_.area_light(name + " light", light, transform);
    s_.registry().emplace<scene::Parent>(disc, {lamp});
    s_.registry().emplace<scene::ShadowCasting>(disc, {false});
    body(disc, scene::BodyShape::none, 0.0f);
}

void House::mobile(const std::string& name, scene::Mesh mesh, vec3 colour, const std::vector<vec3>& points,
                   float period) {
    const ecs::Entity entity = add(name, std::move(mesh), colour, points.front());
    scene::Mover mover;
    mover.path = scene::MoverPath::spline;
    mover.period = period;
    s_.mover(entity, mover);
    scene::SplinePath path;
    vec3* targets[] = {&path.point_1, &path.point_2, &path.point_3, &path.point_4, &path.point_5, &path.point_6};
    path.count = std::uint32_t(std::min<std::size_t>(points.size(), 6));
    for (std::uint32_t i = 0; i < path.count; ++i)
        *targets[i] = points[i];
    path.face_travel = true;
    s_.registry().emplace<scene::SplinePath>(entity, path);
    body(entity, scene::BodyShape::none, 0.0f);
}

void House::ball(const std::string& name, vec3 centre, float radius, float mass, vec3 colour) {
    const ecs::Entity entity = add(name, scene::make_sphere(radius, 32, 16), colour, centre);
    s_.mover(entity, {});
    body(entity, scene::BodyShape::sphere, mass);
}

void House::glowing_ball(const std::string& name, vec3 centre, float radius, float mass, vec3 radiance) {
    const ecs::Entity entity = sphere_light(name, centre, radius, radiance);
    s_.mover(entity, {});
    body(entity, scene::BodyShape::sphere, mass);
}

void House::crate(const std::string& name, vec3 centre, float side, float mass, vec3 colour) {
    const ecs::Entity entity = add(name, scene::make_box(vec3(side)), colour, centre);
    s_.mover(entity, {});
    body(entity, scene::BodyShape::box, mass);
    s_.registry().emplace<scene::SurfacePattern>(entity, {PatternKind::planks, vec3(0.30f, 0.18f, 0.09f), 0.11f});
}

void show_base_colour(scene::Material& material) {
    material.unlit = material.specular = true;
}

void House::lantern(const std::string& name, vec3 foot, vec3 intensity, vec3 colour, const LanternForm& form) {
    const ecs::Entity lantern = group(name, foot);
    s_.mover(lantern, {});
    s_.registry().emplace<scene::Lantern>(lantern, {});
    // Plates of 3 cm, into which the posts reach by 1 cm.
    const auto plate = [&](const char* which, float radius, float height) {
        part(name + which, lantern, scene::make_cylinder(radius, 0.03f, 20), colour, vec3(0.0f, height, 0.0f));
    };
    plate(" base", form.base_radius, 0.015f);
    plate(" cap", form.cap_radius, form.posts + 0.025f);
    const float middle = 0.5f * form.posts + 0.02f;
    for (int i = 0; i < 3; ++i) {
        const float angle = 2.0f * pi * (float(i) + 0.5f) / 3.0f;
        part(name + " post " + std::to_string(i), lantern, scene::make_cylinder(0.006f, form.posts, 8), colour,
             vec3(form.ring_radius * std::cos(angle), middle, form.ring_radius * std::sin(angle)));
    }
    flame(name, lantern, intensity, form);
    // The flame is only visible; the point light above it gives the light.
    const ecs::Entity light = group(name + " light", vec3(0.0f, form.light_height, 0.0f));
    s_.registry().emplace<scene::Parent>(light, {lantern});
    s_.registry().emplace<scene::PointLight>(light, {intensity});
}

void House::flame(const std::string& name, ecs::Entity lantern, vec3 intensity, const LanternForm& form) {
    const ecs::Entity flame =
        part(name + " flame", lantern, scene::make_sphere(form.flame_radius, 16, 8),
             form.flame_emits ? vec3(0.0f) : vec3(1.0f, 0.93f, 0.72f), vec3(0.0f, form.flame_height, 0.0f));
    s_.registry().patch<scene::Material>(flame, [&](scene::Material& material) {
        if (form.flame_emits)
            material.emission = 3.0f * intensity;
        else
            show_base_colour(material);
    });
}

} // namespace sunfleck::assets
