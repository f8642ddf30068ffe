#include "gi_module/many_light/pass_grouping.h"

#include "engine/core/divide_up.h"

#include <bit>

namespace sunfleck::gi {

std::uint32_t light_count(const LightSet& set) {
    std::uint32_t bits = 0;
    for (const std::uint64_t word : set)
        bits += std::uint32_t(std::popcount(word));
    return bits;
}

std::int64_t PassGrouping::passes_for(std::uint32_t lights) const {
    const std::uint32_t passes = divide_up(lights, lights_per_pass_);
    return 2 * std::int64_t(passes + passes % 2);
}

void PassGrouping::update(const std::map<std::uint32_t, PassLights>& changed) {
    std::map<std::uint32_t, PassLights> different;
    for (const auto& [object, lights] : changed) {
        const auto known = objects_.find(object);
        const bool needs_light = light_count(lights.needed) > 0;
        if (known != objects_.end() ? known->second == lights : !needs_light)
            continue;
        different[object] = lights;
        if (needs_light)
            objects_[object] = lights;
        else
            objects_.erase(object);
    }
    if (different.empty())
        return;
    if (elements_.empty() || different.size() * 2 > objects_.size())
        rebuild();
    else
        regroup(different);
}

std::uint64_t PassGrouping::passes_unoptimised() const {
    std::uint64_t sum = 0;
    for (const auto& [object, lights] : objects_)
        sum += std::uint64_t(passes_for(light_count(lights.needed)));
    return sum;
}

std::uint64_t PassGrouping::passes() const {
    std::uint64_t sum = 0;
    for (const PassElement& element : elements_)
        sum += std::uint64_t(passes_for(light_count(element.lights)));
    return sum;
}

double PassGrouping::fill() const {
    double drawn = 0, needed = 0;
    for (const PassElement& element : elements_)
        drawn += double(element.objects.size()) * double(light_count(element.lights));
    for (const auto& [object, lights] : objects_)
        needed += double(light_count(lights.needed));
    return needed > 0 ? drawn / needed : 1.0;
}

} // namespace sunfleck::gi
