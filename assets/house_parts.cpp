#include "assets/house_parts.h"

#include <algorithm>

namespace sunfleck::assets {
namespace {

const vec3 dark_cord(0.06f);

enum Face { x_low = 1, x_high = 2, y_low = 4, y_high = 8, z_low = 16, z_high = 32, all_faces = 63 };

// Adds the wanted faces of a box.
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

// A wall as a slab: which axis it runs along and where it lies across.
struct Slab {
    int along, across;
    float from, to;        // along
    float inner, outer;    // across
    int inner_face;        // that the room sees
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

// Pieces between openings. Only faces that line an opening, and the one that the room sees, are kept.
scene::Mesh wall_mesh(const Slab& slab, float bottom, float top, const std::vector<Opening>& openings) {
    std::vector<float> cuts = {slab.from, slab.to};
    for (const Opening& opening : openings)
        cuts.insert(cuts.end(), {opening.from, opening.to});
    std::sort(cuts.begin(), cuts.end());
    scene::Mesh mesh;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i + 1] - cuts[i] < 1e-4f)
            continue;
        const float middle = 0.5f * (cuts[i] + cuts[i + 1]);
        const auto inside = [&](float place, const Opening& o) { return place > o.from && place < o.to; };
        std::vector<Opening> here;
        for (const Opening& opening : openings)
            if (inside(middle, opening))
                here.push_back(opening);
        std::sort(here.begin(), here.end(), [](const Opening& a, const Opening& b) { return a.bottom < b.bottom; });
        float y = bottom;
        const auto add = [&](float from, float to, int faces) {
            if (to - from < 1e-4f)
                return;
            // A column beside an opening lines it with its end.
            for (const Opening& opening : openings) {
                if (std::abs(opening.to - cuts[i]) < 1e-4f && here.empty())
                    faces |= slab.end_low;
                if (std::abs(opening.from - cuts[i + 1]) < 1e-4f && here.empty())
                    faces |= slab.end_high;
            }
            const Box box = piece_of(slab, cuts[i], cuts[i + 1], from, to);
            append_box(mesh, box.lowest, box.highest, faces | slab.inner_face);
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

// Floors reach under the walls, up to the neighbour's.
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
    // Without a mesh it is not seen, and what is seen is the sky behind it.
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
    // In two halves, so that a sliding door passes between them.
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

void House::sky(vec3 radiance) {
    const ecs::Entity entity = group("sky", vec3(0.0f));
    s_.registry().emplace<scene::Environment>(entity, {radiance, false});
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

ecs::Entity House::boxes(const std::string& name, const std::vector<Box>& parts, vec3 colour) {
    scene::Mesh mesh;
    for (const Box& box : parts)
        append_box(mesh, box.lowest, box.highest);
    return s_.add(name, std::move(mesh), diffuse(colour));
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

// A piece of something that moves; people and things pass through it.
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

void House::lift(const std::string& name, vec3 lowest, vec3 highest, float low, float high, float period, vec3 colour) {
    const vec3 size = highest - lowest;
    const float half = 0.5f * (high - low);
    const vec3 middle(0.5f * (lowest.x + highest.x), low + half - 0.5f * size.y, 0.5f * (lowest.z + highest.z));
    const ecs::Entity entity = add(name, scene::make_box(size), colour, middle);
    scene::Mover mover;
    mover.path = scene::MoverPath::line;
    mover.travel = vec3(0.0f, half, 0.0f);
    mover.period = period;
    mover.phase = -0.25f; // begins at the bottom
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
    transform.rotation = glm::angleAxis(0.5f * pi, vec3(1.0f, 0.0f, 0.0f)); // +Z turns to -Y
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

void House::lantern(const std::string& name, vec3 foot, vec3 intensity, vec3 colour) {
    const ecs::Entity lantern = group(name, foot);
    s_.mover(lantern, {});
    s_.registry().emplace<scene::Lantern>(lantern, {});
    part(name + " base", lantern, scene::make_cylinder(0.085f, 0.03f, 20), colour, vec3(0.0f, 0.015f, 0.0f));
    part(name + " cap", lantern, scene::make_cylinder(0.075f, 0.03f, 20), colour, vec3(0.0f, 0.265f, 0.0f));
    for (int i = 0; i < 3; ++i) {
        const float angle = 2.0f * pi * (float(i) + 0.5f) / 3.0f;
        part(name + " post " + std::to_string(i), lantern, scene::make_cylinder(0.006f, 0.24f, 8), colour,
             vec3(0.07f * std::cos(angle), 0.14f, 0.07f * std::sin(angle)));
    }
    // The flame is seen; the point above it gives the light.
    const ecs::Entity flame =
        part(name + " flame", lantern, scene::make_sphere(0.03f, 16, 8), vec3(0.0f), vec3(0.0f, 0.09f, 0.0f));
    s_.registry().patch<scene::Material>(flame, [&](scene::Material& m) { m.emission = 3.0f * intensity; });
    const ecs::Entity light = group(name + " light", vec3(0.0f, 0.16f, 0.0f));
    s_.registry().emplace<scene::Parent>(light, {lantern});
    s_.registry().emplace<scene::PointLight>(light, {intensity});
}

} // namespace sunfleck::assets
