#include "engine/simulation/simulation.h"

#include "engine/simulation/parent_space.h"
#include "engine/simulation/path_movers.h"

#include <algorithm>
#include <bit>

namespace sunfleck::simulation {
namespace {

constexpr float arm = 2.2f;            // m, a person's reach
constexpr float aim = 0.85f;           // cosine: targets farther from the centre of view are ignored
constexpr float at_centre = 0.9976f;   // cosine of 4 degrees: a lantern that is looked at
constexpr float squeeze_limit = 0.04f; // m, penetration depth at which a door reverses

// The intensity of a lamp that is on.
struct LampMemory {
    vec3 area{0.0f}, emission{0.0f}, point{0.0f}, spot{0.0f};
};

std::vector<ecs::Entity> sensors_in_order(ecs::Registry& registry) {
    std::vector<ecs::Entity> sensors;
    registry.view<scene::SensorReading>().each(
        [&](ecs::Entity entity, const scene::SensorReading&) { sensors.push_back(entity); });
    std::sort(sensors.begin(), sensors.end());
    return sensors;
}

ecs::Registry& prepared(ecs::Registry& registry) {
    // Switches first, so that lamps that start switched off cast no light; then movers, so that obstacles are at their
    // initial positions.
    std::vector<scene::LightSwitch> switches;
    registry.view<scene::LightSwitch>().each(
        [&](ecs::Entity, const scene::LightSwitch& state) { switches.push_back(state); });
    for (const scene::LightSwitch& state : switches)
        apply_switch(registry, state);
    std::vector<ecs::Entity> activated;
    registry.view<scene::Mover>().each([&](ecs::Entity entity, const scene::Mover& mover) {
        if (mover.activation != scene::MoverActivation::clock && !registry.has<scene::MoverState>(entity))
            activated.push_back(entity);
    });
    for (const ecs::Entity entity : activated)
        registry.emplace<scene::MoverState>(entity, {});
    set_movers_to_step(registry, 0);
    return registry;
}

} // namespace

void apply_switch(ecs::Registry& registry, const scene::LightSwitch& state) {
    for (const std::string& name : scene::split_names(state.lamps)) {
        const ecs::Entity lamp = scene::find_by_name(registry, name);
        if (lamp.is_null())
            continue;
        LampMemory memory;
        if (const LampMemory* known = registry.try_get<LampMemory>(lamp)) {
            memory = *known;
        } else {
            if (const auto* light = registry.try_get<scene::AreaLight>(lamp))
                memory.area = light->radiance;
            if (const auto* material = registry.try_get<scene::Material>(lamp))
                memory.emission = material->emission;
            if (const auto* light = registry.try_get<scene::PointLight>(lamp))
                memory.point = light->intensity;
            if (const auto* light = registry.try_get<scene::SpotLight>(lamp))
                memory.spot = light->intensity;
            registry.emplace<LampMemory>(lamp, memory);
        }
        const float share = state.on ? 1.0f : 0.0f;
        if (registry.has<scene::AreaLight>(lamp))
            registry.patch<scene::AreaLight>(lamp, [&](auto& light) { light.radiance = share * memory.area; });
        if (registry.has<scene::Material>(lamp))
            registry.patch<scene::Material>(lamp, [&](auto& material) { material.emission = share * memory.emission; });
        if (registry.has<scene::PointLight>(lamp))
            registry.patch<scene::PointLight>(lamp, [&](auto& light) { light.intensity = share * memory.point; });
        if (registry.has<scene::SpotLight>(lamp))
            registry.patch<scene::SpotLight>(lamp, [&](auto& light) { light.intensity = share * memory.spot; });
    }
}

Simulation::Simulation(ecs::Registry& registry, const scene::MeshStore& meshes)
    : physics_(prepared(registry), meshes), start_(find_start(registry, physics_.bounds())), player_(start_) {
    registry.view<scene::Lantern>().each([&](ecs::Entity entity, const scene::Lantern& lantern) {
        if (lantern.carried && carried_.is_null())
            carried_ = entity;
    });
    find_lanterns(registry, meshes);
    link_sensors(registry);
    carry(registry);
    scene::update_world_transforms(registry);
}

void Simulation::link_sensors(ecs::Registry& registry) {
    registry.view<scene::LightSensor>().each([&](ecs::Entity entity, const scene::LightSensor& sensor) {
        for (const std::string& name : scene::split_names(sensor.opens))
            sensor_opens_.emplace_back(entity, scene::find_by_name(registry, name));
        for (const std::string& name : scene::split_names(sensor.shows))
            sensor_shows_.emplace_back(entity, scene::find_by_name(registry, name));
    });
}

// Gauges follow the readings at once.
void Simulation::show_readings(ecs::Registry& registry) const {
    for (const auto& [sensor, gauge] : sensor_shows_) {
        const scene::SensorReading* reading = registry.try_get<scene::SensorReading>(sensor);
        if (reading == nullptr || !registry.alive(gauge) || !registry.has<scene::MoverState>(gauge))
            continue;
        const float progress = std::min(reading->share / scene::sensor_gauge_end, 1.0f);
        registry.update<scene::MoverState>(gauge, {progress, false});
    }
}

// Whether all sensors that name the mover, and at least one, are open.
bool Simulation::sensors_open(const ecs::Registry& registry, ecs::Entity mover) const {
    bool named = false;
    for (const auto& [sensor, opens] : sensor_opens_) {
        if (opens != mover)
            continue;
        const scene::SensorReading* reading = registry.try_get<scene::SensorReading>(sensor);
        if (reading == nullptr || !reading->open)
            return false;
        named = true;
    }
    return named;
}

Character Simulation::find_start(ecs::Registry& registry, const Bounds& bounds) {
    ecs::Entity start;
    float height = scene::PlayerStart{}.height;
    registry.view<scene::PlayerStart>().each([&](ecs::Entity entity, const scene::PlayerStart& described) {
        start = entity;
        height = described.height;
    });
    vec3 foot = bounds.empty() ? vec3(0.0f) : bounds.centre();
    vec3 ahead(0.0f, 0.0f, -1.0f);
    const bool marked = !start.is_null();
    if (!marked)
        start = scene::find_by_name(registry, "view");
    if (!start.is_null()) {
        const mat4 world = scene::world_matrix(registry, start);
        foot = vec3(world[3]) - vec3(0.0f, marked ? 0.0f : height - 0.12f, 0.0f);
        ahead = -vec3(world[2]);
    }
    if (!is_finite(foot) || !is_finite(ahead)) // of a file whose numbers are too large for what they are multiplied by
        return {vec3(0.0f), 0.0f, height};
    return {foot, std::atan2(-ahead.x, -ahead.z), height};
}

void Simulation::step(ecs::Registry& registry, const StepInput& input) {
    ++steps_;
    const std::uint32_t pressed = input.buttons & ~held_buttons_;
    held_buttons_ = input.buttons;
    advance_movers(registry, false);
    show_readings(registry);
    set_movers_to_step(registry, steps_);
    physics_.step(registry);
    move_standing(registry);
    CharacterInput person;
    person.forward = float(input.forward) / 100.0f;
    person.right = float(input.right) / 100.0f;
    person.turn = float(input.turn) * look_unit;
    person.look_up = float(input.look_up) * look_unit;
    person.run = (input.buttons & button_run) != 0;
    person.crouch = (input.buttons & button_crouch) != 0;
    player_.step(physics_, person, carried_);
    if (glm::length(physics_.depenetration(player_.capsule())) > squeeze_limit)
        advance_movers(registry, true);
    if (pressed & button_use)
        use(registry);
    if (pressed & button_put_down)
        put_down(registry);
    carry(registry);
    scene::update_world_transforms(registry);
}

// Activated movers move towards their ends. `back`: they press against a person and retreat.
void Simulation::advance_movers(ecs::Registry& registry, bool back) {
    const vec3 person = player_.capsule().foot + vec3(0.0f, 0.5f * player_.capsule().height, 0.0f);
    std::vector<std::pair<ecs::Entity, scene::MoverState>> changed;
    registry.view<scene::Mover, scene::MoverState, scene::Transform>().each(
        [&](ecs::Entity entity, const scene::Mover& mover, const scene::MoverState& state, const scene::Transform&) {
            scene::MoverState next = state;
            const scene::MoverOrigin* origin = registry.try_get<scene::MoverOrigin>(entity);
            if (mover.activation == scene::MoverActivation::near && origin != nullptr)
                next.open =
                    glm::length(from_parent(registry, entity, origin->transform.position) - person) < mover.reach;
            if (mover.activation == scene::MoverActivation::sensor)
                next.open = sensors_open(registry, entity);
            float by = float(step_seconds) / (0.5f * mover.period) * (next.open ? 1.0f : -1.0f);
            if (back)
                by = -2.0f * by;
            next.progress = std::clamp(next.progress + by, 0.0f, 1.0f);
            if (next.progress != state.progress || next.open != state.open)
                changed.emplace_back(entity, next);
        });
    for (const auto& [entity, state] : changed)
        registry.emplace_or_replace<scene::MoverState>(entity, state);
}

// What the centre of the view is on, if a person can use it.
Simulation::Target Simulation::find_used(const ecs::Registry& registry, ecs::Entity seen) {
    if (const ecs::Entity plate = owner_of<scene::LightSwitch>(registry, seen); !plate.is_null())
        return {Interaction::switch_lamps, plate};
    const ecs::Entity mover = owner_of<scene::MoverState>(registry, seen);
    if (mover.is_null() || registry.get<scene::Mover>(mover).activation != scene::MoverActivation::use)
        return {};
    return {registry.get<scene::MoverState>(mover).open ? Interaction::close : Interaction::open, mover};
}

// A lantern about where the person looks is taken, unless they look at something else that can be used.
Simulation::Target Simulation::find_target(ecs::Registry& registry) const {
    const vec3 eye = player_.eye(), ahead = player_.forward();
    const auto hit = physics_.ray(eye, arm * ahead, carried_);
    const float free = hit ? hit->fraction * arm : arm;
    const Target used = hit ? find_used(registry, hit->entity) : Target();
    if (!carried_.is_null())
        return used;
    Target lantern;
    float best = aim;
    registry.view<scene::Lantern, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::Lantern&, const scene::WorldTransform& world) {
            const vec3 to = vec3(world.matrix[3]) - eye;
            const float distance = glm::length(to), cosine = glm::dot(to, ahead) / std::max(distance, 1e-6f);
            if (distance < std::min(arm, free + 0.4f) && cosine > best) {
                best = cosine;
                lantern = {Interaction::take, entity};
            }
        });
    if (lantern.interaction == Interaction::none)
        return used;
    const bool looked_at = cosine_to_lantern(registry, lantern.entity) > at_centre;
    return looked_at || used.interaction == Interaction::none ? lantern : used;
}

Interaction Simulation::possible_interaction(ecs::Registry& registry) const {
    return find_target(registry).interaction;
}

void Simulation::use(ecs::Registry& registry) {
    const Target target = find_target(registry);
    switch (target.interaction) {
    case Interaction::none:
        break;
    case Interaction::open:
    case Interaction::close:
        registry.patch<scene::MoverState>(target.entity, [](scene::MoverState& state) { state.open = !state.open; });
        break;
    case Interaction::switch_lamps:
        registry.patch<scene::LightSwitch>(target.entity, [](scene::LightSwitch& state) { state.on = !state.on; });
        apply_switch(registry, scene::LightSwitch(registry.get<scene::LightSwitch>(target.entity)));
        break;
    case Interaction::take:
        take(registry, target.entity);
        break;
    }
}

void Simulation::restore(ecs::Registry& registry, const SimulationState& state) {
    steps_ = state.steps;
    held_buttons_ = state.held_buttons;
    player_.restore(state.person);
    carried_ = state.carried;
    standing_ = state.standing;
    std::vector<scene::LightSwitch> switches;
    registry.view<scene::LightSwitch>().each(
        [&](ecs::Entity, const scene::LightSwitch& lamps) { switches.push_back(lamps); });
    for (const scene::LightSwitch& lamps : switches)
        apply_switch(registry, lamps);
    std::vector<std::pair<ecs::Entity, scene::Transform>> moved;
    registry.view<scene::Mover, scene::Transform>().each(
        [&](ecs::Entity entity, const scene::Mover&, const scene::Transform& transform) {
            moved.emplace_back(entity, transform);
        });
    for (const auto& [entity, transform] : moved)
        physics_.place(registry, entity, transform);
    scene::update_world_transforms(registry);
}

void Simulation::place_player(vec3 foot, vec3 ahead) {
    player_.place(foot, std::atan2(-ahead.x, -ahead.z));
}

void Simulation::place_player_at_start() {
    player_ = start_;
}

std::uint64_t Simulation::world_hash(ecs::Registry& registry) const {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    const auto add = [&](std::uint32_t word) { hash = (hash ^ word) * 0x100000001b3ull; };
    const auto add_vector = [&](vec3 v) {
        for (int i = 0; i < 3; ++i)
            add(std::bit_cast<std::uint32_t>(v[i]));
    };
    std::vector<ecs::Entity> entities;
    registry.view<scene::Mover, scene::Transform>().each(
        [&](ecs::Entity entity, const scene::Mover&, const scene::Transform&) { entities.push_back(entity); });
    registry.view<scene::LightSwitch>().each(
        [&](ecs::Entity entity, const scene::LightSwitch&) { entities.push_back(entity); });
    std::sort(entities.begin(), entities.end());
    for (const ecs::Entity entity : entities) {
        add(entity.index);
        if (const auto* transform = registry.try_get<scene::Transform>(entity)) {
            add_vector(transform->position);
            add_vector({transform->rotation.x, transform->rotation.y, transform->rotation.z});
            add(std::bit_cast<std::uint32_t>(transform->rotation.w));
        }
        if (const auto* state = registry.try_get<scene::MoverState>(entity)) {
            add(std::bit_cast<std::uint32_t>(state->progress));
            add(state->open);
        }
        if (const auto* lamps = registry.try_get<scene::LightSwitch>(entity))
            add(lamps->on);
    }
    for (const ecs::Entity entity : sensors_in_order(registry)) {
        const auto& reading = registry.get<scene::SensorReading>(entity);
        add(entity.index);
        add_vector(reading.irradiance);
        add(reading.open);
    }
    add_vector(player_.capsule().foot);
    add_vector(player_.velocity());
    add_vector({player_.yaw(), player_.pitch(), player_.capsule().height});
    add(carried_.index);
    return hash;
}

} // namespace sunfleck::simulation
