#include "assets/test_rooms.h"

namespace sunfleck::assets {
namespace {

const vec3 white(0.75f), red(0.63f, 0.07f, 0.05f), green(0.14f, 0.45f, 0.09f), blue(0.10f, 0.17f, 0.60f);
const vec3 wood(0.55f, 0.36f, 0.20f), grey(0.5f), stone(0.62f, 0.58f, 0.52f);

scene::Mover circle(vec3 centre, float period, float phase, float spin_period) {
    scene::Mover mover;
    mover.path = scene::MoverPath::circle;
    mover.centre = centre;
    mover.period = period;
    mover.phase = phase;
    mover.spin_period = spin_period;
    return mover;
}

scene::Transform at(vec3 position, float yaw_degrees = 0.0f) {
    scene::Transform transform;
    transform.position = position;
    transform.rotation = glm::angleAxis(glm::radians(yaw_degrees), vec3(0.0f, 1.0f, 0.0f));
    return transform;
}

} // namespace

// Dimensions and blocks follow the measured box of the Cornell University Program of Computer Graphics, at ten times
// its size; the room is mirrored so that the camera looks along -z.
void make_cornell(SceneBuilder& s) {
    const vec3 lo(0.0f), hi(5.528f, 5.488f, 5.592f);
    s.quad("floor", lo, vec3(0, 0, hi.z), vec3(hi.x, 0, 0), diffuse(white));
    s.ceiling_with_lamps(lo, hi, white, {{"lamp", vec2(2.78f, 2.795f), 1.30f, 1.05f, vec3(17.0f, 12.0f, 6.0f)}});
    s.quad("back wall", lo, vec3(hi.x, 0, 0), vec3(0, hi.y + 0.002f, 0), diffuse(white)); // see SceneBuilder::room
    s.quad("red wall", lo, vec3(0, hi.y, 0), vec3(0, 0, hi.z), diffuse(red));
    s.quad("green wall", vec3(hi.x, 0, 0), vec3(0, 0, hi.z), vec3(0, hi.y, 0), diffuse(green));
    s.add("tall block", scene::make_box(vec3(1.65f, 3.30f, 1.65f)), diffuse(white),
          at(vec3(1.84f, 1.65f, 2.08f), 17.0f));
    s.add("short block", scene::make_box(vec3(1.65f)), diffuse(white), at(vec3(3.68f, 0.825f, 3.91f), -17.0f));
    s.camera("view", vec3(2.78f, 2.73f, 13.3f), vec3(2.78f, 2.73f, 2.8f), 39.3f);
    s.camera("bench_1", vec3(2.78f, 2.73f, 13.3f), vec3(2.78f, 2.73f, 2.8f), 39.3f);
    s.camera("corner", vec3(4.9f, 4.6f, 5.3f), vec3(1.6f, 0.8f, 1.6f), 65.0f);
    s.exposure(9.2f);
}

void make_furnace_of(SceneBuilder& s, float albedo, float emission) {
    scene::Material wall = diffuse(vec3(albedo));
    wall.emission = vec3(emission);
    s.add("furnace", scene::make_room(vec3(2.0f)), wall);
    s.camera("view", vec3(0.3f, -0.2f, 0.4f), vec3(-0.5f, 0.1f, -1.0f), 70.0f);
    s.exposure(11.0f);
}

void make_furnace(SceneBuilder& s) {
    make_furnace_of(s, 0.5f, 1.0f);
}

void make_area_room(SceneBuilder& s) {
    s.room(vec3(-4.0f, 0.0f, -3.0f), vec3(4.0f, 3.2f, 3.0f), wood, white,
           {vec3(0.70f, 0.62f, 0.45f), white, white, white},
           {{"large lamp", vec2(-1.8f, -0.3f), 2.4f, 1.6f, vec3(5.0f, 4.6f, 4.0f)},
            {"second lamp", vec2(2.1f, 0.3f), 1.8f, 1.8f, vec3(3.4f, 3.8f, 4.6f)}});
    s.box("plinth", vec3(-2.9f, 0.0f, -1.8f), vec3(-1.9f, 0.9f, -0.8f), diffuse(white));
    s.add("torus", scene::make_torus(0.45f, 0.16f), diffuse(vec3(0.7f, 0.45f, 0.15f)), [] {
        scene::Transform t = at(vec3(-2.4f, 1.5f, -1.3f));
        t.rotation = glm::angleAxis(1.2f, vec3(1, 0, 0));
        return t;
    }());
    s.box("block", vec3(0.4f, 0.0f, -1.9f), vec3(1.3f, 1.5f, -1.0f), diffuse(grey));
    s.box("low block", vec3(1.9f, 0.0f, -0.6f), vec3(3.1f, 0.5f, 0.6f), diffuse(vec3(0.30f, 0.42f, 0.60f)));
    s.add("column", scene::make_cylinder(0.22f, 2.4f), diffuse(stone), at(vec3(-0.7f, 1.2f, 0.9f)));
    s.add("ball", scene::make_sphere(0.4f, 32, 16), diffuse(vec3(0.65f, 0.2f, 0.2f)), at(vec3(2.5f, 0.9f, 0.0f)));
    s.camera("view", vec3(0.0f, 1.7f, 2.9f), vec3(0.0f, 1.1f, -1.5f), 62.0f);
    s.camera("bench_1", vec3(0.0f, 1.7f, 2.9f), vec3(0.0f, 1.1f, -1.5f), 62.0f);
    s.camera("bench_2", vec3(3.7f, 2.2f, 2.7f), vec3(-1.2f, 0.7f, -0.8f), 60.0f);
    s.exposure(9.2f);
}

void make_table_room(SceneBuilder& s) {
    s.room(vec3(-3.0f, 0.0f, -3.0f), vec3(3.0f, 3.0f, 3.0f), vec3(0.6f, 0.55f, 0.48f), white, {red, blue, white, white},
           {{"lamp", vec2(0.0f), 1.4f, 1.4f, vec3(11.0f, 10.4f, 9.4f)}});
    s.box("table top", vec3(-1.1f, 0.80f, -0.7f), vec3(1.1f, 0.88f, 0.7f), diffuse(wood));
    for (int leg = 0; leg < 4; ++leg) {
        const float x = leg & 1 ? 1.0f : -1.0f, z = leg & 2 ? 0.6f : -0.6f;
        s.box("leg " + std::to_string(leg), vec3(x - 0.05f, 0.0f, z - 0.05f), vec3(x + 0.05f, 0.80f, z + 0.05f),
              diffuse(wood));
    }
    s.box("chest", vec3(-2.8f, 0.0f, -2.8f), vec3(-1.6f, 0.7f, -2.1f), diffuse(vec3(0.5f, 0.42f, 0.3f)));
    s.add("vase", scene::make_cylinder(0.12f, 0.42f, 24), diffuse(vec3(0.7f)), at(vec3(-0.6f, 1.09f, -0.2f)));
    const ecs::Entity knot =
        s.add("knot", scene::make_knot(0.6f), diffuse(vec3(0.72f, 0.68f, 0.6f)), at(vec3(1.75f, 0.42f, 0.0f)));
    s.mover(knot, circle(vec3(0.0f, 0.42f, 0.0f), 10.0f, 0.17f, 7.0f));
    s.camera("view", vec3(-1.6f, 1.75f, 2.8f), vec3(0.35f, 0.7f, -0.4f), 60.0f);
    s.camera("bench_1", vec3(-2.6f, 2.0f, 2.7f), vec3(0.4f, 0.6f, -0.6f), 62.0f);
    s.camera("bench_2", vec3(2.7f, 2.3f, -2.6f), vec3(-0.3f, 0.5f, 0.4f), 65.0f);
    s.exposure(9.2f);
}

void make_four_pillars(SceneBuilder& s) {
    s.room(vec3(-4.0f, 0.0f, -4.0f), vec3(4.0f, 3.5f, 4.0f), vec3(0.55f, 0.52f, 0.47f), white,
           {red, green, white, vec3(0.7f, 0.6f, 0.35f)}, {{"lamp", vec2(0.0f), 1.6f, 1.6f, vec3(17.0f, 16.0f, 14.0f)}});
    for (int i = 0; i < 4; ++i) {
        const float x = i & 1 ? 1.7f : -1.7f, z = i & 2 ? 1.7f : -1.7f;
        s.box("pillar " + std::to_string(i), vec3(x - 0.35f, 0.0f, z - 0.35f), vec3(x + 0.35f, 3.5f, z + 0.35f),
              diffuse(stone));
    }
    const ecs::Entity torus = s.add("torus", scene::make_torus(0.42f, 0.15f), diffuse(vec3(0.70f, 0.50f, 0.16f)), [] {
        scene::Transform t = at(vec3(0.9f, 1.3f, 0.0f));
        t.rotation = glm::angleAxis(1.1f, vec3(1, 0, 0));
        return t;
    }());
    s.mover(torus, circle(vec3(0.0f, 1.3f, 0.0f), 6.0f, 0.0f, 4.0f));
    const ecs::Entity knot =
        s.add("knot", scene::make_knot(0.7f), diffuse(vec3(0.72f, 0.70f, 0.66f)), at(vec3(2.75f, 0.6f, 0.0f)));
    s.mover(knot, circle(vec3(0.0f, 0.6f, 0.0f), 12.0f, 0.55f, 9.0f));
    s.camera("view", vec3(-0.6f, 1.8f, 3.85f), vec3(0.15f, 1.35f, 0.0f), 66.0f);
    s.camera("bench_1", vec3(3.7f, 2.4f, 3.7f), vec3(-1.0f, 0.9f, -1.2f), 62.0f);
    s.camera("bench_2", vec3(-3.8f, 1.5f, 0.4f), vec3(2.0f, 1.3f, 0.2f), 66.0f);
    s.camera("pillar_close", vec3(-2.75f, 1.6f, 2.9f), vec3(0.6f, 1.3f, -2.0f), 60.0f); // after fig. 4-12
    s.exposure(9.2f);
}

void make_gap_room(SceneBuilder& s) {
    s.room(vec3(-4.0f, 0.0f, -2.5f), vec3(4.0f, 3.0f, 2.5f), vec3(0.65f), white,
           {vec3(0.7f, 0.5f, 0.2f), white, white, white},
           {{"lamp", vec2(-2.2f, -0.4f), 1.5f, 1.5f, vec3(40.0f, 37.0f, 32.0f)}});
    // The dividing wall leaves a gap 25 cm wide.
    s.box("divider left", vec3(-0.1f, 0.0f, -2.5f), vec3(0.1f, 3.0f, -0.9f), diffuse(white));
    s.box("divider right", vec3(-0.1f, 0.0f, -0.65f), vec3(0.1f, 3.0f, 2.5f), diffuse(white));
    s.box("block", vec3(1.7f, 0.0f, -0.6f), vec3(2.3f, 1.3f, 0.1f), diffuse(grey));
    const ecs::Entity knot = s.add("knot", scene::make_knot(0.6f), diffuse(white), at(vec3(2.7f, 0.5f, 1.2f)));
    s.mover(knot, circle(vec3(2.2f, 0.5f, 1.2f), 8.0f, 0.0f, 0.0f));
    s.camera("view", vec3(0.6f, 1.6f, 2.2f), vec3(3.0f, 1.0f, -0.9f), 68.0f);
    s.camera("bench_1", vec3(0.6f, 1.6f, 2.2f), vec3(3.0f, 1.0f, -0.9f), 68.0f);
    s.exposure(6.0f);
}

void make_near_occluder(SceneBuilder& s) {
    s.room(vec3(-3.0f, 0.0f, -3.0f), vec3(3.0f, 3.0f, 3.0f), vec3(0.75f), white, {white, white, white, blue});
    // A shielded spot light makes one bright patch on the floor, which lights the far wall.
    const ecs::Entity spot = s.registry().create();
    s.registry().emplace<scene::Name>(spot, {"spot"});
    scene::Transform transform;
    transform.position = vec3(0.0f, 2.9f, 0.6f);
    transform.rotation = facing(glm::normalize(vec3(0.0f, 1.0f, 0.25f))); // shines along -Z of the entity
    s.registry().emplace<scene::Transform>(spot, transform);
    s.registry().emplace<scene::SpotLight>(spot, {vec3(160.0f, 150.0f, 130.0f), 0.20f, 0.30f});
    const ecs::Entity knot = s.add("knot", scene::make_knot(0.7f), diffuse(white), at(vec3(0.35f, 0.42f, -0.1f)));
    scene::Mover mover;
    mover.path = scene::MoverPath::line;
    mover.travel = vec3(0.8f, 0.0f, 0.0f);
    s.mover(knot, mover);
    s.camera("view", vec3(-1.6f, 1.7f, 2.8f), vec3(0.4f, 1.0f, -1.6f), 62.0f);
    s.camera("bench_1", vec3(-1.6f, 1.7f, 2.8f), vec3(0.4f, 1.0f, -1.6f), 62.0f);
    s.exposure(8.3f);
}

void make_two_rooms(SceneBuilder& s) {
    const vec3 lo(-5.0f, 0.0f, -2.5f), hi(5.0f, 2.8f, 2.5f);
    s.room(lo, hi, vec3(0.6f, 0.55f, 0.5f), white, {vec3(0.7f, 0.35f, 0.2f), vec3(0.35f, 0.45f, 0.65f), white, white},
           {{"lamp", vec2(-2.6f, 0.0f), 1.4f, 1.4f, vec3(22.0f, 20.0f, 17.0f)}});
    // The dividing wall, from 20 cm thick down to a single sheet, with a doorway 1 m wide and a sliding door.
    s.box("wall 20 cm", vec3(-0.1f, 0.0f, -2.5f), vec3(0.1f, 2.8f, -1.5f), diffuse(white));
    s.box("wall 5 cm", vec3(-0.025f, 0.0f, -1.5f), vec3(0.025f, 2.8f, -0.5f), diffuse(white));
    s.box("lintel", vec3(-0.05f, 2.1f, -0.5f), vec3(0.05f, 2.8f, 0.5f), diffuse(white));
    s.box("wall 1 cm", vec3(-0.005f, 0.0f, 0.5f), vec3(0.005f, 2.8f, 1.5f), diffuse(white));
    s.quad("wall 0 cm", vec3(0.0f, 0.0f, 1.5f), vec3(0, 2.8f, 0), vec3(0, 0, 1.0f), diffuse(white));
    const ecs::Entity door = s.box("door", vec3(0.05f, 0.0f, -0.52f), vec3(0.11f, 2.12f, 0.52f), diffuse(wood));
    scene::Mover slide;
    slide.path = scene::MoverPath::line;
    slide.travel = vec3(0.0f, 0.0f, 1.04f);
    slide.phase = 0.25f; // open at step 0
    s.mover(door, slide);
    s.box("block", vec3(2.0f, 0.0f, -1.4f), vec3(2.8f, 1.0f, -0.6f), diffuse(white));
    s.camera("view", vec3(4.6f, 1.7f, 2.1f), vec3(0.4f, 1.1f, -0.4f), 66.0f);
    s.camera("bench_1", vec3(4.6f, 1.7f, 2.1f), vec3(0.4f, 1.1f, -0.4f), 66.0f);
    s.camera("lit_room", vec3(-4.6f, 1.7f, 2.1f), vec3(-0.6f, 1.1f, -0.4f), 66.0f);
    s.exposure(7.5f);
}

const std::vector<BuiltInScene>& built_in_scenes() {
    static const std::vector<BuiltInScene> list = {{"cornell", make_cornell},
                                                   {"furnace", make_furnace},
                                                   {"area_room", make_area_room},
                                                   {"table_room", make_table_room},
                                                   {"four_pillars", make_four_pillars},
                                                   {"gap_room", make_gap_room},
                                                   {"near_occluder", make_near_occluder},
                                                   {"two_rooms", make_two_rooms},
                                                   {"ring", make_ring},
                                                   {"glass", make_glass},
                                                   {"arena", make_arena},
                                                   {"hall", make_hall},
                                                   {"gallery", make_gallery},
                                                   {"chamber", make_chamber},
                                                   {"cave", make_cave},
                                                   {"classroom", make_classroom},
                                                   {"office", make_office},
                                                   {"atrium", make_atrium},
                                                   {"lantern_house", make_lantern_house},
                                                   {"lantern_game", make_lantern_game}};
    return list;
}

} // namespace sunfleck::assets
