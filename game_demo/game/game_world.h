// A level as a game, one fixed step at a time: simulation, light sensors, areas, goal, reset of a room. Its state is a
// function of the level, the sensor settings and the inputs alone.
#pragma once

#include "engine/simulation/simulation.h"
#include "gi_module/light_sensors/light_sensors.h"

namespace sunfleck::demo {

class GameWorld {
public:
    // The registry holds the freshly loaded level; it, the meshes and textures are the caller's and must outlive this.
    static Result<std::unique_ptr<GameWorld>> create(ecs::Registry& registry, const scene::MeshStore& meshes,
                                                     const scene::TextureStore* textures,
                                                     const gi::SensorSettings& settings = {});

    // From now on the level is that of another registry, which holds the same: entities, components, and what they are
    // made of. The game goes on as if nothing had happened, to the bit.
    void continue_with(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore* textures);
    // The registry holds the freshly loaded level once more, with the same entities: from now on the game is as one
    // that was just created, to the bit. An error: readings of sensors stay as they were.
    Status restart();
    // One step of simulation::step_seconds. An error: readings of sensors stay as they were.
    Status step(const simulation::StepInput& input);

    ecs::Registry& registry() const { return *registry_; }
    simulation::Simulation& simulation() const { return *simulation_; }
    const gi::LightSensors& sensors() const { return *sensors_; }
    bool has_sensors() const { return has_sensors_; }

    // The area that the person is in, or was in last; null before the first.
    const scene::GameArea* area() const;
    ecs::Entity area_entity() const { return area_; }
    // The goal was reached.
    bool finished() const { return finished_; }
    // Sensors that are open, or were once.
    std::size_t sensors_opened() const { return opened_.size(); }

    struct Progress {
        ecs::Entity area;
        bool finished = false;
        std::vector<ecs::Entity> opened; // sensors
    };
    Progress progress() const { return {area_, finished_, opened_}; }
    // After the simulation was restored; see saved_game.h.
    void restore(const Progress& progress);

    // Puts the person at the entry of the area, and what the area holds where it began: bodies, what is used, lamps.
    // The lantern is there where it began, or else in the person's hand. What sensors keep open stays open.
    void reset_room();

private:
    struct Start {
        ecs::Entity entity;
        scene::Transform transform;
    };

    GameWorld(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore* textures);
    Status begin();
    Status renew_sensors();
    void find_area();
    void note_open_sensors();
    void reset_bodies(const Bounds& box);
    void reset_used(const Bounds& box);
    Bounds box_of(ecs::Entity area) const;

    ecs::Registry* registry_;
    const scene::MeshStore* meshes_;
    const scene::TextureStore* textures_;
    std::vector<Start> starts_; // of free bodies and the lantern
    std::vector<std::pair<ecs::Entity, bool>> switches_;
    std::unique_ptr<simulation::Simulation> simulation_;
    std::unique_ptr<gi::LightSensors> sensors_;
    std::vector<ecs::Entity> areas_, opened_;
    ecs::Entity area_;
    std::uint32_t held_ = 0;
    bool has_sensors_ = false, finished_ = false;
};

} // namespace sunfleck::demo
