#include "game_demo/game/game_world.h"

#include <algorithm>

namespace sunfleck::demo {
namespace {

bool inside(const Bounds& box, vec3 point) {
    return glm::all(glm::greaterThanEqual(point, box.minimum)) && glm::all(glm::lessThanEqual(point, box.maximum));
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
    : registry_(&registry), meshes_(&meshes), textures_(textures) {
    registry.view<scene::Mover, scene::Transform>().each(
        [&](ecs::Entity entity, const scene::Mover& mover, const scene::Transform& transform) {
            if (mover.path == scene::MoverPath::none)
                starts_.push_back({entity, transform});
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
    area_ = ecs::null_entity;
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
    if (!has_sensors_)
        return {};
    SUNFLECK_TRY(sensors_->step(*registry_, *meshes_, textures_));
    note_open_sensors();
    return {};
}

const scene::GameArea* GameWorld::area() const {
    return area_.is_null() ? nullptr : registry_->try_get<scene::GameArea>(area_);
}

Bounds GameWorld::box_of(ecs::Entity area) const {
    const vec3 centre(scene::world_matrix(*registry_, area)[3]), half = registry_->get<scene::GameArea>(area).half_size;
    return {centre - half, centre + half};
}

void GameWorld::find_area() {
    const vec3 place = simulation_->player().capsule().foot + vec3(0.0f, 0.1f, 0.0f);
    for (const ecs::Entity area : areas_) {
        if (!inside(box_of(area), place))
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

void GameWorld::restore(const Progress& progress) {
    area_ = progress.area;
    finished_ = progress.finished;
    opened_ = progress.opened;
    held_ = simulation_->state().held_buttons;
    sensors_->forget();
}

void GameWorld::reset_room() {
    const scene::GameArea* area = this->area();
    if (area == nullptr)
        return;
    const Bounds box = box_of(area_);
    reset_bodies(box);
    reset_used(box);
    const vec3 centre(scene::world_matrix(*registry_, area_)[3]);
    simulation_->place_player(centre + area->entry, area->entry_facing);
}

void GameWorld::reset_bodies(const Bounds& box) {
    for (const Start& start : starts_) {
        const bool here = inside(box, start.transform.position);
        if (registry_->has<scene::Lantern>(start.entity)) {
            if (here)
                simulation_->put_lantern(*registry_, start.entity, start.transform);
            else
                simulation_->hand_lantern(*registry_, start.entity);
        } else if (here) {
            simulation_->physics().place(*registry_, start.entity, start.transform);
        }
    }
}

void GameWorld::reset_used(const Bounds& box) {
    for (const ecs::Entity entity : all_with<scene::MoverState>(*registry_)) {
        const auto* origin = registry_->try_get<scene::MoverOrigin>(entity);
        if (registry_->get<scene::Mover>(entity).activation == scene::MoverActivation::use && origin != nullptr &&
            inside(box, origin->transform.position))
            registry_->update<scene::MoverState>(entity, {});
    }
    for (const auto& [entity, on] : switches_) {
        if (!inside(box, vec3(scene::world_matrix(*registry_, entity)[3])))
            continue;
        registry_->patch<scene::LightSwitch>(entity, [&, lit = on](scene::LightSwitch& state) { state.on = lit; });
        simulation::apply_switch(*registry_, scene::LightSwitch(registry_->get<scene::LightSwitch>(entity)));
    }
}

} // namespace sunfleck::demo
