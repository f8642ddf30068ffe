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

Status check(const SensorData& sensor) {
    const vec3 normal = vector_of(sensor.normal);
    if (!is_finite(vector_of(sensor.position)) || !is_finite(normal) || !(glm::length(normal) > 1e-12f) ||
        !is_strength(sensor.threshold))
        return Error{"a sensor's position, normal and threshold must be finite, its normal not zero, its threshold not "
                     "negative"};
    return {};
}

} // namespace

Status Context::Implementation::set_for_sensors(const Field& field, std::string_view value) {
    gi::SensorSettings changed = sensor_settings;
    SUNFLECK_TRY(field_from_text(field, &changed, value));
    if (sensors)
        SUNFLECK_TRY(sensors->set_settings(changed));
    sensor_settings = changed;
    return {};
}

Result<std::uint32_t> Context::add_sensor(const SensorData& data) {
    Implementation& self = *implementation_;
    SUNFLECK_TRY(check(data));
    if (!self.sensors) {
        SUNFLECK_ASSIGN(self.sensors, gi::LightSensors::create());
        SUNFLECK_TRY(self.sensors->set_settings(self.sensor_settings));
    }
    self.sensor_entities.push_back(self.registry.create());
    const std::uint32_t number = std::uint32_t(self.sensor_entities.size() - 1);
    SUNFLECK_TRY(set_sensor(number, data));
    return number;
}

Status Context::set_sensor(std::uint32_t sensor, const SensorData& data) {
    Implementation& self = *implementation_;
    SUNFLECK_ASSIGN(const ecs::Entity entity, self.find(self.sensor_entities, sensor, "sensor"));
    SUNFLECK_TRY(check(data));
    scene::LightSensor described;
    described.threshold = vector_of(data.threshold);
    self.registry.emplace_or_replace<scene::LightSensor>(entity, described);
    self.place(entity, place_of(data));
    return {};
}

Status Context::remove_sensor(std::uint32_t sensor) {
    Implementation& self = *implementation_;
    SUNFLECK_ASSIGN(const ecs::Entity entity, self.find(self.sensor_entities, sensor, "sensor"));
    self.registry.destroy(entity);
    self.sensor_entities[sensor] = ecs::null_entity;
    return {};
}

Status Context::step_sensors() {
    Implementation& self = *implementation_;
    return self.sensors ? self.sensors->step(self.registry, self.meshes, &self.textures) : Status();
}

SensorValue Context::read_sensor(std::uint32_t sensor) const {
    const Implementation& self = *implementation_;
    SensorValue value;
    if (sensor >= self.sensor_entities.size() || self.sensor_entities[sensor].is_null())
        return value;
    if (const auto* reading = self.registry.try_get<scene::SensorReading>(self.sensor_entities[sensor])) {
        value.irradiance = {reading->irradiance.x, reading->irradiance.y, reading->irradiance.z};
        value.share = reading->share;
        value.open = reading->open;
    }
    return value;
}

} // namespace sunfleck::host
