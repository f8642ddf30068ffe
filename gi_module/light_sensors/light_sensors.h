// Light sensors of a game: LightSensor components get a SensorReading at each fixed step, by rays on the CPU.
//
//     sensors = gi::LightSensors::create().value();
//     each fixed step, after everything has moved and world transforms are up to date:
//         sensors->step(registry, meshes, &textures);
//
// Readings are a function of the scene, the settings and the steps since the sensors began to follow it, bit for bit,
// on any number of threads: of no device, preset or frame. The registry, meshes and textures are the caller's; one
// thread at a time, and `step` itself runs on all cores. What moves is followed within half a second of steps of 1/60 s
// as long as `sensor_rays` suffice: paths_per_sensor paths of some ten rays for each sensor whose paths it may touch.
#pragma once

#include "engine/core/description.h"
#include "engine/scene/simulation_components.h"
#include "gi_module/light_sensors/sensor_path.h"

#include <memory>

namespace sunfleck::gi {

enum class SensedLight : std::uint32_t { all, direct };

struct SensorSettings {
    std::uint32_t sensor_rays = 2048; // a step, about; fewer while something moves: no more than half a second asks for
    SensedLight sensors = SensedLight::all;
    bool operator==(const SensorSettings&) const = default;
    static const TypeDescription& description();
};

class LightSensors {
public:
    static constexpr std::uint32_t paths_per_sensor = 1024;

    static Result<std::unique_ptr<LightSensors>> create();

    // Takes effect at the next step. Rejects values outside of their described ranges.
    Status set_settings(const SensorSettings& settings);
    const SensorSettings& settings() const { return settings_; }

    // Follows the registry and writes the readings. Sensors that are new are evaluated at once; one that moves costs no
    // more than others around which something moves.
    Status step(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore* textures = nullptr);
    // From now on the world is another registry with other stores, which hold the same entities, meshes and textures:
    // readings go on as if nothing had happened. World transforms must be up to date.
    void continue_with(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore* textures);
    // All paths are followed once more in the next step, whatever it costs: after a world was loaded.
    void forget() { forget_ = true; }

    // Paths that wait to be followed once more; 0: readings do not change until something moves.
    std::size_t pending() const;
    // Of the last step.
    std::uint32_t rays() const { return rays_; }
    double milliseconds() const { return milliseconds_; }
    // What the readings are means over; for tests that compare with other methods.
    const SensorScene& scene() const { return scene_; }

private:
    struct Sensor {
        ecs::Entity entity;
        SensorPlace place;
        std::vector<SensorPath> paths;
        std::vector<std::uint8_t> pending; // by path
        std::size_t pending_count = 0, next = 0;
        std::uint32_t unchanged = 0; // paths followed last, one after another, that had the light that they had before
        bool fresh = true;           // all of its paths are to be followed at once
        Bounds extent, vertices;     // of all paths
    };
    // A path to follow.
    struct Job {
        std::size_t sensor = 0, path = 0;
        bool changed = true; // its light
    };

    LightSensors() = default;
    void find_sensors(ecs::Registry& registry);
    void mark_changes(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::SceneChanges& changes);
    void take_emitters(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::SceneChanges& changes);
    void mark_all();
    static void mark(Sensor& sensor, std::size_t path);
    void mark_touched(const Bounds& box);
    void mark_lit_by(const Emitter& emitter);
    std::uint32_t add_next(std::size_t sensor);
    std::uint32_t most_rays(const Sensor& sensor) const;
    void choose_fresh_jobs();
    void choose_jobs();
    void follow_jobs();
    void write_readings(ecs::Registry& registry) const;

    std::unique_ptr<raytrace::RayScene> rays_scene_;
    std::unique_ptr<scene::ChangeTracker> tracker_;
    SensorSettings settings_;
    SensorScene scene_;
    std::vector<Emitter> emitters_; // of the last step
    std::vector<Sensor> sensors_;   // by entity
    std::vector<Job> jobs_;
    bool forget_ = false;
    bool changing_ = false; // something moved, or a lamp changed, in the last step
    std::uint32_t rays_ = 0;
    double milliseconds_ = 0.0;
};

} // namespace sunfleck::gi
