// Rooms with many small occluders (Udeshi and Hansen, table 2).
#include "assets/mesh_parts.h"
#include "assets/test_rooms.h"

namespace sunfleck::assets {
namespace {

const vec3 wood(0.56f, 0.40f, 0.24f), white(0.74f), metal(0.35f, 0.37f, 0.40f);

// A table top on four legs, centred on the origin.
scene::Mesh make_table(float width, float depth, float height, float leg) {
    scene::Mesh mesh;
    append_box(mesh, vec3(-0.5f * width, height - 0.04f, -0.5f * depth), vec3(0.5f * width, height, 0.5f * depth));
    for (int i = 0; i < 4; ++i) {
        const float x = (i & 1 ? 0.5f : -0.5f) * (width - 2.0f * leg),
                    z = (i & 2 ? 0.5f : -0.5f) * (depth - 2.0f * leg);
        append_box(mesh, vec3(x - 0.5f * leg, 0.0f, z - 0.5f * leg),
                   vec3(x + 0.5f * leg, height - 0.04f, z + 0.5f * leg));
    }
    return mesh;
}

// A seat on four legs with a back of three slats, facing -Z.
scene::Mesh make_chair() {
    scene::Mesh mesh = make_table(0.42f, 0.42f, 0.45f, 0.035f);
    for (const float x : {-0.19f, 0.19f})
        append_box(mesh, vec3(x - 0.018f, 0.45f, 0.17f), vec3(x + 0.018f, 0.9f, 0.206f));
    for (int i = 0; i < 3; ++i)
        append_box(mesh, vec3(-0.172f, 0.56f + 0.13f * float(i), 0.18f), vec3(0.172f, 0.62f + 0.13f * float(i), 0.2f));
    return mesh;
}

// Boards and rows of books of varied height, facing +Z.
scene::Mesh make_shelf(float width, float height, int boards) {
    scene::Mesh mesh;
    append_box(mesh, vec3(0.0f), vec3(0.03f, height, 0.3f));
    append_box(mesh, vec3(width - 0.03f, 0.0f, 0.0f), vec3(width, height, 0.3f));
    for (int i = 0; i <= boards; ++i) {
        const float y = (height - 0.03f) * float(i) / float(boards);
        append_box(mesh, vec3(0.03f, y, 0.0f), vec3(width - 0.03f, y + 0.03f, 0.3f));
    }
    return mesh;
}

scene::Mesh make_books(float width, float height, int boards) {
    scene::Mesh mesh;
    for (int i = 0; i < boards; ++i) {
        const float y = (height - 0.03f) * float(i) / float(boards) + 0.03f;
        float x = 0.05f;
        for (int k = 0; x < width - 0.12f; ++k) {
            const float thick = 0.025f + 0.012f * float((k * 7 + i * 3) % 4),
                        tall = 0.18f + 0.02f * float((k * 5 + i) % 4);
            append_box(mesh, vec3(x, y, 0.03f), vec3(x + thick, y + tall, 0.26f));
            x += thick + ((k + i) % 9 == 8 ? 0.12f : 0.002f);
        }
    }
    return mesh;
}

} // namespace

void make_classroom(SceneBuilder& s) {
    std::vector<SceneBuilder::Lamp> lamps;
    for (int i = 0; i < 2; ++i)
        lamps.push_back(
            {"lamp " + std::to_string(i), vec2(i ? 2.2f : -2.2f, -1.6f), 1.6f, 0.5f, vec3(14.0f, 13.6f, 12.6f)});
    s.room(vec3(-4.5f, 0.0f, -5.0f), vec3(4.5f, 3.0f, 5.0f), vec3(0.52f, 0.44f, 0.34f), white,
           {vec3(0.66f, 0.68f, 0.58f), vec3(0.66f, 0.68f, 0.58f), white, vec3(0.55f, 0.60f, 0.66f)}, lamps);
    for (int i = 0; i < 2; ++i) // the other two hang from the ceiling
        s.ceiling_light("hanging lamp " + std::to_string(i), vec3(i ? 2.2f : -2.2f, 2.7f, 2.2f), 1.6f, 0.5f,
                        vec3(14.0f, 13.6f, 12.6f));
    const std::uint32_t desk = s.mesh("desk", make_table(1.1f, 0.55f, 0.74f, 0.05f)),
                        chair = s.mesh("chair", make_chair());
    for (int row = 0; row < 5; ++row)
        for (int column = 0; column < 5; ++column) {
            const std::string name = std::to_string(row) + " " + std::to_string(column);
            const vec3 place(-3.2f + 1.6f * float(column), 0.0f, -1.8f + 1.45f * float(row));
            s.instance("desk " + name, desk, diffuse(wood), placed(place));
            s.instance("chair " + name, chair, diffuse(row % 2 ? vec3(0.25f, 0.36f, 0.55f) : vec3(0.60f, 0.28f, 0.2f)),
                       placed(place + vec3(0.0f, 0.0f, 0.5f), 0.15f * float((row * 3 + column) % 5 - 2)));
        }
    s.add("teacher's table", make_table(1.7f, 0.8f, 0.76f, 0.06f), diffuse(wood), placed(vec3(1.4f, 0.0f, -3.7f)));
    s.box("board", vec3(-2.0f, 0.95f, -4.99f), vec3(2.0f, 2.2f, -4.95f), diffuse(vec3(0.08f, 0.16f, 0.12f)));
    for (int i = 0; i < 2; ++i)
        s.add("cupboard " + std::to_string(i), make_shelf(1.6f, 1.9f, 5), diffuse(wood),
              placed(vec3(-4.48f, 0.0f, 4.5f - 1.8f * float(i)), 0.5f * pi));
    for (int i = 0; i < 2; ++i)
        s.add("books " + std::to_string(i), make_books(1.6f, 1.9f, 5),
              diffuse(vec3(0.55f, 0.3f + 0.2f * float(i), 0.25f)),
              placed(vec3(-4.48f, 0.0f, 4.5f - 1.8f * float(i)), 0.5f * pi));
    s.camera("view", vec3(4.1f, 2.1f, 4.5f), vec3(-0.8f, 0.6f, -1.2f), 62.0f);
    s.camera("bench_1", vec3(4.1f, 2.1f, 4.5f), vec3(-0.8f, 0.6f, -1.2f), 62.0f);
    s.camera("bench_2", vec3(-3.6f, 1.6f, -4.3f), vec3(1.0f, 0.6f, 1.5f), 64.0f);
    s.exposure(8.8f);
}

void make_office(SceneBuilder& s) {
    s.room(vec3(-3.2f, 0.0f, -2.8f), vec3(3.2f, 2.8f, 2.8f), vec3(0.36f, 0.38f, 0.44f), white,
           {vec3(0.62f, 0.56f, 0.46f), white, white, vec3(0.50f, 0.58f, 0.52f)},
           {{"lamp left", vec2(-1.4f, 0.0f), 1.2f, 0.6f, vec3(15.0f, 14.5f, 13.5f)},
            {"lamp right", vec2(1.4f, 0.0f), 1.2f, 0.6f, vec3(15.0f, 14.5f, 13.5f)}});
    for (int i = 0; i < 2; ++i) {
        const std::string name = i ? "right" : "left";
        const float x = i ? 1.5f : -1.5f;
        s.add(name + " desk", make_table(1.7f, 0.8f, 0.74f, 0.06f), diffuse(wood), placed(vec3(x, 0.0f, -2.2f)));
        s.box(name + " drawers", vec3(x + 0.3f, 0.05f, -2.55f), vec3(x + 0.75f, 0.66f, -1.9f), diffuse(metal));
        s.box(name + " screen", vec3(x - 0.32f, 0.88f, -2.52f), vec3(x + 0.32f, 1.28f, -2.47f), diffuse(vec3(0.06f)));
        s.box(name + " stand", vec3(x - 0.05f, 0.74f, -2.5f), vec3(x + 0.05f, 0.9f, -2.46f), diffuse(metal));
        s.box(name + " keyboard", vec3(x - 0.24f, 0.74f, -2.2f), vec3(x + 0.24f, 0.765f, -2.03f), diffuse(vec3(0.15f)));
        s.add(name + " chair", make_chair(), diffuse(vec3(0.16f, 0.2f, 0.28f)),
              placed(vec3(x, 0.0f, -1.5f), i ? 0.5f : -0.3f));
        s.add(name + " mug", scene::make_cylinder(0.04f, 0.1f, 20), diffuse(vec3(0.7f, 0.2f, 0.15f)),
              placed(vec3(x + 0.5f, 0.79f, -2.1f)));
    }
    for (int i = 0; i < 3; ++i) {
        const std::string name = "shelf " + std::to_string(i);
        const scene::Transform place = placed(vec3(-3.18f, 0.0f, 2.4f - 1.25f * float(i)), 0.5f * pi);
        s.add(name, make_shelf(1.2f, 2.1f, 6), diffuse(wood), place);
        s.add(name + " books", make_books(1.2f, 2.1f, 6),
              diffuse(vec3(0.5f - 0.15f * float(i), 0.32f, 0.25f + 0.15f * float(i))), place);
    }
    s.add("meeting table", scene::make_cylinder(0.6f, 0.04f, 48), diffuse(vec3(0.7f, 0.66f, 0.58f)),
          placed(vec3(1.6f, 0.72f, 1.3f)));
    s.add("column", scene::make_cylinder(0.05f, 0.7f, 20), diffuse(metal), placed(vec3(1.6f, 0.35f, 1.3f)));
    const std::uint32_t chair = s.mesh("meeting chair", make_chair());
    for (int i = 0; i < 4; ++i) {
        const float angle = 0.4f + 0.5f * pi * float(i);
        s.instance("meeting chair " + std::to_string(i), chair, diffuse(vec3(0.62f, 0.4f, 0.2f)),
                   placed(vec3(1.6f + 0.85f * std::sin(angle), 0.0f, 1.3f + 0.85f * std::cos(angle)), angle));
    }
    s.add("plant pot", scene::make_cylinder(0.18f, 0.4f, 24), diffuse(vec3(0.55f, 0.3f, 0.2f)),
          placed(vec3(2.8f, 0.2f, -0.6f)));
    s.add("plant", scene::make_knot(0.6f, 60, 10), diffuse(vec3(0.2f, 0.45f, 0.18f)), placed(vec3(2.75f, 0.8f, -0.6f)));
    s.camera("view", vec3(2.9f, 1.7f, 2.5f), vec3(-1.2f, 0.8f, -1.2f), 66.0f);
    s.camera("bench_1", vec3(2.9f, 1.7f, 2.5f), vec3(-1.2f, 0.8f, -1.2f), 66.0f);
    s.camera("bench_2", vec3(-2.4f, 1.6f, -0.6f), vec3(1.4f, 0.7f, 1.0f), 66.0f);
    s.exposure(8.9f);
}

} // namespace sunfleck::assets
