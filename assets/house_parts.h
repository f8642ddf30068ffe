// Building blocks of a house: room shells with doorways and windows, furniture, and moving objects.
#pragma once

#include "assets/scene_builder.h"
#include "engine/scene/simulation_components.h"

#include <map>

namespace sunfleck::assets {

using scene::PatternKind;

struct Room {
    vec3 lowest, highest; // inner bounds
};

struct Box {
    vec3 lowest, highest;
};

enum class Wall { west, east, north, south };

// Along the wall (x, or z for west and east) and in height, world coordinates.
struct Opening {
    float from, to, bottom, top;
};

struct Covering {
    vec3 colour;
    PatternKind kind = PatternKind::none;
    vec3 second{0.5f};
    float scale = 1.0f;
};

// Two plates that three posts hold apart, a flame between them, and the point light that it stands for. Metres.
struct LanternForm {
    float posts = 0.24f; // their length
    float base_radius = 0.085f, cap_radius = 0.075f, ring_radius = 0.07f, flame_radius = 0.03f;
    float flame_height = 0.09f, light_height = 0.16f;
    bool flame_emits = true; // or else it only looks bright: nothing that moves is an area light then
};

// Images show the base colour as it is: without any extension of glTF beside the one that says so, which readers need
// not understand together.
void show_base_colour(scene::Material& material);

class House {
public:
    static constexpr float wall_thickness = 0.09f; // of each room's own wall
    static constexpr float gap = 0.06f;            // between the walls of neighbouring rooms: doors slide there

    explicit House(SceneBuilder& builder) : s_(builder) {}

    // Walls in the order west, east, north, south; one mesh each, without hidden faces.
    void shell(const std::string& name, const Room& room, const vec3 (&colours)[4],
               const std::map<Wall, std::vector<Opening>>& openings);
    void floor(const std::string& name, const Room& room, const Covering& covering);
    void ceiling(const std::string& name, const Room& room, vec3 colour, const std::vector<SceneBuilder::Lamp>& lamps);
    // Glazing bars in the opening, and an area light for the sky behind it.
    void window(const std::string& name, Wall wall, const Room& room, const Opening& opening, vec3 bars, vec3 radiance);
    // A door frame that closes the gap between two rooms.
    void frame(const std::string& name, Wall wall, const Room& room, const Opening& opening, vec3 colour);
    void sky(vec3 radiance);
    void player_start(vec3 foot, vec3 looking_at);

    ecs::Entity add(const std::string& name, scene::Mesh mesh, vec3 colour, vec3 position);
    ecs::Entity boxes(const std::string& name, const std::vector<Box>& parts, vec3 colour);
    void pattern(const std::string& name, const scene::SurfacePattern& pattern);
    void table(const std::string& name, vec3 foot, float height, float radius, vec3 colour);
    // A flat lamp on a wall, and a globe on a thin stem of 5 cm.
    void wall_lamp(const std::string& name, vec3 centre, vec3 facing_to, float width, float height, vec3 radiance);
    void globe_lamp(const std::string& name, vec3 centre, float radius, vec3 radiance, vec3 stem);
    void light_switch(const std::string& name, vec3 centre, vec3 facing, const std::string& lamps);

    void sliding_door(const std::string& name, vec3 centre, vec3 size, vec3 travel, vec3 colour);
    void swinging_door(const std::string& name, vec3 centre, vec3 size, vec3 hinge, float angle, vec3 colour);
    // A box whose top moves from `low` to `high` and back.
    void lift(const std::string& name, const Box& platform, float low, float high, float period, vec3 colour);
    void turning_panel(const std::string& name, vec3 centre, vec3 size, float period, vec3 colour);
    void swinging_lamp(const std::string& name, vec3 pivot, float length, vec3 radiance, vec3 colour);
    void mobile(const std::string& name, scene::Mesh mesh, vec3 colour, const std::vector<vec3>& points, float period);
    void ball(const std::string& name, vec3 centre, float radius, float mass, vec3 colour);
    void glowing_ball(const std::string& name, vec3 centre, float radius, float mass, vec3 radiance);
    void crate(const std::string& name, vec3 centre, float side, float mass, vec3 colour);
    void lantern(const std::string& name, vec3 foot, vec3 intensity, vec3 colour, const LanternForm& form = {});

private:
    void flame(const std::string& name, ecs::Entity lantern, vec3 intensity, const LanternForm& form);
    ecs::Entity sphere_light(const std::string& name, vec3 centre, float radius, vec3 radiance);
    ecs::Entity group(const std::string& name, vec3 position);
    ecs::Entity part(const std::string& name, ecs::Entity parent, scene::Mesh mesh, vec3 colour, vec3 position);
    void body(ecs::Entity entity, scene::BodyShape shape, float mass);
    std::string numbered(const std::string& name) { return name + " " + std::to_string(number_++); }

    SceneBuilder& s_;
    int number_ = 0;
};

} // namespace sunfleck::assets
