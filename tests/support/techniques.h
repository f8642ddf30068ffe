// Techniques by name, for tests that must not need any of them: each can be left out of the build.
#pragma once

#include "gi_module/technique.h"

#include <algorithm>

namespace sunfleck::tests {

inline bool has_technique(std::string_view name) {
    return std::any_of(gi::techniques().begin(), gi::techniques().end(),
                       [&](const gi::TechniqueEntry& technique) { return technique.name == name; });
}

// Techniques that can light everything, by name; the first is the default.
inline std::vector<std::string_view> techniques_for_all_light() {
    std::vector<std::string_view> names;
    for (const std::string_view name : gi::Settings::find("indirect")->choices)
        if (name != "none")
            names.push_back(name);
    return names;
}

// Every light sample with its shadow map at every pixel, nothing interpolated: by the baseline, or, where that is left
// out, by the default technique without its shortcuts.
inline gi::Settings plain_light() {
    if (has_technique("brute_force"))
        return gi::Settings().all_light_by("brute_force");
    gi::Settings settings = gi::Settings().all_light_by(techniques_for_all_light().front()); // punctual light, too
    settings.low_resolution = 1;
    settings.map_budget = 65536;
    settings.static_maps = settings.map_detail = false;
    for (const char* shortcut : {"visibility", "light_maps", "baked_light"})
        if (gi::Settings::find(shortcut) != nullptr)
            settings.with(shortcut, "off");
    return settings;
}

// Sets it if the technique that has it is there.
inline void set_if_known(gi::Settings& settings, std::string_view name, std::string_view value) {
    if (gi::Settings::find(name) != nullptr)
        settings.with(name, value);
}

} // namespace sunfleck::tests
