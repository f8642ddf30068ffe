#include "viewer/exposure.h"

#include "engine/io/gltf.h"
#include "engine/scene/components.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace sunfleck::viewer {

// Of several, that of the last name: their order in the registry is another once the scene is read from its file.
std::optional<float> scene_exposure(ecs::Registry& registry) {
    std::optional<float> ev100;
    std::string_view last;
    registry.view<scene::Exposure>().each([&](ecs::Entity entity, const scene::Exposure& exposure) {
        const scene::Name* name = registry.try_get<scene::Name>(entity);
        const std::string_view text = name != nullptr ? std::string_view(name->name) : std::string_view();
        if (ev100 && text < last)
            return;
        ev100 = exposure.ev100;
        last = text;
    });
    return ev100;
}

float automatic_exposure(const io::Picture& picture, bool irradiance) {
    std::vector<float> logarithms;
    for (const vec4& pixel : picture.pixels)
        if (const float light = luminance(vec3(pixel)); light > 0.0f && std::isfinite(light))
            logarithms.push_back(std::log2(light));
    if (logarithms.empty())
        return default_exposure;
    std::sort(logarithms.begin(), logarithms.end());
    const std::size_t tenth = logarithms.size() / 10;
    double sum = 0.0;
    for (std::size_t i = tenth; i < logarithms.size() - tenth; ++i)
        sum += double(logarithms[i]);
    const float mean = float(sum / double(logarithms.size() - 2 * tenth)) - (irradiance ? std::log2(pi) : 0.0f);
    constexpr float sensitivity_over_constant = 100.0f / 12.5f; // m2/(cd s)
    return std::clamp(mean + std::log2(io::luminous_efficacy * sensitivity_over_constant), lowest_exposure,
                      highest_exposure);
}

} // namespace sunfleck::viewer
