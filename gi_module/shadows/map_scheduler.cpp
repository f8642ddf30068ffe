#include "gi_module/shadows/map_scheduler.h"

#include <algorithm>
#include <numeric>

namespace sunfleck::gi {
namespace {

// Of the mean contribution, added to each: maps that hardly matter are redrawn now and then all the same, and not all
// in one frame when they are overdue.
constexpr float least_share = 0.2f;

// What decides beside age.
std::vector<float> weights_of(std::span<const LightSample> samples, MapPriority priority,
                              std::span<const float> contributions) {
    std::vector<float> weights(samples.size(), 1.0f);
    if (priority == MapPriority::age)
        return weights;
    const float sum = std::accumulate(contributions.begin(), contributions.end(), 0.0f);
    const bool by_contribution =
        priority == MapPriority::contribution && contributions.size() == samples.size() && sum > 0.0f;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const vec3 flux = samples[i].flux;
        weights[i] = by_contribution ? contributions[i] + least_share * sum / float(samples.size())
                                     : std::max({flux.x, flux.y, flux.z});
    }
    return weights;
}

} // namespace

void MapScheduler::reset(std::size_t count) {
    age_.assign(count, 1);
    static_stale_.assign(count, 1);
    lags_.assign(count, 0.0f);
}

void MapScheduler::advance() {
    for (std::uint32_t& age : age_)
        age += age > 0 ? 1 : 0;
}

std::size_t MapScheduler::stale() const {
    return std::size_t(std::count_if(age_.begin(), age_.end(), [](std::uint32_t age) { return age > 0; }));
}

std::size_t MapScheduler::unusable() const {
    return std::size_t(std::count(static_stale_.begin(), static_stale_.end(), std::uint8_t(1)));
}

std::vector<std::uint32_t> MapScheduler::choose(std::span<const LightSample> samples, MapPriority priority,
                                                std::uint32_t budget, std::span<const float> contributions) const {
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < age_.size(); ++i)
        if (age_[i] > 0)
            chosen.push_back(i);
    if (chosen.size() <= budget)
        return chosen;
    if (budget == 0)
        return {};
    const std::uint32_t overdue = 4 * std::uint32_t((chosen.size() + budget - 1) / budget);
    const std::vector<float> weights = weights_of(samples, priority, contributions);
    struct Rank {
        bool unusable; // nothing that the map shows is true
        bool overdue;
        float weight;
    };
    const auto rank = [&](std::uint32_t i) -> Rank {
        const float age = float(age_[i]);
        const bool late = age_[i] >= overdue;
        return {is_static_stale(i), late, late ? age : age * weights[i]};
    };
    std::stable_sort(chosen.begin(), chosen.end(), [&](std::uint32_t a, std::uint32_t b) {
        const Rank ra = rank(a), rb = rank(b);
        if (ra.unusable != rb.unusable)
            return ra.unusable;
        return ra.overdue != rb.overdue ? ra.overdue : ra.weight > rb.weight;
    });
    chosen.resize(budget);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

void MapScheduler::done(std::span<const std::uint32_t> samples) {
    for (const std::uint32_t sample : samples) {
        age_[sample] = 0;
        static_stale_[sample] = 0;
        lags_[sample] = 0.0f;
    }
}

} // namespace sunfleck::gi
