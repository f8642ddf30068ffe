// The light sensors of a level that is shown.
#pragma once

#include "gi_module/light_sensors/light_sensors.h"

namespace sunfleck::demo {

class LevelSensors {
public:
    Status begin(const gi::SensorSettings& settings);
    // After each step of the simulation. If rays fail, readings stay as they are, and the log says so once.
    void step(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore& textures);

private:
    std::unique_ptr<gi::LightSensors> sensors_;
    bool failed_ = false;
};

} // namespace sunfleck::demo
