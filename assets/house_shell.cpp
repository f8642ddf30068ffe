// The shell of a house: walls, floors, ceilings, windows and door frames.
#include "assets/house_parts.h"

#include <algorithm>

namespace sunfleck::assets {
namespace {

enum Face { x_low = 1, x_high = 2, y_low = 4, y_high = 8, z_low = 16, z_high = 32, all_faces = 63 };

// Appends the given faces of a box.
void append_box(scene::Mesh& mesh, vec3 lo, vec3 hi, int faces = all_faces) {
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            if ((faces & (1 << (2 * axis + side))) == 0)
                continue;
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const auto base = std::uint32_t(mesh.positions.size());
            for (int k = 0; k < 4; ++k) {
                vec3 p;
                p[axis] = side == 0 ? lo[axis] : hi[axis];
                p[u] = k == 1 || k == 2 ? hi[u] : lo[u];
                p[v] = k >= 2 ? hi[v] : lo[v];
                mesh.positions.push_back(p);
                vec3 normal(0.0f);
                normal[axis] = side == 0 ? -1.0f : 1.0f;
                mesh.normals.push_back(normal);
            }
            const std::uint32_t front[] = {0, 1, 2, 0, 2, 3}, back[] = {0, 2, 1, 0, 3, 2};
            for (int k = 0; k < 6; ++k)
                mesh.indices.push_back(base + (side == 1 ? front[k] : back[k]));
        }
}

// A wall as a slab: the axis along it, the axis across it, and its extent on both.
struct Slab {
    int along, across;
    float from, to;        // along
    float inner, outer;    // across
    int inner_face;        // that faces the room
    int end_low, end_high; // faces at its ends
};

Slab slab_of(Wall wall, const Room& room) {
    const float t = House::wall_thickness;
    switch (wall) {
    case Wall::west:
        return {2, 0, room.lowest.z - t, room.highest.z + t, room.lowest.x, room.lowest.x - t, x_high, z_low, z_high};
    case Wall::east:
        return {2, 0, room.lowest.z - t, room.highest.z + t, room.highest.x, room.highest.x + t, x_low, z_low, z_high};
    case Wall::north:
        return {0, 2, room.lowest.x - t, room.highest.x + t, room.lowest.z, room.lowest.z - t, z_high, x_low, x_high};
    case Wall::south:
        break;
    }
    return {0, 2, room.lowest.x - t, room.highest.x + t, room.highest.z, room.highest.z + t, z_low, x_low, x_high};
}

Box piece_of(const Slab& slab, float from, float to, float bottom, float top) {
    Box box;
    box.lowest[slab.along] = from;
    box.highest[slab.along] = to;
    box.lowest.y = bottom;
    box.highest.y = top;
    box.lowest[slab.across] = std::min(slab.inner, slab.outer);
    box.highest[slab.across] = std::max(slab.inner, slab.outer);
    return box;
}

// Where openings begin and end along the wall.
std::vector<float> cuts_of(const Slab& slab, const std::vector<Opening>& openings) {
    std::vector<float> cuts = {slab.from, slab.to};
    for (const Opening& opening : openings)
        cuts.insert(cuts.end(), {opening.from, opening.to});
    std::sort(cuts.begin(), cuts.end());
    return cuts;
}

// The openings above `place`, from the lowest to the highest.
std::vector<Opening> openings_at(float place, const std::vector<Opening>& openings) {
    std::vector<Opening> here;
    for (const Opening& opening : openings)
        if (place > opening.from && place < opening.to)
            here.push_back(opening);
    std::sort(here.begin(), here.end(), [](const Opening& a, const Opening& b) { return a.bottom < b.bottom; });
    return here;
}

// The ends of a full-height piece that line an opening beside it.
int lining_faces(const Slab& slab, float from, float to, const std::vector<Opening>& openings) {
    int faces = 0;
    for (const Opening& opening : openings) {
        if (std::abs(opening.to - from) < 1e-4f)
            faces |= slab.end_low;
        if (std::abs(opening.from - to) < 1e-4f)
            faces |= slab.end_high;
    }
    return faces;
}

// Pieces between openings. Only faces that line an opening, and the one that faces the room, are kept.
scene::Mesh wall_mesh(const Slab& slab, float bottom, float top, const std::vector<Opening>& openings) {
    const std::vector<float> cuts = cuts_of(slab, openings);
    scene::Mesh mesh;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i + 1] - cuts[i] < 1e-4f)
            continue;
        const std::vector<Opening> here = openings_at(0.5f * (cuts[i] + cuts[i + 1]), openings);
        const int lining = here.empty() ? lining_faces(slab, cuts[i], cuts[i + 1], openings) : 0;
        float y = bottom;
        const auto add = [&](float from, float to, int faces) {
            if (to - from < 1e-4f)
                return;
            const Box box = piece_of(slab, cuts[i], cuts[i + 1], from, to);
            append_box(mesh, box.lowest, box.highest, faces | lining | slab.inner_face);
        };
        for (const Opening& opening : here) {
            add(y, opening.bottom, y_high | (y > bottom ? y_low : 0));
            y = opening.top;
        }
        add(y, top, y > bottom ? y_low : 0);
    }
    return mesh;
}

} // namespace

void House::shell(const std::string& name, const Room& room, const vec3 (&colours)[4],
                  const std::map<Wall, std::vector<Opening>>& openings) {
    const Wall walls[] = {Wall::west, Wall::east, Wall::north, Wall::south};
    const char* names[] = {" west", " east", " north", " south"};
    for (int i = 0; i < 4; ++i) {
        const auto found = openings.find(walls[i]);
        scene::Mesh mesh = wall_mesh(slab_of(walls[i], room), room.lowest.y, room.highest.y,
                                     found != openings.end() ? found->second : std::vector<Opening>());
        s_.add(name + names[i], std::move(mesh), diffuse(colours[i]));
    }
}

// Floors extend under the walls, up to the neighbouring room's.
void House::floor(const std::string& name, const Room& room, const Covering& covering) {
    const float rim = wall_thickness + 0.5f * gap;
    scene::Mesh mesh;
    append_box(mesh, vec3(room.lowest.x - rim, room.lowest.y - 0.11f, room.lowest.z - rim),
               vec3(room.highest.x + rim, room.lowest.y, room.highest.z + rim));
    const ecs::Entity entity = s_.add(name + " floor", std::move(mesh), diffuse(covering.colour));
    if (covering.kind != PatternKind::none)
        s_.registry().emplace<scene::SurfacePattern>(entity, {covering.kind, covering.second, covering.scale});
}

void House::ceiling(const std::string& name, const Room& room, vec3 colour,
                    const std::vector<SceneBuilder::Lamp>& lamps) {
    const float rim = wall_thickness;
    const vec3 lo = room.lowest - vec3(rim, 0, rim), hi = room.highest + vec3(rim, 0, rim);
    scene::Mesh mesh;
    const auto piece = [&](float x0, float x1, float z0, float z1) {
        append_box(mesh, vec3(x0, hi.y, z0), vec3(x1, hi.y + 0.1f, z1));
    };
    float x = lo.x;
    for (const SceneBuilder::Lamp& lamp : lamps) {
        const vec2 half(0.5f * lamp.width, 0.5f * lamp.depth), a = lamp.centre - half, b = lamp.centre + half;
        piece(x, a.x, lo.z, hi.z);
        piece(a.x, b.x, lo.z, a.y);
        piece(a.x, b.x, b.y, hi.z);
        s_.ceiling_light(lamp.name, vec3(lamp.centre.x, hi.y, lamp.centre.y), lamp.width, lamp.depth, lamp.radiance);
        x = b.x;
    }
    piece(x, hi.x, lo.z, hi.z);
    s_.add(name + " ceiling", std::move(mesh), diffuse(colour));
}

void House::window(const std::string& name, Wall wall, const Room& room, const Opening& o, vec3 bars, vec3 radiance) {
    const Slab slab = slab_of(wall, room);
    const float middle = 0.5f * (o.from + o.to), height = 0.5f * (o.bottom + o.top), thin = 0.025f;
    const auto bar = [&](float from, float to, float bottom, float top) {
        Box box = piece_of(slab, from, to, bottom, top);
        const float centre = 0.5f * (slab.inner + slab.outer);
        box.lowest[slab.across] = centre - thin;
        box.highest[slab.across] = centre + thin;
        return box;
    };
    boxes(numbered(name + " window"),
          {bar(middle - thin, middle + thin, o.bottom, o.top), bar(o.from, o.to, height - thin, height + thin),
           bar(o.from, o.from + 2 * thin, o.bottom, o.top), bar(o.to - 2 * thin, o.to, o.bottom, o.top),
           bar(o.from, o.to, o.bottom, o.bottom + 2 * thin), bar(o.from, o.to, o.top - 2 * thin, o.top)},
          bars);
    // The area light has no mesh and is invisible: through the window one sees the sky behind it.
    const ecs::Entity light = group(numbered(name + " daylight"), vec3(0.0f));
    vec3 inwards(0.0f);
    inwards[slab.across] = slab.inner > slab.outer ? 1.0f : -1.0f;
    scene::Transform transform;
    transform.position[slab.along] = middle;
    transform.position.y = height;
    transform.position[slab.across] = slab.outer - 0.02f * inwards[slab.across];
    transform.rotation = facing(inwards);
    s_.registry().patch<scene::Transform>(light, [&](scene::Transform& t) { t = transform; });
    s_.registry().emplace<scene::AreaLight>(
        light, {scene::AreaShape::rectangle, o.to - o.from, o.top - o.bottom, 0.5f, radiance});
}

void House::frame(const std::string& name, Wall wall, const Room& room, const Opening& o, vec3 colour) {
    Slab slab = slab_of(wall, room);
    const float out = slab.outer > slab.inner ? 1.0f : -1.0f, lip = 0.015f, wide = 0.05f;
    slab.inner -= out * lip;
    slab.outer = slab.inner + out * (2.0f * wall_thickness + gap + 2.0f * lip);
    // In two halves, between which a sliding door passes.
    std::vector<Box> parts;
    for (int half = 0; half < 2; ++half) {
        Slab side = slab;
        const float depth = wall_thickness + lip;
        if (half == 0)
            side.outer = side.inner + out * depth;
        else
            side.inner = side.outer - out * depth;
        parts.push_back(piece_of(side, o.from - wide, o.from + 0.03f, o.bottom, o.top + wide));
        parts.push_back(piece_of(side, o.to - 0.03f, o.to + wide, o.bottom, o.top + wide));
        parts.push_back(piece_of(side, o.from + 0.03f, o.to - 0.03f, o.top - 0.03f, o.top + wide));
    }
    boxes(name + " frame", parts, colour);
}

ecs::Entity House::boxes(const std::string& name, const std::vector<Box>& parts, vec3 colour) {
    scene::Mesh mesh;
    for (const Box& box : parts)
        append_box(mesh, box.lowest, box.highest);
    return s_.add(name, std::move(mesh), diffuse(colour));
}

} // namespace sunfleck::assets
