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
    // Of the level as it was loaded (level_contents.h).
    const std::string& contents() const { return contents_; }

    // Whether the level is a game: it has areas or a goal.
    bool is_game() const { return !areas_.empty(); }
    // The area that the person is in, or was in last; null before the first.
    const scene::GameArea* area() const;
    ecs::Entity area_entity() const { return area_; }
    // Whether a point of the world lies in the area's box, which turns and grows with its entity.
    bool is_in(ecs::Entity area, vec3 point) const;
    // The goal was reached.
    bool finished() const { return finished_; }
    // Sensors that are open, or were once.
    std::size_t sensors_opened() const { return opened_.size(); }

    struct Progress {
        ecs::Entity area;
        bool finished = false;
        std::vector<ecs::Entity> opened; // sensors
        ecs::Entity lantern;             // that the person carried last; null: none so far
    };
    Progress progress() const { return {area_, finished_, opened_, lantern_}; }
    // After the simulation was restored; see saved_game.h.
    void restore(const Progress& progress);

    // Puts the person at the entry of the area (where nobody can stand there, on the floor below its centre, or where
    // the level begins), and what the area holds where it began: bodies, what is used, lamps. A lantern that began
    // there is there, the one that was carried last otherwise in the person's hand; all others stay. What sensors keep
    // open stays open.
    void reset_room();

private:
    struct Start {
        ecs::Entity entity;
        scene::Transform transform;
        vec3 place{0.0f}; // in the world
    };

    GameWorld(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore* textures);
    Status begin();
    Status renew_sensors();
    void find_area();
    void note_open_sensors();
    void note_lantern();
    void reset_bodies();
    void reset_used();
    void reset_person();
    std::optional<vec3> floor_below(vec3 foot) const;

    const std::string contents_;
    ecs::Registry* registry_;
    const scene::MeshStore* meshes_;
    const scene::TextureStore* textures_;
    std::vector<Start> starts_; // of free bodies and lanterns
    std::vector<std::pair<ecs::Entity, bool>> switches_;
    std::unique_ptr<simulation::Simulation> simulation_;
    std::unique_ptr<gi::LightSensors> sensors_;
    std::vector<ecs::Entity> areas_, opened_;
    ecs::Entity area_, lantern_;
    std::uint32_t held_ = 0;
    bool has_sensors_ = false, finished_ = false;
};

} // namespace sunfleck::demo
