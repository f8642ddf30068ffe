// A metal ring and a glass body, each on a wooden plate under one spot light (Dachsbacher and Stamminger, fig. 4).
#include "assets/mesh_parts.h"
#include "assets/test_rooms.h"

namespace sunfleck::assets {
namespace {

void plate_under_spot(SceneBuilder& s) {
    const ecs::Entity plate =
        s.box("plate", vec3(-1.0f, -0.06f, -1.0f), vec3(1.0f, 0.0f, 1.0f), diffuse(vec3(0.60f, 0.42f, 0.25f)));
    s.registry().emplace<scene::SurfacePattern>(plate, {scene::PatternKind::planks, vec3(0.46f, 0.30f, 0.17f), 0.12f});
    s.quad("back wall", vec3(-2.5f, -0.06f, -1.8f), vec3(5, 0, 0), vec3(0, 3, 0), diffuse(vec3(0.45f, 0.45f, 0.5f)));
    s.quad("table", vec3(-2.5f, -0.061f, 2.5f), vec3(5, 0, 0), vec3(0, 0, -4.3f), diffuse(vec3(0.35f)));
    scene::Transform transform;
    transform.position = vec3(1.5f, 1.7f, 0.5f);
    transform.rotation = facing(transform.position - vec3(0.0f, 0.1f, 0.0f));
    s.spot_light("spot", transform, {vec3(60.0f, 56.0f, 50.0f), 0.28f, 0.40f});
    s.camera("view", vec3(-0.5f, 1.25f, 1.7f), vec3(0.0f, 0.05f, -0.05f), 45.0f);
    s.camera("bench_1", vec3(-0.5f, 1.25f, 1.7f), vec3(0.0f, 0.05f, -0.05f), 45.0f);
    s.exposure(9.6f);
}

} // namespace

void make_ring(SceneBuilder& s) {
    plate_under_spot(s);
    scene::Material metal;
    metal.base_colour = vec3(0.95f, 0.78f, 0.42f);
    metal.metallic = 1.0f;
    metal.roughness = 0.12f;
    scene::Mesh band; // a band, taller than thick, open above and below
    constexpr int segments = 160;
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i <= segments; ++i) {
            const float angle = 2.0f * pi * float(i) / float(segments), radius = side ? 0.40f : 0.42f;
            const vec3 out(std::cos(angle), 0.0f, std::sin(angle));
            for (const float y : {0.0f, 0.22f}) {
                band.positions.push_back(radius * out + vec3(0.0f, y, 0.0f));
                band.normals.push_back(side ? -out : out);
            }
        }
    const auto vertex = [](int side, int i, int up) { return std::uint32_t((side * (segments + 1) + i) * 2 + up); };
    for (int i = 0; i < segments; ++i) {
        band.indices.insert(band.indices.end(), {vertex(0, i, 0), vertex(0, i, 1), vertex(0, i + 1, 0),
                                                 vertex(0, i + 1, 0), vertex(0, i, 1), vertex(0, i + 1, 1)});
        band.indices.insert(band.indices.end(), {vertex(1, i, 0), vertex(1, i + 1, 0), vertex(1, i, 1),
                                                 vertex(1, i + 1, 0), vertex(1, i + 1, 1), vertex(1, i, 1)});
        band.indices.insert(band.indices.end(), {vertex(0, i, 1), vertex(1, i, 1), vertex(0, i + 1, 1),
                                                 vertex(0, i + 1, 1), vertex(1, i, 1), vertex(1, i + 1, 1)});
    }
    s.add("ring", std::move(band), metal, placed(vec3(0.0f, 0.001f, 0.0f)));
}

void make_glass(SceneBuilder& s) {
    plate_under_spot(s);
    scene::Material glass;
    glass.base_colour = vec3(1.0f);
    glass.transmission = 1.0f;
    glass.roughness = 0.0f;
    glass.specular = true;
    // A bird of three balls: body, head and tail.
    scene::Mesh bird;
    const auto ball = [&](vec3 centre, vec3 radii) {
        append(bird, scene::make_sphere(1.0f, 64, 32), glm::scale(glm::translate(mat4(1.0f), centre), radii));
    };
    ball(vec3(0.0f, 0.26f, 0.0f), vec3(0.30f, 0.26f, 0.24f));
    s.add("body", bird, glass);
    bird = {};
    ball(vec3(-0.24f, 0.62f, 0.0f), vec3(0.16f));
    s.add("head", bird, glass);
    bird = {};
    ball(vec3(0.42f, 0.36f, 0.0f), vec3(0.14f, 0.06f, 0.10f));
    s.add("tail", bird, glass);
    s.box("beak", vec3(-0.50f, 0.59f, -0.03f), vec3(-0.38f, 0.63f, 0.03f), diffuse(vec3(0.8f, 0.45f, 0.1f)));
}

} // namespace sunfleck::assets
