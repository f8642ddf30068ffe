// Scenes with moving lights: a game level with a moving lamp (splatting paper), and two static scenes under
// animated lights (Szecsi et al., fig. 8 to 11).
#include "assets/mesh_parts.h"
#include "assets/test_rooms.h"

#include <cmath>

namespace sunfleck::assets {
namespace {

const vec3 rock(0.50f, 0.43f, 0.36f), marble(0.74f, 0.72f, 0.68f);

scene::Mover path_line(vec3 travel, float period) {
    scene::Mover mover;
    mover.path = scene::MoverPath::line;
    mover.travel = travel;
    mover.period = period;
    return mover;
}

scene::Mover path_circle(vec3 centre, float period) {
    scene::Mover mover;
    mover.path = scene::MoverPath::circle;
    mover.centre = centre;
    mover.period = period;
    return mover;
}

void patterned(SceneBuilder& s, const std::string& name, scene::PatternKind kind, vec3 second, float scale) {
    s.registry().emplace<scene::SurfacePattern>(scene::find_by_name(s.registry(), name), {kind, second, scale});
}

} // namespace

void make_arena(SceneBuilder& s) {
    const vec3 lo(-8.0f, 0.0f, -8.0f), hi(8.0f, 5.5f, 8.0f);
    const vec3 brick(0.48f, 0.33f, 0.26f);
    s.room(lo, hi, vec3(0.42f, 0.40f, 0.38f), vec3(0.35f), {brick, brick, brick, brick});
    for (const char* wall : {"wall x-", "wall x+", "wall z-", "wall z+"})
        patterned(s, wall, scene::PatternKind::bricks, vec3(0.30f, 0.24f, 0.20f), 0.6f);
    patterned(s, "floor", scene::PatternKind::checker, vec3(0.30f, 0.29f, 0.28f), 1.0f);
    // A raised gallery on three sides, a ramp, and cover in the middle.
    s.box("walk north", vec3(-8.0f, 0.0f, -8.0f), vec3(8.0f, 1.6f, -5.4f), diffuse(rock));
    s.box("walk west", vec3(-8.0f, 0.0f, -5.4f), vec3(-5.4f, 1.6f, 4.0f), diffuse(rock));
    s.box("walk east", vec3(5.4f, 0.0f, -5.4f), vec3(8.0f, 1.6f, 0.0f), diffuse(rock));
    scene::Mesh ramp;
    append_box(ramp, vec3(-1.3f, -0.1f, 0.0f), vec3(1.3f, 0.0f, 4.3f));
    scene::Transform tilt;
    tilt.position = vec3(6.7f, 1.6f, 0.0f);
    tilt.rotation = glm::angleAxis(0.38f, vec3(1, 0, 0));
    s.add("ramp", ramp, diffuse(rock), tilt);
    for (int i = 0; i < 4; ++i) {
        const float x = i & 1 ? 2.4f : -2.4f, z = i & 2 ? 2.4f : -1.6f;
        s.box("pier " + std::to_string(i), vec3(x - 0.5f, 0.0f, z - 0.5f), vec3(x + 0.5f, 5.5f, z + 0.5f),
              diffuse(vec3(0.5f, 0.47f, 0.42f)));
    }
    for (int i = 0; i < 6; ++i)
        s.box("crate " + std::to_string(i), vec3(-4.0f + 1.5f * float(i), 0.0f, i % 2 ? 5.2f : 4.4f),
              vec3(-3.1f + 1.5f * float(i), 0.9f, i % 2 ? 6.1f : 5.3f), diffuse(vec3(0.52f, 0.38f, 0.20f)));
    s.box("quad base", vec3(-0.7f, 0.0f, -0.3f), vec3(0.7f, 0.3f, 1.1f), diffuse(vec3(0.6f, 0.2f, 0.15f)));
    const ecs::Entity knot =
        s.add("prize", scene::make_knot(0.5f), diffuse(vec3(0.75f, 0.6f, 0.2f)), placed(vec3(0.0f, 1.0f, 0.4f)));
    scene::Mover spin;
    spin.path = scene::MoverPath::spin;
    s.mover(knot, spin);
    const ecs::Entity lamp = s.point_light("lamp", vec3(3.6f, 3.4f, 0.4f), vec3(60.0f, 52.0f, 38.0f));
    s.mover(lamp, path_circle(vec3(0.0f, 3.4f, 0.4f), 16.0f));
    for (int i = 0; i < 2; ++i)
        s.ceiling_light("ceiling lamp " + std::to_string(i), vec3(i ? 5.5f : -5.5f, 5.49f, -6.5f), 1.2f, 0.6f,
                        vec3(14.0f, 15.0f, 18.0f));
    s.camera("view", vec3(-7.0f, 3.3f, 2.4f), vec3(1.0f, 1.2f, -0.6f), 66.0f);
    s.camera("bench_1", vec3(-7.0f, 3.3f, 2.4f), vec3(1.0f, 1.2f, -0.6f), 66.0f);
    s.camera("bench_2", vec3(6.8f, 1.7f, 6.8f), vec3(-1.0f, 1.4f, -1.0f), 66.0f);
    s.exposure(7.8f);
}

void make_chamber(SceneBuilder& s) {
    const vec3 lo(-4.0f, 0.0f, -5.0f), hi(4.0f, 5.0f, 5.0f);
    s.room(lo, hi, vec3(0.58f, 0.50f, 0.44f), marble, {marble, marble, vec3(0.62f, 0.42f, 0.36f), marble});
    for (const char* wall : {"wall x-", "wall x+", "wall z-", "wall z+"})
        patterned(s, wall, scene::PatternKind::marble, vec3(0.52f, 0.50f, 0.50f), 0.9f);
    patterned(s, "floor", scene::PatternKind::checker, vec3(0.36f, 0.32f, 0.30f), 0.8f);
    for (int i = 0; i < 6; ++i) {
        const std::string name = "column " + std::to_string(i);
        s.add(name, scene::make_cylinder(0.3f, 4.4f, 32), diffuse(marble),
              placed(vec3(i % 2 ? 2.7f : -2.7f, 2.2f, -3.2f + 3.2f * float(i / 2))));
        s.box(name + " base", vec3(i % 2 ? 2.25f : -3.15f, 0.0f, -3.65f + 3.2f * float(i / 2)),
              vec3(i % 2 ? 3.15f : -2.25f, 0.25f, -2.75f + 3.2f * float(i / 2)), diffuse(marble));
    }
    for (int side = 0; side < 2; ++side)
        s.box(side ? "right beam" : "left beam", vec3(side ? 2.3f : -3.1f, 4.4f, -5.0f),
              vec3(side ? 3.1f : -2.3f, 5.0f, 5.0f), diffuse(marble));
    for (int i = 0; i < 3; ++i)
        s.box("step " + std::to_string(i), vec3(-1.6f, 0.0f, -5.0f + 0.0f),
              vec3(1.6f, 0.2f * float(3 - i), -4.0f + 0.4f * float(i)), diffuse(marble));
    s.add("statue", make_figure(1.7f, 28), diffuse(vec3(0.66f, 0.60f, 0.50f)), placed(vec3(0.0f, 0.6f, -4.4f)));
    scene::Transform transform;
    transform.position = vec3(0.0f, 4.6f, 2.5f);
    transform.rotation = facing(vec3(-0.5f, 1.0f, 0.25f));
    const ecs::Entity spot = s.spot_light("spot", transform, {vec3(480.0f, 450.0f, 400.0f), 0.26f, 0.36f});
    s.mover(spot, path_line(vec3(0.0f, 0.0f, -2.4f), 12.0f));
    s.camera("view", vec3(-1.8f, 1.7f, 4.6f), vec3(0.6f, 1.9f, -2.0f), 66.0f);
    s.camera("bench_1", vec3(-1.8f, 1.7f, 4.6f), vec3(0.6f, 1.9f, -2.0f), 66.0f);
    s.exposure(8.2f);
}

namespace {

// The axis of the cave; t from 0 to 1.
vec3 cave_axis(float t) {
    return vec3(2.2f * std::sin(1.9f * t), 1.8f + 0.5f * std::sin(2.7f * t), -10.0f + 20.0f * t);
}

// A closed, winding, bumpy tube, seen from inside.
scene::Mesh make_cave_walls() {
    scene::Mesh tube;
    constexpr int rings = 120, sides = 64;
    for (int i = 0; i <= rings; ++i)
        for (int k = 0; k < sides; ++k) {
            const float t = float(i) / rings, angle = 2.0f * pi * float(k) / sides;
            const float bump = 0.16f * std::sin(5.0f * angle + 40.0f * t) * std::sin(3.0f * angle - 23.0f * t) +
                               0.07f * std::sin(11.0f * angle + 90.0f * t) +
                               0.05f * std::cos(17.0f * angle - 120.0f * t);
            const float closing = std::sqrt(std::max(0.0f, std::sin(pi * std::clamp(t, 0.0005f, 0.9995f))));
            const float radius = (2.1f + bump) * std::min(1.0f, 1.6f * closing);
            vec3 p = cave_axis(t) + radius * vec3(std::cos(angle), std::sin(angle), 0.0f);
            p.y = std::max(p.y, 0.15f * bump); // a floor to stand on
            tube.positions.push_back(p);
        }
    for (std::uint32_t i = 0; i < rings; ++i)
        for (std::uint32_t k = 0; k < sides; ++k) {
            const std::uint32_t a = i * sides + k, b = i * sides + (k + 1) % sides, c = a + sides, d = b + sides;
            tube.indices.insert(tube.indices.end(), {a, b, c, b, d, c});
        }
    scene::compute_normals(tube);
    return tube;
}

scene::Mesh make_stalagmite(float height) {
    scene::Mesh cone;
    constexpr int segments = 20;
    for (int k = 0; k <= segments; ++k) {
        const float angle = 2.0f * pi * float(k) / segments;
        cone.positions.push_back(vec3(0.22f * std::cos(angle), -0.1f, 0.22f * std::sin(angle)));
        cone.positions.push_back(vec3(0.02f * std::cos(angle), height, 0.02f * std::sin(angle)));
    }
    for (std::uint32_t k = 0; k < segments; ++k)
        cone.indices.insert(cone.indices.end(), {2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 2, 2 * k + 1, 2 * k + 3});
    scene::compute_normals(cone);
    return cone;
}

} // namespace

void make_cave(SceneBuilder& s) {
    s.add("walls", make_cave_walls(), diffuse(rock));
    patterned(s, "walls", scene::PatternKind::marble, vec3(0.36f, 0.34f, 0.34f), 1.3f);
    for (int i = 0; i < 14; ++i) {
        const float t = 0.16f + 0.05f * float(i);
        s.add("stalagmite " + std::to_string(i), make_stalagmite(0.5f + 0.09f * float(i % 7)), diffuse(rock),
              placed(vec3(cave_axis(t).x + (i % 2 ? 0.9f : -0.8f), 0.05f, cave_axis(t).z)));
    }
    const ecs::Entity torch =
        s.point_light("torch", cave_axis(0.5f) + vec3(0.0f, 0.1f, 0.0f), vec3(26.0f, 15.0f, 6.5f));
    s.mover(torch, path_line(vec3(0.3f, 0.0f, 4.0f), 14.0f));
    const ecs::Entity crystal =
        s.point_light("crystal", cave_axis(0.2f) + vec3(0.0f, -0.6f, 0.0f), vec3(2.0f, 5.0f, 9.0f));
    s.mover(crystal, path_circle(cave_axis(0.2f), 8.0f));
    s.camera("view", cave_axis(0.82f) + vec3(0.0f, -0.1f, 0.0f), cave_axis(0.45f), 66.0f);
    s.camera("bench_1", cave_axis(0.82f) + vec3(0.0f, -0.1f, 0.0f), cave_axis(0.45f), 66.0f);
    s.exposure(9.2f);
}

} // namespace sunfleck::assets
