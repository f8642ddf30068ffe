// The game's level: seven rooms whose doors open to reflected light. Metres; +X is east, -Z is north. One walks from
// the porch north through the corner and the red wall, east to the shutters, south to the block, east to the two
// colours, north to the tower, and by its lift up to the lamp room.
#include "assets/game_parts.h"
#include "assets/test_rooms.h"

namespace sunfleck::assets {
namespace {

const vec3 plaster(0.52f, 0.50f, 0.47f), pale(0.70f, 0.68f, 0.65f), slate(0.30f, 0.31f, 0.33f), soot(0.04f),
    stone(0.46f, 0.45f, 0.43f), oak(0.52f, 0.34f, 0.19f), dark_oak(0.28f, 0.18f, 0.11f), white(0.80f),
    brass(0.72f, 0.52f, 0.20f);
const vec3 red(0.68f, 0.06f, 0.05f), green(0.08f, 0.60f, 0.10f), blue(0.06f, 0.10f, 0.70f);
const vec3 night_light(8.0f, 7.4f, 6.4f); // radiance of the lamps that are always on, W/(sr m2)
const vec3 daylight(2.5f, 3.1f, 4.1f);    // of the sky in the windows

// Its light is high enough to clear what it stands on.
constexpr LanternForm tall_lantern{0.4f, 0.1f, 0.085f, 0.08f, 0.04f, 0.2f, 0.3f, false};

constexpr float door_top = 2.15f, upper_floor = 3.44f;

const Room porch{vec3(-3.0f, 0.0f, 6.24f), vec3(3.0f, 3.0f, 10.24f)};
const Room corner{vec3(-3.0f, 0.0f, 0.0f), vec3(3.0f, 2.8f, 6.0f)};
const Room red_wall{vec3(-3.0f, 0.0f, -6.24f), vec3(3.0f, 3.0f, -0.24f)};
const Room shutters{vec3(3.24f, 0.0f, -6.24f), vec3(9.24f, 3.2f, -0.24f)};
const Room blocks{vec3(3.24f, 0.0f, 0.0f), vec3(9.24f, 3.0f, 6.0f)};
const Room colours{vec3(9.48f, 0.0f, 0.0f), vec3(15.48f, 3.0f, 6.0f)};
const Room tower{vec3(9.48f, 0.0f, -6.24f), vec3(15.48f, 6.4f, -0.24f)};
const Room lamp_room{vec3(9.48f, upper_floor, -12.48f), vec3(15.48f, 6.4f, -6.48f)};

const Opening porch_door{-0.55f, 0.55f, 0.0f, door_top}, corner_door{-0.55f, 0.55f, 0.0f, door_top};
const Opening red_door{-3.79f, -2.69f, 0.0f, door_top}, shutter_door{5.69f, 6.79f, 0.0f, door_top};
const Opening block_door{2.45f, 3.55f, 0.0f, door_top}, colour_door{11.93f, 13.03f, 0.0f, door_top};
const Opening tower_door{13.0f, 14.1f, upper_floor, upper_floor + door_top};
const std::vector<Opening> sun_windows = {
    {3.9f, 4.9f, 1.0f, 2.4f}, {5.74f, 6.74f, 1.0f, 2.4f}, {7.6f, 8.6f, 1.0f, 2.4f}};
const std::vector<Opening> lamp_windows = {{10.2f, 11.8f, 4.3f, 5.8f}, {13.1f, 14.7f, 4.3f, 5.8f}};

void build_shells(House& house) {
    const Covering flags{stone, PatternKind::checker, vec3(0.34f, 0.335f, 0.33f), 0.75f};
    house.shell("porch", porch, {plaster, plaster, plaster, plaster}, {{Wall::north, {porch_door}}});
    house.shell("corner", corner, {pale, pale, pale, plaster},
                {{Wall::south, {porch_door}}, {Wall::north, {corner_door}}});
    house.shell("red wall", red_wall, {slate, plaster, plaster, plaster},
                {{Wall::south, {corner_door}}, {Wall::east, {red_door}}});
    house.shell("shutters", shutters, {plaster, plaster, plaster, plaster},
                {{Wall::west, {red_door}}, {Wall::south, {shutter_door}}, {Wall::north, sun_windows}});
    house.shell("blocks", blocks, {plaster, plaster, plaster, plaster},
                {{Wall::north, {shutter_door}}, {Wall::east, {block_door}}});
    house.shell("colours", colours, {plaster, slate, plaster, slate},
                {{Wall::west, {block_door}}, {Wall::north, {colour_door}}});
    house.shell("tower", tower, {pale, plaster, pale, plaster},
                {{Wall::south, {colour_door}}, {Wall::north, {tower_door}}});
    house.shell("lamp room", lamp_room, {pale, pale, pale, pale},
                {{Wall::south, {tower_door}}, {Wall::north, lamp_windows}});
    const std::pair<const char*, const Room*> paved[] = {
        {"porch", &porch},   {"corner", &corner},   {"red wall", &red_wall}, {"shutters", &shutters},
        {"blocks", &blocks}, {"colours", &colours}, {"tower", &tower}};
    for (const auto& [name, room] : paved)
        house.floor(name, *room, flags);
    house.floor("lamp room", lamp_room, {oak, PatternKind::planks, vec3(0.34f, 0.21f, 0.11f), 0.14f});
}

void build_ceilings(House& house) {
    const auto lamp = [](const char* name, float x, float z) {
        return std::vector<SceneBuilder::Lamp>{{name, vec2(x, z), 0.7f, 0.7f, night_light}};
    };
    house.ceiling("porch", porch, pale, lamp("porch lamp", 1.2f, 8.6f));
    house.ceiling("corner", corner, white, lamp("corner lamp", -0.6f, 4.6f));
    house.ceiling("red wall", red_wall, pale, lamp("red wall lamp", 1.2f, -1.7f));
    house.ceiling("shutters", shutters, pale, lamp("shutters lamp", 4.6f, -1.5f));
    house.ceiling("blocks", blocks, pale, lamp("blocks lamp", 5.0f, 1.3f));
    house.ceiling("colours", colours, slate, lamp("colours lamp", 11.0f, 1.5f));
    house.ceiling("tower", tower, white, {});
    house.ceiling("lamp room", lamp_room, white,
                  {{"great lamp", vec2(12.48f, -10.3f), 1.1f, 1.1f, vec3(8.0f, 6.6f, 4.6f)}});
    house.wall_lamp("tower lamp", vec3(15.46f, 1.9f, -2.4f), vec3(-1, 0, 0), 0.6f, 0.4f, 1.5f * night_light);
}

void build_openings(House& house) {
    for (const Opening& window : sun_windows)
        house.window("shutters", Wall::north, shutters, window, dark_oak, vec3(0.0f));
    for (const Opening& window : lamp_windows)
        house.window("lamp room", Wall::north, lamp_room, window, dark_oak, daylight);
    house.frame("porch", Wall::north, porch, porch_door, dark_oak);
    house.frame("corner", Wall::north, corner, corner_door, dark_oak);
    house.frame("red wall", Wall::east, red_wall, red_door, dark_oak);
    house.frame("shutters", Wall::south, shutters, shutter_door, dark_oak);
    house.frame("blocks", Wall::east, blocks, block_door, dark_oak);
    house.frame("colours", Wall::north, colours, colour_door, dark_oak);
    house.frame("tower", Wall::north, tower, tower_door, dark_oak);
}

void build_doors(House& house, GameParts& parts) {
    const float y = 0.5f * door_top;
    const vec3 along_x(1.06f, door_top, 0.045f), along_z(0.045f, door_top, 1.06f);
    house.sliding_door("porch door", vec3(0.0f, y, 6.12f), along_x, vec3(1.08f, 0.0f, 0.0f), oak);
    parts.sensor_door("corner door", vec3(0.0f, y, -0.12f), along_x, vec3(1.08f, 0.0f, 0.0f));
    parts.sensor_door("red door", vec3(3.12f, y, -3.24f), along_z, vec3(0.0f, 0.0f, 1.08f));
    parts.sensor_door("sun door", vec3(6.24f, y, -0.12f), along_x, vec3(1.08f, 0.0f, 0.0f));
    parts.sensor_door("green door", vec3(9.36f, y, 3.0f), along_z, vec3(0.0f, 0.0f, -1.08f));
    parts.sensor_door("violet door", vec3(12.48f, y, -0.12f), along_x, vec3(1.08f, 0.0f, 0.0f));
    parts.sensor_door("tower door", vec3(13.55f, upper_floor + y, -6.36f), along_x, vec3(-1.08f, 0.0f, 0.0f));
}

scene::LightSensor opens(const std::string& which, vec3 threshold, float purity) {
    return {threshold, purity, which + " door", which + " gauge", true};
}

// Behind a wall stands a column whose eye looks up: only light that the ceiling sends down reaches it.
void furnish_porch_and_corner(House& house, GameParts& parts) {
    house.add("pedestal", scene::make_cylinder(0.28f, 0.9f, 28), stone, vec3(0.0f, 0.45f, 8.0f));
    house.pattern("pedestal", {PatternKind::marble, vec3(0.34f, 0.33f, 0.32f), 0.22f});
    house.lantern("lantern", vec3(0.0f, 0.9f, 8.0f), vec3(3.2f, 3.1f, 2.95f), brass, tall_lantern);
    house.boxes("porch bench",
                {{vec3(-2.8f, 0.38f, 7.4f), vec3(-2.4f, 0.45f, 9.2f)},
                 {vec3(-2.75f, 0.0f, 7.5f), vec3(-2.45f, 0.38f, 7.6f)},
                 {vec3(-2.75f, 0.0f, 9.0f), vec3(-2.45f, 0.38f, 9.1f)}},
                dark_oak);
    house.boxes("corner screen", {{vec3(-3.0f, 0.0f, 2.6f), vec3(1.2f, 2.8f, 2.75f)}}, plaster);
    house.add("corner column", scene::make_cylinder(0.17f, 2.0f, 24), stone, vec3(-1.9f, 1.0f, 1.2f));
    parts.sensor("corner sensor", vec3(-1.9f, 2.06f, 1.2f), vec3(0, 1, 0), opens("corner", vec3(0.5f), 0.0f));
    parts.sign("corner sign", Sign::white, vec3(-1.72f, 1.55f, 1.2f), vec3(1, 0, 0));
    parts.gauge("corner gauge", Sign::white, vec3(1.0f, 0.9f, 0.012f), vec3(0, 0, 1));
}

// A hooded eye looks at a grey wall. The panel that slides before it makes what the lantern's light brings red.
void furnish_red_wall(House& house, GameParts& parts) {
    house.boxes("red rail", {{vec3(-2.95f, 0.0f, -6.1f), vec3(-2.75f, 0.04f, -2.4f)}}, dark_oak);
    parts.sliding_panel("red panel", {vec3(-2.88f, 0.05f, -6.0f), vec3(-2.82f, 2.05f, -4.4f)}, vec3(0.0f, 0.0f, 1.9f),
                        red);
    const float x = -1.42f, z = -3.3f, y = 1.1f;
    house.boxes("red pillar", {{vec3(x, 0.0f, z - 0.2f), vec3(x + 0.4f, 1.7f, z + 0.2f)}}, stone);
    house.boxes("red hood",
                {{vec3(x - 0.5f, y - 0.4f, z - 0.39f), vec3(x, y + 0.4f, z - 0.35f)},
                 {vec3(x - 0.5f, y - 0.4f, z + 0.35f), vec3(x, y + 0.4f, z + 0.39f)},
                 {vec3(x - 0.5f, y + 0.36f, z - 0.35f), vec3(x, y + 0.4f, z + 0.35f)},
                 {vec3(x - 0.5f, y - 0.4f, z - 0.35f), vec3(x, y - 0.36f, z + 0.35f)}},
                soot);
    parts.sensor("red sensor", vec3(x - 0.03f, y, z), vec3(-1, 0, 0), opens("red", vec3(0.2f, 0.0f, 0.0f), 1.0f));
    parts.sign("red sign", Sign::red, vec3(x + 0.41f, 1.35f, z), vec3(1, 0, 0));
    parts.gauge("red gauge", Sign::red, vec3(2.988f, 0.9f, -2.2f), vec3(-1, 0, 0));
}

// The sun stands behind three shutters. Two let it fall on dark cloth, one on a white floor, above which an eye looks
// down; a low wall keeps the lantern away from there.
void furnish_shutters(House& house, GameParts& parts) {
    parts.sun("sun", vec3(6.24f, 9.2f, -17.0f), vec3(6.24f, 0.8f, -4.6f), vec3(4600.0f, 4300.0f, 3900.0f),
              vec2(0.23f, 0.26f));
    const float z = -6.18f;
    for (int i = 0; i < 3; ++i) {
        const Opening& window = sun_windows[std::size_t(i)];
        parts.shutter("shutter " + std::to_string(i + 1),
                      {vec3(window.from - 0.04f, window.bottom - 0.04f, z - 0.02f),
                       vec3(window.to + 0.04f, window.top + 0.04f, z + 0.02f)},
                      vec3(window.from - 0.04f, 0.0f, z), -1.9f, oak);
    }
    // Walls have no outside: this keeps the sun from the seams of the room.
    const float outer = -6.5f, inner = -6.36f;
    house.boxes("sun wall",
                {{vec3(2.0f, -0.5f, outer), vec3(10.5f, 1.0f, inner)},
                 {vec3(2.0f, 2.4f, outer), vec3(10.5f, 4.2f, inner)},
                 {vec3(2.0f, 1.0f, outer), vec3(3.9f, 2.4f, inner)},
                 {vec3(4.9f, 1.0f, outer), vec3(5.74f, 2.4f, inner)},
                 {vec3(6.74f, 1.0f, outer), vec3(7.6f, 2.4f, inner)},
                 {vec3(8.6f, 1.0f, outer), vec3(10.5f, 2.4f, inner)}},
                slate);
    house.boxes("dark cloth", {{vec3(3.6f, 0.0f, -5.0f), vec3(6.95f, 0.012f, -2.5f)}}, soot);
    house.boxes("white floor", {{vec3(7.2f, 0.0f, -5.6f), vec3(9.24f, 0.03f, -2.3f)}}, white);
    house.boxes(
        "sun fence",
        {{vec3(7.1f, 0.0f, -6.24f), vec3(7.2f, 1.15f, -2.3f)}, {vec3(7.1f, 0.0f, -2.3f), vec3(9.24f, 1.15f, -2.2f)}},
        stone);
    house.boxes("sun shelf", {{vec3(8.2f, 1.04f, -4.1f), vec3(9.24f, 1.10f, -3.1f)}}, dark_oak);
    parts.sensor("sun sensor", vec3(8.6f, 1.01f, -3.6f), vec3(0, -1, 0), opens("sun", vec3(1.9f), 0.0f));
    parts.sign("sun sign", Sign::white, vec3(7.09f, 0.8f, -3.6f), vec3(-1, 0, 0), 0.2f);
    parts.gauge("sun gauge", Sign::white, vec3(7.25f, 0.9f, -0.252f), vec3(0, 0, -1));
}

// A beam runs along the wall into a black board. The green block on its rails can be pushed into it; the eye looks at
// the side that the beam then lights.
void furnish_blocks(House& house, GameParts& parts) {
    const vec3 lamp(3.42f, 0.5f, 4.6f);
    parts.sun("beam", lamp, lamp + vec3(5.0f, 0.0f, 0.0f), vec3(150.0f, 146.0f, 140.0f), vec2(0.10f, 0.13f));
    house.boxes("beam housing",
                {{vec3(3.24f, 0.3f, 4.4f), vec3(3.4f, 0.7f, 4.8f)},
                 {vec3(3.4f, 0.66f, 4.4f), vec3(3.7f, 0.7f, 4.8f)},
                 {vec3(3.4f, 0.3f, 4.4f), vec3(3.7f, 0.34f, 4.8f)},
                 {vec3(3.4f, 0.34f, 4.4f), vec3(3.7f, 0.66f, 4.44f)},
                 {vec3(3.4f, 0.34f, 4.76f), vec3(3.7f, 0.66f, 4.8f)}},
                slate);
    house.boxes("beam end", {{vec3(9.14f, 0.0f, 3.9f), vec3(9.24f, 1.3f, 5.3f)}}, soot);
    house.boxes("block rails",
                {{vec3(5.80f, 0.0f, 1.4f), vec3(5.87f, 0.12f, 4.2f)},
                 {vec3(6.73f, 0.0f, 1.4f), vec3(6.80f, 0.12f, 5.1f)},
                 {vec3(5.80f, 0.0f, 5.02f), vec3(6.80f, 0.3f, 5.1f)}},
                dark_oak);
    parts.block("green block", vec3(6.3f, 0.0f, 2.5f), 0.8f, 3.0f, green);
    const vec3 eye(4.86f, 0.5f, 3.5f), ahead = glm::normalize(vec3(1.0f, -0.05f, 1.05f));
    house.boxes("green post", {{vec3(4.5f, 0.0f, 3.15f), vec3(4.72f, 0.75f, 3.37f)}}, stone);
    house.boxes("green hood",
                {{vec3(4.72f, 0.72f, 3.15f), vec3(5.15f, 0.76f, 3.75f)},
                 {vec3(4.5f, 0.2f, 3.37f), vec3(4.54f, 0.76f, 3.75f)},
                 {vec3(4.72f, 0.2f, 3.11f), vec3(5.15f, 0.76f, 3.15f)}},
                soot);
    parts.sensor("green sensor", eye, ahead, opens("green", vec3(0.0f, 0.2f, 0.0f), 1.0f));
    parts.sign("green sign", Sign::green, vec3(4.61f, 0.55f, 3.14f), vec3(0, 0, -1), 0.1f);
    parts.gauge("green gauge", Sign::green, vec3(9.228f, 0.9f, 1.9f), vec3(-1, 0, 0));
}

// A red and a blue panel slide into a corner. An eye above looks there: it needs both colours, from one lantern.
void furnish_colours(House& house, GameParts& parts) {
    parts.sliding_panel("red sheet", {vec3(10.6f, 0.05f, 5.84f), vec3(12.4f, 2.85f, 5.90f)}, vec3(2.85f, 0.0f, 0.0f),
                        red);
    parts.sliding_panel("blue sheet", {vec3(15.3f, 0.05f, 1.1f), vec3(15.36f, 2.85f, 2.9f)}, vec3(0.0f, 0.0f, 2.9f),
                        blue);
    house.boxes(
        "sheet rails",
        {{vec3(10.5f, 0.0f, 5.8f), vec3(15.25f, 0.04f, 5.94f)}, {vec3(15.26f, 0.0f, 1.0f), vec3(15.40f, 0.04f, 5.8f)}},
        dark_oak);
    house.boxes("violet pillar", {{vec3(13.1f, 0.0f, 3.55f), vec3(13.4f, 2.75f, 3.85f)}}, stone);
    house.boxes("violet hood",
                {{vec3(13.1f, 2.03f, 3.55f), vec3(14.2f, 2.07f, 4.65f)},
                 {vec3(13.1f, 2.71f, 3.55f), vec3(14.2f, 2.75f, 4.65f)}},
                soot);
    const vec3 ahead = glm::normalize(vec3(1.0f, 0.0f, 1.0f));
    parts.sensor("violet sensor", vec3(13.42f, 2.4f, 3.87f) + 0.04f * ahead, ahead,
                 opens("violet", vec3(0.07f, 0.0f, 0.07f), 1.0f));
    parts.sign("violet sign", Sign::violet, vec3(13.09f, 1.6f, 3.7f), vec3(-1, 0, 0));
    parts.gauge("violet gauge", Sign::violet, vec3(11.5f, 0.9f, 0.012f), vec3(0, 0, 1));
}

// High on the wall an eye looks up at the ceiling, too far for a lantern on the ground.
void furnish_tower(House& house, GameParts& parts) {
    house.lift("lift", {vec3(9.7f, 0.0f, -6.1f), vec3(11.2f, 3.4f, -4.6f)}, 0.12f, upper_floor, 14.0f, stone);
    house.boxes("walkway", {{vec3(11.22f, upper_floor - 0.14f, -6.24f), vec3(15.48f, upper_floor, -4.7f)}}, dark_oak);
    std::vector<Box> rail = {{vec3(11.3f, upper_floor + 0.86f, -4.76f), vec3(15.48f, upper_floor + 0.92f, -4.70f)},
                             {vec3(11.3f, upper_floor + 0.42f, -4.74f), vec3(15.48f, upper_floor + 0.46f, -4.71f)}};
    for (int i = 0; i < 6; ++i)
        rail.push_back({vec3(11.3f + 0.82f * float(i), upper_floor, -4.76f),
                        vec3(11.36f + 0.82f * float(i), upper_floor + 0.86f, -4.70f)});
    house.boxes("railing", rail, oak);
    house.boxes("tower bracket", {{vec3(11.85f, 5.22f, -6.24f), vec3(12.35f, 5.28f, -5.6f)}}, stone);
    parts.sensor("tower sensor", vec3(12.1f, 5.34f, -5.85f), vec3(0, 1, 0), opens("tower", vec3(0.6f), 0.0f));
    parts.sign("tower sign", Sign::white, vec3(12.1f, 5.0f, -6.228f), vec3(0, 0, 1));
    parts.gauge("tower gauge", Sign::white, vec3(14.5f, upper_floor + 0.6f, -6.228f), vec3(0, 0, 1));
}

void furnish_lamp_room(House& house) {
    house.mobile(
        "mobile", scene::make_torus(0.26f, 0.07f, 36, 14), brass,
        {vec3(10.6f, 5.2f, -8.2f), vec3(14.2f, 5.5f, -8.0f), vec3(14.4f, 5.1f, -11.4f), vec3(10.8f, 5.4f, -11.6f)},
        19.0f);
    house.boxes("dais", {{vec3(11.2f, upper_floor, -11.4f), vec3(13.8f, upper_floor + 0.14f, -9.2f)}}, stone);
    house.ball("ball", vec3(14.6f, upper_floor + 0.25f, -7.4f), 0.25f, 2.0f, red);
}

void mark_areas(GameParts& parts) {
    const auto area = [&](const char* name, const Room& room, vec3 entry, vec3 ahead, const char* title,
                          const char* hint) {
        scene::GameArea described;
        described.entry = entry;
        described.entry_facing = ahead;
        described.title = title;
        described.hint = hint;
        parts.area(name, room, described);
    };
    area("area porch", porch, vec3(0.4f, 0.02f, 9.4f), vec3(0, 0, -1), "The porch",
         "Take the lantern. Doors in this house open to light, but their eyes look away from it.");
    area("area corner", corner, vec3(0.0f, 0.02f, 5.3f), vec3(0, 0, -1), "The corner",
         "The eye on the column looks up. Carry the lantern round the corner, and the ceiling will shine on it.");
    area("area red wall", red_wall, vec3(0.0f, 0.02f, -0.9f), vec3(0, 0, -1), "The red wall",
         "This eye wants red, and your lantern is white. Slide the panel before the eye, then light it from the side, "
         "out "
         "of the eye's view.");
    area("area shutters", shutters, vec3(3.9f, 0.02f, -3.24f), vec3(1, 0, 0), "The shutters",
         "The lantern is too weak for the eye under the shelf. The sun is not: let it fall where the floor is white.");
    area("area blocks", blocks, vec3(6.24f, 0.02f, 0.8f), vec3(0, 0, 1), "The block",
         "The beam passes the eye by. Push the green block along its rails until it stands in the light.");
    area(
        "area colours", colours, vec3(10.1f, 0.02f, 3.0f), vec3(1, 0, 0), "Two colours",
        "The eye above wants red and blue at once. Bring both sheets to the corner, and stand there with the lantern.");
    area("area tower", tower, vec3(12.48f, 0.02f, -0.9f), vec3(0, 0, -1), "The tower",
         "The ceiling is too far away from down here. The lift goes up; take the light with you.");
    area("area lamp room", lamp_room, vec3(13.55f, upper_floor + 0.02f, -7.2f), vec3(0, 0, -1), "The lamp room",
         "Step under the great lamp.");
    scene::GameArea goal;
    goal.entry = vec3(12.48f, upper_floor + 0.16f, -8.6f);
    goal.title = "The end";
    goal.goal = true;
    parts.area("area goal", {vec3(11.2f, upper_floor, -11.4f), vec3(13.8f, 6.0f, -9.2f)}, goal);
}

void place_cameras(SceneBuilder& s) {
    s.camera("view", vec3(2.4f, 1.7f, 9.9f), vec3(-0.4f, 1.0f, 7.0f), 66.0f);
    s.camera("corner", vec3(2.6f, 1.65f, 0.5f), vec3(-2.0f, 1.5f, 1.6f), 70.0f);
    s.camera("red_wall", vec3(1.9f, 1.7f, -0.9f), vec3(-2.4f, 1.1f, -3.8f), 70.0f);
    s.camera("shutters", vec3(4.0f, 1.7f, -1.0f), vec3(8.4f, 0.9f, -4.6f), 72.0f);
    s.camera("blocks", vec3(8.6f, 1.8f, 0.6f), vec3(4.8f, 0.5f, 4.2f), 70.0f);
    s.camera("colours", vec3(10.0f, 1.8f, 0.8f), vec3(14.6f, 1.3f, 5.0f), 72.0f);
    s.camera("tower", vec3(10.2f, 1.7f, -0.8f), vec3(12.9f, 3.4f, -6.0f), 74.0f);
    s.camera("lamp_room", vec3(14.8f, 5.1f, -7.0f), vec3(11.4f, 4.4f, -11.0f), 72.0f);
    s.exposure(7.6f);
}

} // namespace

void make_lantern_game(SceneBuilder& s) {
    House house(s);
    GameParts parts(s);
    build_shells(house);
    build_ceilings(house);
    build_openings(house);
    build_doors(house, parts);
    furnish_porch_and_corner(house, parts);
    furnish_red_wall(house, parts);
    furnish_shutters(house, parts);
    furnish_blocks(house, parts);
    furnish_colours(house, parts);
    furnish_tower(house, parts);
    furnish_lamp_room(house);
    mark_areas(parts);
    house.sky(daylight);
    house.player_start(vec3(0.4f, 0.02f, 9.4f), vec3(0.0f, 0.02f, 0.0f));
    place_cameras(s);
}

} // namespace sunfleck::assets
