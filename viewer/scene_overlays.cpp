#include "viewer/scene_overlays.h"

#include "engine/scene/simulation_components.h"
#include "engine/simulation/path_movers.h"

#include <array>
#include <cmath>

namespace sunfleck::viewer {
namespace {

constexpr std::uint32_t lamps = 0, areas = 1, paths = 2;
constexpr std::array<gi::Overlay, 3> all{{
    {"lamps", "Shape and direction of lamps",
     "the lamp's own; cones of a spot, edges of a panel, arrows where the light goes", "scene", lamps},
    {"areas", "Areas of a game, with the place where a reset puts the player, its start, and what sensors look at",
     "blue: area, green: its end; white: where the player stands and looks; violet: a sensor's direction", "scene",
     areas},
    {"mover_paths", "Where movers on paths go", "yellow: all the time, orange: when something sets them going", "scene",
     paths},
}};

// Lines given in an entity's own space, where a length is one of the world. In the space that is lit, a room is a few
// units large.
struct LocalLines {
    const scene::SceneSpace& space;
    gi::OverlayLines& lines;
    mat4 to_world;
    vec3 colour;

    vec3 place(vec3 local) const { return space.point(vec3(to_world * vec4(local, 1.0f))); }
    void line(vec3 from, vec3 to) const { lines.line(place(from), place(to), colour); }
    // From there on, as long as a share of a room whatever the entity's scale.
    void arrow(vec3 from, vec3 direction) const {
        constexpr float length = 0.4f, head = 0.1f;
        const vec3 world = mat3(to_world) * direction;
        if (!(glm::length(world) > 0.0f))
            return;
        const vec3 along = glm::normalize(world), begin = place(from), end = begin + length * along;
        const vec3 other = std::abs(along.y) < 0.9f ? vec3(0.0f, 1.0f, 0.0f) : vec3(1.0f, 0.0f, 0.0f);
        const vec3 side = glm::normalize(glm::cross(along, other));
        lines.line(begin, end, colour);
        for (const float sign : {-1.0f, 1.0f})
            lines.line(end, end - head * along + sign * 0.5f * head * side, colour);
    }
    // About local Z, `z` along it.
    void circle(float radius, float z) const {
        constexpr int pieces = 32;
        const auto at = [&](int i) {
            const float angle = 2.0f * pi * float(i) / float(pieces);
            return vec3(radius * std::cos(angle), radius * std::sin(angle), z);
        };
        for (int i = 0; i < pieces; ++i)
            line(at(i), at(i + 1));
    }
    void rectangle(vec2 half) const {
        const vec3 corners[] = {{half, 0.0f}, {-half.x, half.y, 0.0f}, {-half, 0.0f}, {half.x, -half.y, 0.0f}};
        for (int i = 0; i < 4; ++i)
            line(corners[i], corners[(i + 1) % 4]);
    }
    void box(vec3 half) const {
        const auto corner = [&](int index) {
            return half * vec3((index & 1) != 0 ? 1.0f : -1.0f, (index & 2) != 0 ? 1.0f : -1.0f,
                               (index & 4) != 0 ? 1.0f : -1.0f);
        };
        for (int index = 0; index < 8; ++index)
            for (const int axis : {1, 2, 4})
                if ((index & axis) == 0)
                    line(corner(index), corner(index | axis));
    }
};

LocalLines lines_of(SceneRenderer& renderer, ecs::Entity entity, gi::OverlayLines& lines, vec3 colour) {
    return {renderer.space(), lines, scene::world_matrix(renderer.registry(), entity), colour};
}

// The light's colour, as bright as lines are; a lamp that is switched off is grey.
vec3 display_colour(vec3 light) {
    const float brightest = std::max({light.x, light.y, light.z});
    return brightest > 0.0f ? glm::sqrt(light / brightest) : vec3(0.4f);
}

constexpr vec3 forwards(0.0f, 0.0f, -1.0f);

// Its end, and where lines from the tip meet it.
std::array<vec3, 4> draw_cone(const LocalLines& draw, float half_angle, float length) {
    constexpr float widest = 0.5f * pi;
    const float angle = std::min(half_angle, widest), radius = length * std::sin(angle), z = -length * std::cos(angle);
    draw.circle(radius, z);
    return {vec3(radius, 0.0f, z), vec3(-radius, 0.0f, z), vec3(0.0f, radius, z), vec3(0.0f, -radius, z)};
}

void draw_panel(const LocalLines& draw, const scene::AreaLight& light) {
    if (light.shape == scene::AreaShape::rectangle)
        draw.rectangle(0.5f * vec2(light.width, light.height));
    else
        draw.circle(light.radius, 0.0f);
    if (light.shape != scene::AreaShape::sphere)
        draw.arrow(vec3(0.0f), -forwards);
}

void draw_lamps(SceneRenderer& renderer, gi::OverlayLines& lines) {
    ecs::Registry& registry = renderer.registry();
    const float room = renderer.space().unit;
    registry.view<scene::SpotLight>().each([&](ecs::Entity entity, const scene::SpotLight& light) {
        const LocalLines draw = lines_of(renderer, entity, lines, display_colour(light.intensity));
        const float length = 0.6f * room;
        for (const vec3 end : draw_cone(draw, light.outer_angle, length))
            draw.line(vec3(0.0f), end);
        draw_cone(draw, light.inner_angle, length);
        draw.arrow(vec3(0.0f), forwards);
    });
    registry.view<scene::PointLight>().each([&](ecs::Entity entity, const scene::PointLight& light) {
        const LocalLines draw = lines_of(renderer, entity, lines, display_colour(light.intensity));
        for (const vec3 axis : {vec3(1.0f, 0.0f, 0.0f), vec3(0.0f, 1.0f, 0.0f), vec3(0.0f, 0.0f, 1.0f)})
            draw.line(-0.15f * room * axis, 0.15f * room * axis);
    });
    registry.view<scene::DirectionalLight>().each([&](ecs::Entity entity, const scene::DirectionalLight& light) {
        const LocalLines draw = lines_of(renderer, entity, lines, display_colour(light.irradiance));
        for (const vec2 side : {vec2(0.0f), vec2(0.2f, 0.0f), vec2(-0.2f, 0.0f), vec2(0.0f, 0.2f), vec2(0.0f, -0.2f)})
            draw.arrow(room * vec3(side, 0.0f), forwards);
    });
    registry.view<scene::AreaLight>().each([&](ecs::Entity entity, const scene::AreaLight& light) {
        draw_panel(lines_of(renderer, entity, lines, display_colour(light.radiance)), light);
    });
}

void draw_areas(SceneRenderer& renderer, gi::OverlayLines& lines) {
    ecs::Registry& registry = renderer.registry();
    const vec3 white(1.0f);
    const auto stand = [&](ecs::Entity entity, vec3 foot, vec3 facing, float height) {
        const LocalLines draw = lines_of(renderer, entity, lines, white);
        const vec3 eyes = foot + vec3(0.0f, height, 0.0f);
        draw.line(foot, eyes);
        draw.arrow(eyes, facing);
    };
    registry.view<scene::GameArea>().each([&](ecs::Entity entity, const scene::GameArea& area) {
        lines_of(renderer, entity, lines, area.goal ? vec3(0.4f, 1.0f, 0.5f) : vec3(0.45f, 0.65f, 1.0f))
            .box(area.half_size);
        if (!area.goal)
            stand(entity, area.entry, area.entry_facing, scene::PlayerStart().height);
    });
    registry.view<scene::PlayerStart>().each([&](ecs::Entity entity, const scene::PlayerStart& start) {
        stand(entity, vec3(0.0f), forwards, start.height);
    });
    registry.view<scene::LightSensor>().each([&](ecs::Entity entity, const scene::LightSensor&) {
        lines_of(renderer, entity, lines, vec3(0.85f, 0.5f, 1.0f)).arrow(vec3(0.0f), -forwards);
    });
}

void draw_mover_paths(SceneRenderer& renderer, gi::OverlayLines& lines) {
    constexpr std::uint32_t path_steps = 96;
    const scene::SceneSpace& space = renderer.space();
    renderer.registry().view<scene::Mover>().each([&](ecs::Entity entity, const scene::Mover& mover) {
        const std::vector<vec3> places = simulation::mover_path(renderer.registry(), entity, path_steps);
        const bool always = mover.activation == scene::MoverActivation::clock;
        const vec3 colour = always ? vec3(1.0f, 0.9f, 0.3f) : vec3(1.0f, 0.55f, 0.15f);
        for (std::size_t i = 1; i < places.size(); ++i)
            lines.line(space.point(places[i - 1]), space.point(places[i]), colour);
    });
}

} // namespace

std::span<const gi::Overlay> scene_overlays() {
    return all;
}

void draw_scene_overlay(std::uint32_t code, SceneRenderer& renderer, gi::OverlayLines& lines) {
    switch (code) {
    case lamps:
        return draw_lamps(renderer, lines);
    case areas:
        return draw_areas(renderer, lines);
    default:
        return draw_mover_paths(renderer, lines);
    }
}

} // namespace sunfleck::viewer
