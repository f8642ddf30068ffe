// The demo's level: a house of six rooms. A sun room with windows, a white hall, a red, a blue and a tall green room,
// and an attic reached by a lift. Metres; +X is east, -Z is north; the origin is the centre of the hall.
#include "assets/house_parts.h"
#include "assets/test_rooms.h"

namespace sunfleck::assets {
namespace {

const vec3 white(0.78f, 0.76f, 0.72f), red(0.66f, 0.08f, 0.06f), green(0.13f, 0.46f, 0.12f), blue(0.12f, 0.25f, 0.70f);
const vec3 oak(0.52f, 0.34f, 0.19f), dark_oak(0.30f, 0.18f, 0.10f), stone(0.62f, 0.59f, 0.54f),
    cream(0.80f, 0.72f, 0.58f);
const vec3 brass(0.72f, 0.52f, 0.20f), cloth(0.24f, 0.34f, 0.42f), leaf(0.16f, 0.36f, 0.10f), clay(0.60f, 0.28f, 0.16f);
const vec3 daylight(2.5f, 3.1f, 4.1f); // radiance of the sky in the windows, W/(sr m2)

constexpr float door_top = 2.15f, upper_floor = 3.44f;

const Room sun_room{vec3(-3.0f, 0.0f, 3.24f), vec3(3.0f, 3.0f, 8.24f)};
const Room hall{vec3(-3.0f, 0.0f, -3.0f), vec3(3.0f, 3.2f, 3.0f)};
const Room red_room{vec3(-9.24f, 0.0f, -3.0f), vec3(-3.24f, 3.0f, 3.0f)};
const Room blue_room{vec3(3.24f, 0.0f, -3.0f), vec3(9.24f, 3.6f, 3.0f)};
const Room green_room{vec3(-3.0f, 0.0f, -9.24f), vec3(3.0f, 6.4f, -3.24f)};
const Room attic{vec3(-3.0f, upper_floor, -3.0f), vec3(3.0f, 6.2f, 3.0f)};

const Opening to_sun_room{-0.55f, 0.55f, 0.0f, door_top}, to_red_room{-0.6f, 0.6f, 0.0f, door_top};
const Opening to_blue_room{-0.55f, 0.55f, 0.0f, door_top}, to_green_room{-0.9f, 0.9f, 0.0f, 2.4f};
const Opening to_attic{1.5f, 2.7f, upper_floor, upper_floor + 2.1f};
const std::vector<Opening> sun_windows = {
    {-2.5f, -1.1f, 0.7f, 2.5f}, {-0.7f, 0.7f, 0.7f, 2.5f}, {1.1f, 2.5f, 0.7f, 2.5f}};
const std::vector<Opening> attic_windows = {{-2.1f, -0.7f, 4.35f, 5.6f}, {0.7f, 2.1f, 4.35f, 5.6f}};

void build_shells(House& house) {
    house.shell("sun room", sun_room, {white, white, white, cream},
                {{Wall::north, {to_sun_room}}, {Wall::south, sun_windows}});
    house.floor("sun room", sun_room, {stone, PatternKind::checker, vec3(0.30f, 0.28f, 0.27f), 0.5f});
    house.ceiling("sun room", sun_room, white, {});
    house.shell("hall", hall, {white, white, white, white},
                {{Wall::south, {to_sun_room}},
                 {Wall::west, {to_red_room}},
                 {Wall::east, {to_blue_room}},
                 {Wall::north, {to_green_room}}});
    house.floor("hall", hall, {oak, PatternKind::planks, vec3(0.34f, 0.21f, 0.11f), 0.14f});
    house.ceiling("hall", hall, white, {{"hall lamp", vec2(0.0f, 0.0f), 1.3f, 1.3f, vec3(9.5f, 8.6f, 7.2f)}});
    house.shell("red room", red_room, {red, white, red, red}, {{Wall::east, {to_red_room}}});
    house.floor("red room", red_room, {oak, PatternKind::planks, vec3(0.34f, 0.21f, 0.11f), 0.14f});
    house.ceiling("red room", red_room, white, {{"red lamp", vec2(-6.9f, -0.4f), 1.2f, 1.2f, vec3(10.0f, 9.4f, 8.4f)}});
    house.shell("blue room", blue_room, {white, blue, blue, blue}, {{Wall::west, {to_blue_room}}});
    house.floor("blue room", blue_room, {stone, PatternKind::none, stone, 1.0f});
    house.ceiling("blue room", blue_room, white, {});
    house.shell("green room", green_room, {green, green, green, white}, {{Wall::south, {to_green_room, to_attic}}});
    house.floor("green room", green_room, {stone, PatternKind::checker, vec3(0.42f, 0.46f, 0.38f), 0.75f});
    house.ceiling("green room", green_room, white,
                  {{"green lamp", vec2(-0.6f, -6.4f), 1.6f, 1.6f, vec3(17.0f, 16.2f, 14.4f)}});
    house.shell("attic", attic, {cream, cream, cream, cream},
                {{Wall::north, {to_attic}}, {Wall::south, attic_windows}});
    house.floor("attic", attic, {dark_oak, PatternKind::planks, vec3(0.20f, 0.11f, 0.06f), 0.18f});
    house.ceiling("attic", attic, cream, {});
    for (const Opening& window : sun_windows)
        house.window("sun room", Wall::south, sun_room, window, white, daylight);
    for (const Opening& window : attic_windows)
        house.window("attic", Wall::south, attic, window, dark_oak, daylight);
    house.frame("sun room", Wall::south, hall, to_sun_room, dark_oak);
    house.frame("red room", Wall::west, hall, to_red_room, dark_oak);
    house.frame("blue room", Wall::east, hall, to_blue_room, dark_oak);
    house.frame("green room", Wall::north, hall, to_green_room, dark_oak);
    house.frame("attic", Wall::north, attic, to_attic, dark_oak);
}

void furnish_sun_room(House& house) {
    house.boxes("sofa",
                {{vec3(-2.9f, 0.0f, 4.4f), vec3(-2.0f, 0.42f, 6.6f)},
                 {vec3(-2.95f, 0.42f, 4.4f), vec3(-2.65f, 0.95f, 6.6f)},
                 {vec3(-2.9f, 0.42f, 4.4f), vec3(-2.0f, 0.62f, 4.65f)},
                 {vec3(-2.9f, 0.42f, 6.35f), vec3(-2.0f, 0.62f, 6.6f)}},
                cloth);
    house.table("tea table", vec3(-1.1f, 0.0f, 5.5f), 0.45f, 0.45f, oak);
    house.add("tea bowl", scene::make_torus(0.10f, 0.045f, 32, 14), vec3(0.70f, 0.74f, 0.78f),
              vec3(-1.1f, 0.53f, 5.4f));
    house.add("plant pot", scene::make_cylinder(0.24f, 0.42f, 28), clay, vec3(2.45f, 0.21f, 4.2f));
    house.add("plant", scene::make_sphere(0.46f, 24, 14), leaf, vec3(2.45f, 0.86f, 4.2f));
    house.boxes("shelf",
                {{vec3(2.55f, 0.0f, 5.6f), vec3(2.95f, 0.05f, 7.2f)},
                 {vec3(2.55f, 0.75f, 5.6f), vec3(2.95f, 0.80f, 7.2f)},
                 {vec3(2.55f, 0.05f, 5.6f), vec3(2.95f, 0.75f, 5.65f)},
                 {vec3(2.55f, 0.05f, 7.15f), vec3(2.95f, 0.75f, 7.2f)}},
                dark_oak);
    house.add("globe", scene::make_sphere(0.19f, 32, 16), vec3(0.20f, 0.36f, 0.52f), vec3(2.75f, 1.0f, 6.0f));
}

void furnish_hall(House& house) {
    house.add("pedestal", scene::make_cylinder(0.28f, 0.9f, 28), stone, vec3(0.0f, 0.45f, 0.0f));
    house.pattern("pedestal", {PatternKind::marble, vec3(0.40f, 0.38f, 0.36f), 0.22f});
    house.boxes("bench",
                {{vec3(1.2f, 0.38f, -2.75f), vec3(2.8f, 0.45f, -2.35f)},
                 {vec3(1.3f, 0.0f, -2.7f), vec3(1.4f, 0.38f, -2.4f)},
                 {vec3(2.6f, 0.0f, -2.7f), vec3(2.7f, 0.38f, -2.4f)}},
                dark_oak);
    house.boxes("rug", {{vec3(-1.5f, 0.0f, 0.9f), vec3(1.5f, 0.012f, 2.6f)}}, vec3(0.46f, 0.12f, 0.10f));
    house.pattern("rug", {PatternKind::checker, vec3(0.62f, 0.50f, 0.34f), 0.3f});
    for (int i = 0; i < 2; ++i)
        house.add("column " + std::to_string(i), scene::make_cylinder(0.16f, 3.2f, 24), cream,
                  vec3(i == 0 ? -2.3f : 2.3f, 1.6f, 2.3f));
    house.light_switch("hall switch", vec3(-0.95f, 1.25f, 2.985f), vec3(0, 0, -1), "hall lamp");
}

void furnish_red_room(House& house) {
    house.boxes("bookcase",
                {{vec3(-9.2f, 0.0f, -2.9f), vec3(-8.85f, 2.1f, -2.85f)},
                 {vec3(-9.2f, 0.0f, -0.95f), vec3(-8.85f, 2.1f, -0.9f)},
                 {vec3(-9.2f, 0.05f, -2.85f), vec3(-8.85f, 0.10f, -0.95f)},
                 {vec3(-9.2f, 0.70f, -2.85f), vec3(-8.85f, 0.75f, -0.95f)},
                 {vec3(-9.2f, 1.35f, -2.85f), vec3(-8.85f, 1.40f, -0.95f)},
                 {vec3(-9.2f, 2.05f, -2.85f), vec3(-8.85f, 2.10f, -0.95f)}},
                oak);
    house.boxes("books",
                {{vec3(-9.15f, 0.75f, -2.8f), vec3(-8.92f, 1.08f, -2.1f)},
                 {vec3(-9.15f, 1.40f, -2.2f), vec3(-8.92f, 1.70f, -1.2f)},
                 {vec3(-9.15f, 0.10f, -1.9f), vec3(-8.92f, 0.42f, -1.05f)}},
                vec3(0.42f, 0.40f, 0.30f));
    house.pattern("books", {PatternKind::planks, vec3(0.12f, 0.16f, 0.20f), 0.05f});
    house.boxes("plinth", {{vec3(-8.3f, 0.0f, 1.7f), vec3(-7.5f, 0.8f, 2.5f)}}, white);
    house.add("sculpture", scene::make_knot(0.55f, 110, 16), vec3(0.74f, 0.70f, 0.62f), vec3(-7.9f, 1.22f, 2.1f));
    house.light_switch("red switch", vec3(-3.255f, 1.25f, 0.95f), vec3(-1, 0, 0), "red lamp");
}

void furnish_blue_room(House& house) {
    for (int i = 0; i < 3; ++i) {
        const float inset = 0.32f * float(i);
        house.boxes(
            "dais " + std::to_string(i),
            {{vec3(6.0f + inset, 0.18f * float(i), -1.9f + inset), vec3(9.2f, 0.18f * float(i + 1), 1.9f - inset)}},
            stone);
    }
    house.add("vase", scene::make_cylinder(0.13f, 0.5f, 24), vec3(0.75f), vec3(8.85f, 0.79f, -0.9f));
    house.boxes("low wall", {{vec3(3.6f, 0.0f, -2.9f), vec3(4.6f, 0.9f, -2.6f)}}, clay);
    house.wall_lamp("blue lamp", vec3(6.2f, 1.9f, 2.98f), vec3(0, 0, -1), 0.5f, 0.22f, vec3(15.0f, 11.0f, 6.6f));
    house.light_switch("blue switch", vec3(3.255f, 1.25f, 0.85f), vec3(1, 0, 0), "blue lamp");
    house.pattern("low wall", {PatternKind::bricks, vec3(0.70f, 0.66f, 0.60f), 0.22f});
}

void furnish_green_room(House& house) {
    // The walkway from the lift to the attic, and its railing.
    house.boxes("walkway", {{vec3(1.4f, upper_floor - 0.14f, -7.6f), vec3(3.0f, upper_floor, -3.24f)}}, dark_oak);
    std::vector<Box> rail = {{vec3(1.40f, upper_floor + 0.86f, -7.55f), vec3(1.46f, upper_floor + 0.92f, -3.3f)},
                             {vec3(1.40f, upper_floor + 0.42f, -7.55f), vec3(1.43f, upper_floor + 0.46f, -3.3f)}};
    for (int i = 0; i < 6; ++i)
        rail.push_back({vec3(1.40f, upper_floor, -7.55f + 0.84f * float(i)),
                        vec3(1.46f, upper_floor + 0.86f, -7.49f + 0.84f * float(i))});
    house.boxes("railing", rail, oak);
    house.boxes("brick pillar", {{vec3(-2.2f, 0.0f, -8.5f), vec3(-1.5f, 6.4f, -7.8f)}}, clay);
    house.pattern("brick pillar", {PatternKind::bricks, vec3(0.72f, 0.68f, 0.62f), 0.24f});
    house.boxes("steps",
                {{vec3(-2.95f, 0.0f, -5.6f), vec3(-2.0f, 0.2f, -4.0f)},
                 {vec3(-2.95f, 0.2f, -5.3f), vec3(-2.3f, 0.4f, -4.3f)},
                 {vec3(-2.95f, 0.4f, -5.0f), vec3(-2.6f, 0.6f, -4.6f)}},
                stone);
}

void furnish_attic(House& house) {
    const float y = upper_floor;
    house.boxes("desk",
                {{vec3(-2.9f, y + 0.70f, -1.2f), vec3(-2.1f, y + 0.76f, 0.6f)},
                 {vec3(-2.85f, y, -1.15f), vec3(-2.78f, y + 0.70f, -1.08f)},
                 {vec3(-2.22f, y, -1.15f), vec3(-2.15f, y + 0.70f, -1.08f)},
                 {vec3(-2.85f, y, 0.48f), vec3(-2.78f, y + 0.70f, 0.55f)},
                 {vec3(-2.22f, y, 0.48f), vec3(-2.15f, y + 0.70f, 0.55f)}},
                oak);
    house.boxes("chest", {{vec3(1.7f, y, 0.9f), vec3(2.8f, y + 0.55f, 1.6f)}}, clay);
    house.globe_lamp("desk lamp", vec3(-2.55f, y + 0.90f, 0.35f), 0.09f, vec3(34.0f, 23.0f, 12.0f), brass);
    house.add("armillary", scene::make_torus(0.22f, 0.03f, 40, 12), brass, vec3(-2.5f, y + 1.04f, -0.4f));
    house.add("attic ball", scene::make_sphere(0.12f, 24, 12), vec3(0.7f), vec3(-2.5f, y + 1.04f, -0.4f));
}

void add_movers(House& house) {
    house.sliding_door("sliding door", vec3(0.0f, 0.5f * door_top, 3.12f), vec3(1.06f, door_top, 0.045f),
                       vec3(1.08f, 0.0f, 0.0f), oak);
    house.swinging_door("swinging door", vec3(3.12f, 0.5f * door_top - 0.02f, 0.0f),
                        vec3(0.045f, door_top - 0.06f, 0.98f), vec3(3.12f, 0.0f, -0.49f), 1.75f,
                        vec3(0.70f, 0.66f, 0.58f));
    // A column that rises out of the floor, so that nobody can get under it.
    house.lift("lift", {vec3(1.4f, 0.0f, -9.15f), vec3(2.95f, 3.4f, -7.62f)}, 0.12f, upper_floor, 14.0f, stone);
    house.turning_panel("turning panel", vec3(7.9f, 1.56f, 0.0f), vec3(1.5f, 2.0f, 0.07f), 18.0f, cream);
    house.swinging_lamp("swinging lamp", vec3(5.0f, 3.6f, 0.3f), 1.25f, vec3(64.0f, 50.0f, 31.0f), brass);
    house.mobile("mobile", scene::make_torus(0.28f, 0.07f, 36, 14), brass,
                 {vec3(-1.6f, 2.6f, -5.0f), vec3(0.4f, 3.1f, -4.6f), vec3(0.6f, 3.7f, -7.2f), vec3(-1.0f, 3.3f, -7.4f)},
                 21.0f);
    house.glowing_ball("glowing ball", vec3(-4.6f, 0.22f, -1.4f), 0.22f, 2.2f, vec3(13.0f, 4.6f, 1.0f));
    house.ball("white ball", vec3(-5.6f, 0.3f, 1.2f), 0.3f, 3.0f, white);
    house.ball("blue ball", vec3(-1.9f, 0.18f, -1.6f), 0.18f, 1.0f, vec3(0.12f, 0.22f, 0.66f));
    const vec3 crates[] = {vec3(4.3f, 0.225f, 2.2f), vec3(4.95f, 0.225f, 2.35f), vec3(4.6f, 0.675f, 2.27f)};
    for (int i = 0; i < 3; ++i)
        house.crate("crate " + std::to_string(i), crates[i], 0.45f, 5.0f, oak);
    house.lantern("lantern", vec3(0.0f, 0.9f, 0.0f), vec3(2.9f, 1.9f, 0.9f), brass);
}

} // namespace

void make_lantern_house(SceneBuilder& s) {
    House house(s);
    build_shells(house);
    furnish_sun_room(house);
    furnish_hall(house);
    furnish_red_room(house);
    furnish_blue_room(house);
    furnish_green_room(house);
    furnish_attic(house);
    add_movers(house);
    house.sky(daylight);
    house.player_start(vec3(0.4f, 0.02f, 7.2f), vec3(0.0f, 0.02f, 0.0f));
    s.camera("view", vec3(0.3f, 1.6f, 2.8f), vec3(-0.15f, 1.35f, -3.0f), 70.0f);
    s.camera("sun_room", vec3(2.5f, 1.6f, 3.7f), vec3(-1.2f, 1.1f, 7.5f), 70.0f);
    s.camera("hall", vec3(2.2f, 1.7f, 1.6f), vec3(-2.4f, 1.1f, -1.4f), 70.0f);
    s.camera("red_room", vec3(-3.7f, 1.7f, 2.5f), vec3(-7.6f, 0.9f, -1.2f), 70.0f);
    s.camera("blue_room", vec3(3.7f, 1.7f, 2.6f), vec3(7.8f, 1.0f, -1.2f), 70.0f);
    s.camera("green_room", vec3(-2.5f, 1.7f, -3.7f), vec3(1.2f, 2.2f, -8.5f), 72.0f);
    s.camera("attic", vec3(2.4f, upper_floor + 1.6f, -2.5f), vec3(-1.4f, upper_floor + 0.9f, 1.6f), 70.0f);
    s.camera("bench_1", vec3(2.2f, 1.7f, 1.6f), vec3(-2.4f, 1.1f, -1.4f), 66.0f);
    s.camera("bench_2", vec3(-3.7f, 1.7f, 2.5f), vec3(-7.6f, 0.9f, -1.2f), 66.0f);
    s.exposure(8.6f);
}

} // namespace sunfleck::assets
