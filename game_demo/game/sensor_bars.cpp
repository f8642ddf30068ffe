#include "game_demo/game/sensor_bars.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::demo {
namespace {

constexpr const char* names[] = {"red", "green", "blue"};
constexpr float worth_saying = 0.05f; // of what is needed

std::string percent(float share) {
    return std::to_string(std::lround(100.0f * share)) + " %";
}

} // namespace

std::vector<SensorBar> sensor_bars(const scene::LightSensor& sensor, const scene::SensorReading& reading) {
    float unwanted = 0.0f; // W/m2
    for (int channel = 0; channel < 3; ++channel)
        if (sensor.threshold[channel] <= 0.0f)
            unwanted = std::max(unwanted, reading.irradiance[channel]);
    std::vector<SensorBar> bars;
    for (int channel = 0; channel < 3; ++channel)
        if (const float needs = sensor.threshold[channel]; needs > 0.0f)
            bars.push_back({channel, reading.irradiance[channel] / needs, sensor.purity * unwanted / needs});
    return bars;
}

std::string sensor_words(const scene::LightSensor& sensor, const scene::SensorReading& reading) {
    if (reading.open)
        return "open";
    const std::vector<SensorBar> bars = sensor_bars(sensor, reading);
    if (bars.size() == 3) // white light: what it has least of says it all
        return "gets " + percent(reading.share) + " of the light that it needs";
    std::string words;
    bool spoiled = false;
    for (const SensorBar& bar : bars) {
        words += (words.empty() ? "" : ", ") + std::string(names[bar.channel]) + " " + percent(bar.counts());
        spoiled = spoiled || std::min(bar.taken, bar.gets) > worth_saying;
    }
    return words + " of what it needs" + (spoiled ? "\nother colours count against it" : "");
}

} // namespace sunfleck::demo
