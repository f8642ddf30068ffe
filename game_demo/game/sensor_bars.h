// What a light sensor gets and needs, colour by colour, as the game shows it.
#pragma once

#include "engine/scene/simulation_components.h"

#include <string>
#include <vector>

namespace sunfleck::demo {

struct SensorBar {
    int channel = 0;    // 0 red, 1 green, 2 blue
    float gets = 0.0f;  // of what the sensor needs of this colour: 1 is enough
    float taken = 0.0f; // of that, what colours that it does not need count against it
    float counts() const { return gets > taken ? gets - taken : 0.0f; }
};

// One for each colour that the sensor needs, red first. It opens where all count 1.
std::vector<SensorBar> sensor_bars(const scene::LightSensor& sensor, const scene::SensorReading& reading);
// The lines below them, such as "red 35 %, blue 0 % of what it needs".
std::string sensor_words(const scene::LightSensor& sensor, const scene::SensorReading& reading);

} // namespace sunfleck::demo
