#include "game_demo/game/game_world.h"

#include "engine/core/log.h"
#include "engine/simulation/parent_space.h"
#include "game_demo/game/level_contents.h"

#include <algorithm>

namespace sunfleck::demo {
namespace {

vec3 place_of(const ecs::Registry& registry, ecs::Entity entity) {
    return vec3(scene::world_matrix(registry, entity)[3]);
}

template <typename T>
std::vector<ecs::Entity> all_with(ecs::Registry& registry) {
    std::vector<ecs::Entity> entities;
    registry.view<T>().each([&](ecs::Entity entity, const T&) { entities.push_back(entity); });
    std::sort(entities.begin(), entities.end());
    return entities;
}

} // namespace

GameWorld::GameWorld(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore* textures)
    : contents_(contents_of_level(registry)), registry_(&registry), meshes_(&meshes), textures_(textures) {
    registry.view<scene::Mover, scene::Transform>().each(
        [&](ecs::Entity entity, const scene::Mover& mover, const scene::Transform& transform) {
            if (mover.path == scene::MoverPath::none)
                starts_.push_back({entity, transform, place_of(registry, entity)});
        });
    registry.view<scene::LightSwitch>().each(
        [&](ecs::Entity entity, const scene::LightSwitch& state) { switches_.emplace_back(entity, state.on); });
    areas_ = all_with<scene::GameArea>(registry);
    has_sensors_ = !all_with<scene::LightSensor>(registry).empty();
}

Result<std::unique_ptr<GameWorld>> GameWorld::create(ecs::Registry& registry, const scene::MeshStore& meshes,
                                                     const scene::TextureStore* textures,
                                                     const gi::SensorSettings& settings) {
    std::unique_ptr<GameWorld> world(new GameWorld(registry, meshes, textures));
    world->simulation_ = std::make_unique<simulation::Simulation>(registry, meshes);
    SUNFLECK_ASSIGN(world->sensors_, gi::LightSensors::create());
    SUNFLECK_TRY(world->sensors_->set_settings(settings));
    SUNFLECK_TRY(world->begin());
    for (const std::string& line : scene::wrong_names(registry))
        log_warning(line);
    return world;
}

void GameWorld::continue_with(ecs::Registry& registry, const scene::MeshStore& meshes,
                              const scene::TextureStore* textures) {
    sensors_->continue_with(registry, meshes, textures);
    registry_ = &registry;
    meshes_ = &meshes;
    textures_ = textures;
}

// Sensors know the level before its first step.
Status GameWorld::begin() {
    find_area();
    note_lantern();
    return has_sensors_ ? sensors_->step(*registry_, *meshes_, textures_) : Status();
}

// They know nothing of the world so far.
Status GameWorld::renew_sensors() {
    SUNFLECK_ASSIGN(auto sensors, gi::LightSensors::create());
    SUNFLECK_TRY(sensors->set_settings(sensors_->settings()));
    sensors_ = std::move(sensors);
    return {};
}

Status GameWorld::restart() {
    const Status renewed = renew_sensors();
    simulation_ = std::make_unique<simulation::Simulation>(*registry_, *meshes_);
    opened_.clear();
    area_ = lantern_ = ecs::null_entity;
    held_ = 0;
    finished_ = false;
    const Status begun = begin();
    return renewed ? begun : renewed;
}

Status GameWorld::step(const simulation::StepInput& input) {
    const bool reset = (input.buttons & ~held_ & simulation::button_reset) != 0;
    held_ = input.buttons;
    if (reset)
        reset_room();
    simulation_->step(*registry_, input);
    find_area();
    note_lantern();
    if (!has_sensors_)
        return {};
    SUNFLECK_TRY(sensors_->step(*registry_, *meshes_, textures_));
    note_open_sensors();
    return {};
}

const scene::GameArea* GameWorld::area() const {
    return area_.is_null() ? nullptr : registry_->try_get<scene::GameArea>(area_);
}

bool GameWorld::is_in(ecs::Entity area, vec3 point) const {
    const mat4 world = scene::world_matrix(*registry_, area);
    if (glm::determinant(mat3(world)) == 0.0f) // flat
        return false;
    const vec3 local = glm::inverse(mat3(world)) * (point - vec3(world[3]));
    return glm::all(glm::lessThanEqual(glm::abs(local), registry_->get<scene::GameArea>(area).half_size));
}

void GameWorld::find_area() {
    const vec3 place = simulation_->player().capsule().foot + vec3(0.0f, 0.1f, 0.0f);
    for (const ecs::Entity area : areas_) {
        if (!is_in(area, place))
            continue;
        if (registry_->get<scene::GameArea>(area).goal)
            finished_ = true;
        else
            area_ = area;
    }
}

void GameWorld::note_open_sensors() {
    registry_->view<scene::SensorReading>().each([&](ecs::Entity entity, const scene::SensorReading& reading) {
        if (reading.open && std::find(opened_.begin(), opened_.end(), entity) == opened_.end())
            opened_.push_back(entity);
    });
}

void GameWorld::note_lantern() {
    if (simulation_->carries_lantern())
        lantern_ = simulation_->carried();
}

void GameWorld::restore(const Progress& progress) {
    area_ = progress.area;
    finished_ = progress.finished;
    opened_ = progress.opened;
    lantern_ = progress.lantern;
    held_ = simulation_->state().held_buttons;
    sensors_->forget();
}

void GameWorld::reset_room() {
    const scene::GameArea* area = this->area();
    if (area == nullptr)
        return;
    reset_bodies();
    reset_used();
    reset_person();
}

// Where a person who is put there stands in the end; none: something is in the way, or there is no floor.
std::optional<vec3> GameWorld::floor_below(vec3 foot) const {
    const simulation::PhysicsWorld& physics = simulation_->physics();
    simulation::Capsule person = simulation_->player().capsule();
    person.foot = foot;
    person.height = simulation_->player().standing_height();
    const float way = foot.y - physics.bounds().minimum.y;
    if (physics.bounds().empty() || way <= 0.0f || physics.overlaps(person))
        return std::nullopt;
    const auto floor = physics.sweep(person, vec3(0.0f, -way, 0.0f));
    if (!floor)
        return std::nullopt;
    constexpr float gap = 0.02f; // m: not within the floor
    return foot - vec3(0.0f, std::max(floor->fraction * way - gap, 0.0f), 0.0f);
}

void GameWorld::reset_person() {
    const scene::GameArea& area = *this->area();
    const mat4 world = scene::world_matrix(*registry_, area_);
    const vec3 entry(world * vec4(area.entry, 1.0f)), centre(world[3]);
    const vec3 ahead = mat3(world) * area.entry_facing;
    if (floor_below(entry)) // they fall from where the level's maker put them
        return simulation_->place_player(entry, ahead);
    for (const vec3 above : {vec3(entry.x, centre.y, entry.z), centre})
        if (const auto place = floor_below(above))
            return simulation_->place_player(*place, ahead);
    simulation_->place_player_at_start();
}

void GameWorld::reset_bodies() {
    for (const Start& start : starts_) {
        const bool here = is_in(area_, start.place);
        if (registry_->has<scene::Lantern>(start.entity)) {
            if (here)
                simulation_->put_lantern(*registry_, start.entity, start.transform);
            else if (start.entity == lantern_)
                simulation_->hand_lantern(*registry_, start.entity);
        } else if (here) {
            simulation_->physics().place(*registry_, start.entity, start.transform);
        }
    }
}

void GameWorld::reset_used() {
    for (const ecs::Entity entity : all_with<scene::MoverState>(*registry_)) {
        const auto* origin = registry_->try_get<scene::MoverOrigin>(entity);
        if (registry_->get<scene::Mover>(entity).activation == scene::MoverActivation::use && origin != nullptr &&
            is_in(area_, simulation::from_parent(*registry_, entity, origin->transform.position)))
            registry_->update<scene::MoverState>(entity, {});
    }
    for (const auto& [entity, on] : switches_) {
        if (!is_in(area_, place_of(*registry_, entity)))
            continue;
        registry_->patch<scene::LightSwitch>(entity, [&, lit = on](scene::LightSwitch& state) { state.on = lit; });
        simulation::apply_switch(*registry_, scene::LightSwitch(registry_->get<scene::LightSwitch>(entity)));
    }
}

} // namespace sunfleck::demo
