// Light sensors of a foreign host, mirrored into the registry.
#include "gi_module/host_context.h"

namespace sunfleck::host {
namespace {

// +Z along the normal.
mat4 place_of(const SensorData& sensor) {
    const vec3 z = glm::normalize(vector_of(sensor.normal));
    vec3 x, y;
    orthonormal_basis(z, x, y);
    return mat4(vec4(x, 0.0f), vec4(y, 0.0f), vec4(z, 0.0f), vec4(vector_of(sensor.position), 1.0f));
}

} // namespace

void Mirror::add_sensor(const Description& description, std::uint32_t number) {
    sensors.add_as(number, registry.create());
    set_sensor(sensors[number], description.sensors[number].data);
}

void Mirror::set_sensor(ecs::Entity entity, const SensorData& data) {
    scene::LightSensor described;
    described.threshold = vector_of(data.threshold);
    registry.emplace_or_replace<scene::LightSensor>(entity, described);
    place(entity, place_of(data));
}

Status Context::Implementation::set_for_sensors(const Field& field, std::string_view value) {
    gi::SensorSettings changed = sensor_settings;
    if (const Status status = field_from_text(field, &changed, value); !status)
        return wrong(status.error().message);
    if (follower != nullptr && follower->sensors != nullptr)
        if (const Status status = follower->sensors->set_settings(changed); !status)
            return wrong(status.error().message);
    sensor_settings = changed;
    return {};
}

Result<std::uint32_t> Context::add_sensor(const SensorData& data) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Result<std::uint32_t> {
        Description& description = self.description;
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_sensor(data));
        const std::uint32_t number = description.sensors.add(Description::Sensor{description.next_order++, data});
        self.mirror([&](Mirror& mirror) { mirror.add_sensor(description, number); });
        return number;
    });
}

Status Context::set_sensor(std::uint32_t sensor, const SensorData& data) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_there(self.description.sensors, sensor, "sensor"));
        SUNFLECK_TRY(check_sensor(data));
        self.description.sensors[sensor].data = data;
        self.mirror([&](Mirror& mirror) { mirror.set_sensor(mirror.sensors[sensor], data); });
        return {};
    });
}

Status Context::remove_sensor(std::uint32_t sensor) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        SUNFLECK_TRY(check_there(self.description.sensors, sensor, "sensor"));
        self.description.sensors.remove(sensor);
        self.mirror([&](Mirror& mirror) {
            mirror.registry.destroy(mirror.sensors[sensor]);
            mirror.sensors.remove(sensor);
        });
        return {};
    });
}

Status Context::step_sensors() {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        Status status = guarded(
            self.engine_log, [&] { return self.step_sensors(); }, "step_sensors");
        if (!status && self.follower != nullptr)
            self.follower->sensors.reset(); // they begin again
        return status;
    });
}

Status Context::Implementation::step_sensors() {
    if (description.sensors.empty() && (damaged || follower == nullptr || follower->sensors == nullptr))
        return {};
    if (damaged || follower == nullptr)
        SUNFLECK_TRY(restart());
    std::unique_ptr<gi::LightSensors>& sensors = follower->sensors;
    if (sensors == nullptr) {
        SUNFLECK_ASSIGN(sensors, gi::LightSensors::create());
        SUNFLECK_TRY(sensors->set_settings(sensor_settings));
    }
    return sensors->step(follower->mirror.registry, description.meshes, &description.textures);
}

SensorValue Context::read_sensor(std::uint32_t sensor) const {
    const Implementation& self = *implementation_;
    SensorValue value;
    const Implementation::Reading reads(self);
    if (!reads.allowed || self.damaged || self.follower == nullptr)
        return value;
    const Mirror& mirror = self.follower->mirror;
    const ecs::Entity* entity = mirror.sensors.find(sensor);
    if (entity == nullptr)
        return value;
    if (const auto* reading = mirror.registry.try_get<scene::SensorReading>(*entity)) {
        value.irradiance = {reading->irradiance.x, reading->irradiance.y, reading->irradiance.z};
        value.share = reading->share;
        value.open = reading->open;
    }
    return value;
}

} // namespace sunfleck::host
