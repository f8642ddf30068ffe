// Arches and pillars under one spot light (Nijasure, fig. 2 to 5), and a large atrium with many materials.
#include "assets/mesh_parts.h"
#include "assets/test_rooms.h"

#include <cmath>

namespace sunfleck::assets {
namespace {

const vec3 plaster(0.72f, 0.69f, 0.63f), stone(0.58f, 0.54f, 0.48f);

void spot(SceneBuilder& s, const std::string& name, vec3 position, vec3 target, const scene::SpotLight& light) {
    scene::Transform transform;
    transform.position = position;
    transform.rotation = facing(position - target); // shines along its -Z
    s.spot_light(name, transform, light);
}

void pillar(SceneBuilder& s, const std::string& name, const scene::Mesh& shape, vec3 foot, vec3 colour) {
    s.add(name, shape, diffuse(colour), placed(foot));
}

// Base, shaft and capital in one mesh.
scene::Mesh make_pillar(float radius, float height, int segments) {
    scene::Mesh mesh;
    const auto lifted = [](float y) { return glm::translate(mat4(1.0f), vec3(0.0f, y, 0.0f)); };
    append_box(mesh, vec3(-1.5f * radius, 0.0f, -1.5f * radius), vec3(1.5f * radius, 0.18f, 1.5f * radius));
    append(mesh, scene::make_torus(1.05f * radius, 0.07f, segments, segments / 4), lifted(0.24f));
    append(mesh, scene::make_cylinder(radius, height - 0.42f, segments), lifted(0.18f + 0.5f * (height - 0.42f)));
    append(mesh, scene::make_torus(1.05f * radius, 0.07f, segments, segments / 4), lifted(height - 0.3f));
    append_box(mesh, vec3(-1.5f * radius, height - 0.24f, -1.5f * radius), vec3(1.5f * radius, height, 1.5f * radius));
    return mesh;
}

} // namespace

void make_hall(SceneBuilder& s) {
    const vec3 lo(-5.0f, 0.0f, -7.0f), hi(5.0f, 4.6f, 7.0f);
    s.room(lo, hi, vec3(0.66f, 0.46f, 0.30f), plaster, {plaster, plaster, vec3(0.55f, 0.62f, 0.70f), plaster});
    const scene::Mesh shape = make_pillar(0.26f, 2.5f, 18);
    const scene::Mesh arch = make_arch(3.0f, 2.1f, 0.5f, 2.45f, 0.01f, 20);
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i <= 4; ++i) {
            const float x = side ? 2.6f : -2.6f, z = -6.0f + 3.0f * float(i);
            const std::string name = std::string(side ? "right " : "left ") + std::to_string(i);
            pillar(s, name + " pillar", shape, vec3(x, 0.0f, z), stone);
            if (i < 4) {
                scene::Transform turned = placed(vec3(x + 0.25f, 2.5f, z), -0.5f * pi);
                s.add(name + " arch", arch, diffuse(plaster), turned);
            }
        }
    s.add("figure", make_figure(1.8f, 20), diffuse(vec3(0.62f, 0.25f, 0.2f)), placed(vec3(0.9f, 0.0f, -1.2f), 0.5f));
    s.add("ball", scene::make_sphere(0.45f, 32, 16), diffuse(vec3(0.75f)), placed(vec3(-1.0f, 0.45f, 0.4f)));
    spot(s, "spot", vec3(0.0f, 4.4f, 1.0f), vec3(0.0f, 0.0f, -0.6f), {vec3(420.0f, 395.0f, 340.0f), 0.30f, 0.42f});
    s.camera("view", vec3(0.0f, 1.8f, 6.4f), vec3(0.0f, 1.7f, -1.0f), 60.0f);
    s.camera("bench_1", vec3(0.0f, 1.8f, 6.4f), vec3(0.0f, 1.7f, -1.0f), 60.0f);
    s.camera("bench_2", vec3(-4.4f, 1.7f, 5.5f), vec3(1.5f, 1.6f, -2.5f), 64.0f);
    s.exposure(7.6f);
}

void make_gallery(SceneBuilder& s) {
    const vec3 lo(-9.0f, 0.0f, -6.0f), hi(9.0f, 4.2f, 6.0f);
    const vec3 yellow(0.74f, 0.60f, 0.26f); // the floor's colour bleeds onto walls and ceiling
    s.room(lo, hi, yellow, plaster, {plaster, plaster, plaster, plaster});
    for (int i = 0; i < 2; ++i) { // two dividing walls with an arch each
        scene::Transform turned = placed(vec3(i ? 3.2f : -2.8f, 0.0f, -6.0f), -0.5f * pi);
        s.add(i ? "right arch" : "left arch", make_arch(12.0f, 4.2f, 0.4f, 3.2f, 1.7f, 48), diffuse(plaster), turned);
    }
    const vec3 tints[] = {vec3(0.7f, 0.3f, 0.25f),  vec3(0.3f, 0.45f, 0.65f), vec3(0.35f, 0.55f, 0.35f),
                          vec3(0.65f, 0.6f, 0.55f), vec3(0.55f, 0.4f, 0.6f),  vec3(0.6f, 0.5f, 0.3f)};
    for (int i = 0; i < 6; ++i) { // sculptures on plinths
        const float x = -7.0f + 2.8f * float(i), z = i % 2 ? 2.6f : -2.6f;
        const std::string name = "sculpture " + std::to_string(i);
        s.box(name + " plinth", vec3(x - 0.4f, 0.0f, z - 0.4f), vec3(x + 0.4f, 0.9f, z + 0.4f), diffuse(vec3(0.75f)));
        scene::Mesh shape = i % 3 == 0   ? scene::make_knot(0.5f, 380, 30)
                            : i % 3 == 1 ? scene::make_torus(0.34f, 0.13f, 96, 48)
                                         : make_figure(1.1f, 40);
        const float height = i % 3 == 2 ? 0.9f : 1.45f;
        s.add(name, std::move(shape), diffuse(tints[i]), placed(vec3(x, height, z), 0.7f * float(i)));
    }
    for (int i = 0; i < 12; ++i) { // pictures
        const bool front = i % 2 == 0;
        const float x = -7.5f + 1.35f * float(i), z = front ? -5.97f : 5.97f;
        const std::string name = "picture " + std::to_string(i);
        s.box(name + " frame", vec3(x - 0.5f, 1.2f, z - 0.03f), vec3(x + 0.5f, 2.4f, z + 0.03f),
              diffuse(vec3(0.35f, 0.25f, 0.15f)));
        const ecs::Entity canvas = s.box(name, vec3(x - 0.42f, 1.28f, front ? -5.94f : 5.90f),
                                         vec3(x + 0.42f, 2.32f, front ? -5.90f : 5.94f), diffuse(tints[i % 6]));
        s.registry().emplace<scene::SurfacePattern>(canvas, {scene::PatternKind::marble, tints[(i + 2) % 6], 0.3f});
    }
    spot(s, "spot", vec3(0.2f, 4.0f, 0.5f), vec3(0.2f, 0.0f, 0.0f), {vec3(420.0f, 400.0f, 350.0f), 0.5f, 0.75f});
    s.camera("view", vec3(-1.6f, 1.7f, 4.9f), vec3(2.2f, 1.5f, -2.4f), 64.0f);
    s.camera("bench_1", vec3(-1.6f, 1.7f, 4.9f), vec3(2.2f, 1.5f, -2.4f), 64.0f);
    s.camera("bench_2", vec3(8.2f, 1.8f, 4.4f), vec3(1.0f, 1.4f, -1.0f), 62.0f);
    s.exposure(9.4f);
}

namespace {

// Three storeys of columns, each storey in its own colours: together with the rest, 60 materials.
void add_galleries(SceneBuilder& s) {
    const scene::Mesh column = make_pillar(0.28f, 3.6f, 52);
    int number = 0;
    for (int storey = 0; storey < 3; ++storey)
        for (int i = 0; i < 16; ++i, ++number) {
            const int side = i / 4;
            const float along = -6.0f + 3.0f * float(i % 4) + 1.5f;
            const vec3 foot = vec3(side == 0   ? along
                                   : side == 1 ? 8.0f
                                   : side == 2 ? -along
                                               : -8.0f,
                                   4.1f * float(storey),
                                   side == 0   ? -8.0f
                                   : side == 1 ? along
                                   : side == 2 ? 8.0f
                                               : -along);
            const float hue = float(number) * 0.61803f;
            const vec3 tint = 0.5f + 0.25f * vec3(std::cos(6.2832f * hue), std::cos(6.2832f * (hue + 0.33f)),
                                                  std::cos(6.2832f * (hue + 0.66f)));
            pillar(s, "column " + std::to_string(number), column, foot, tint);
        }
    for (int storey = 1; storey < 3; ++storey) // the galleries' floors
        for (int side = 0; side < 4; ++side) {
            const float y = 4.1f * float(storey) - 0.4f;
            const std::string name = "floor " + std::to_string(storey) + " " + std::to_string(side);
            const bool across = side % 2 == 0;
            const float sign = side < 2 ? 1.0f : -1.0f;
            const vec3 a(across ? -11.0f : sign * 7.2f, y, across ? sign * 7.2f : -7.2f);
            const vec3 b(across ? 11.0f : sign * 11.0f, y + 0.4f, across ? sign * 11.0f : 7.2f);
            s.box(name, glm::min(a, b), glm::max(a, b), diffuse(vec3(0.62f, 0.58f, 0.52f)));
        }
}

} // namespace

void make_atrium(SceneBuilder& s) {
    const vec3 lo(-11.0f, 0.0f, -11.0f), hi(11.0f, 13.0f, 11.0f);
    s.room(lo, hi, vec3(0.6f, 0.55f, 0.5f), plaster, {plaster, plaster, plaster, plaster},
           {{"skylight", vec2(0.0f), 8.0f, 8.0f, vec3(9.0f, 9.5f, 10.5f)}});
    add_galleries(s);
    for (int i = 0; i < 4; ++i) // finely tessellated knots in place of leafy plants
        s.add("ornament " + std::to_string(i), scene::make_knot(1.6f, 330, 32),
              diffuse(vec3(0.25f + 0.1f * float(i), 0.5f, 0.3f)),
              placed(vec3(i & 1 ? 3.5f : -3.5f, 1.7f, i & 2 ? 3.5f : -3.5f), float(i)));
    s.add("fountain", scene::make_torus(1.6f, 0.35f, 160, 64), diffuse(vec3(0.6f, 0.62f, 0.66f)),
          placed(vec3(0.0f, 0.35f, 0.0f)));
    s.add("ball", scene::make_sphere(0.8f, 128, 64), diffuse(vec3(0.7f, 0.35f, 0.25f)), placed(vec3(0.0f, 1.9f, 0.0f)));
    s.camera("view", vec3(-9.8f, 5.9f, 9.8f), vec3(1.0f, 3.0f, -1.0f), 66.0f);
    s.camera("bench_1", vec3(-9.8f, 5.9f, 9.8f), vec3(1.0f, 3.0f, -1.0f), 66.0f);
    s.exposure(9.0f);
}

} // namespace sunfleck::assets
