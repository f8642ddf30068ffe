#include "game_demo/game/level_sensors.h"

#include "engine/core/log.h"

#include <utility>

namespace sunfleck::demo {

Status LevelSensors::begin(const gi::SensorSettings& settings) {
    SUNFLECK_ASSIGN(sensors_, gi::LightSensors::create());
    return sensors_->set_settings(settings);
}

void LevelSensors::step(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore& textures) {
    bool any = false;
    registry.view<scene::LightSensor>().each([&](ecs::Entity, const scene::LightSensor&) { any = true; });
    if (!any)
        return;
    const Status stepped = sensors_->step(registry, meshes, &textures);
    if (!stepped && !std::exchange(failed_, true))
        log_warning("light sensors stay as they are: " + stepped.error().message);
}

} // namespace sunfleck::demo
