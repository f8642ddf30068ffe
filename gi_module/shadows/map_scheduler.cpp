#include "gi_module/shadows/map_scheduler.h"

#include <algorithm>
#include <numeric>

namespace sunfleck::gi {
namespace {

// Of the mean contribution, added to every map: maps that hardly matter are still redrawn from time to time, and not
// all in one frame when they become overdue.
constexpr float min_share = 0.2f;

// Priority is age times this.
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
        weights[i] = by_contribution ? contributions[i] + min_share * sum / float(samples.size())
                                     : std::max({flux.x, flux.y, flux.z});
    }
    return weights;
}

} // namespace

void MapScheduler::reset(std::size_t count) {
    age_.assign(count, 1);
    stale_since_.assign(count, now_.value_or(0.0));
    static_stale_.assign(count, 1);
    undefined_.assign(count, 1);
    pinned_.assign(count, 0);
    lags_.assign(count, 0.0f);
    done_.clear();
}

// What was marked after it was done stays marked.
void MapScheduler::begin_frame(bool previous_lost) {
    if (previous_lost)
        for (const Done& done : done_) {
            age_[done.sample] = std::max(age_[done.sample], done.age);
            static_stale_[done.sample] |= done.static_stale;
            undefined_[done.sample] |= done.undefined;
            lags_[done.sample] += done.lag;
        }
    done_.clear();
}

void MapScheduler::advance(std::optional<double> milliseconds) {
    now_ = milliseconds;
    for (std::uint32_t& age : age_)
        age += age > 0 ? 1 : 0;
}

std::size_t MapScheduler::stale() const {
    return std::size_t(std::count_if(age_.begin(), age_.end(), [](std::uint32_t age) { return age > 0; }));
}

std::size_t MapScheduler::unusable() const {
    return std::size_t(std::count(static_stale_.begin(), static_stale_.end(), std::uint8_t(1)));
}

struct MapScheduler::Rank {
    bool pinned;
    bool unusable; // nothing in the map can be relied on
    bool overdue;
    float weight;

    bool goes_before(const Rank& other) const {
        if (pinned != other.pinned)
            return pinned;
        if (unusable != other.unusable)
            return unusable;
        return overdue != other.overdue ? overdue : weight > other.weight;
    }
};

std::vector<MapScheduler::Rank> MapScheduler::ranks_of(std::span<const std::uint32_t> stale, std::uint32_t budget,
                                                       const std::vector<float>& weights) const {
    const std::uint32_t overdue = 4 * std::uint32_t((stale.size() + budget - 1) / budget);
    std::vector<Rank> ranks;
    for (const std::uint32_t i : stale) {
        const float age = float(age_[i]);
        const bool late = age_[i] >= overdue;
        ranks.push_back({is_pinned(i), is_static_stale(i), late, late ? age : age * weights[i]});
    }
    return ranks;
}

std::vector<float> MapScheduler::priorities(std::span<const LightSample> samples, MapPriority priority,
                                            std::span<const float> contributions) const {
    std::vector<float> result = weights_of(samples, priority, contributions);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] *= float(age_[i]);
    return result;
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
    const std::vector<Rank> ranks = ranks_of(chosen, budget, weights_of(samples, priority, contributions));
    std::vector<std::size_t> order(chosen.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return ranks[a].goes_before(ranks[b]); });
    std::vector<std::uint32_t> first(budget);
    for (std::uint32_t i = 0; i < budget; ++i)
        first[i] = chosen[order[i]];
    std::sort(first.begin(), first.end());
    return first;
}

std::vector<std::uint32_t> MapScheduler::with_late_ones(std::vector<std::uint32_t> chosen,
                                                        std::span<const float> contributions) const {
    constexpr float least_share = 0.001f;
    if (!now_ || contributions.size() != age_.size())
        return chosen;
    const float least = least_share * std::accumulate(contributions.begin(), contributions.end(), 0.0f);
    const std::size_t within_budget = chosen.size();
    for (std::uint32_t i = 0; i < age_.size(); ++i)
        if (age_[i] >= 2 && *now_ - stale_since_[i] >= longest_lag && contributions[i] > least &&
            !std::binary_search(chosen.begin(), chosen.begin() + std::ptrdiff_t(within_budget), i))
            chosen.push_back(i);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

void MapScheduler::done(std::span<const std::uint32_t> samples) {
    for (const std::uint32_t sample : samples) {
        done_.push_back({sample, age_[sample], static_stale_[sample], undefined_[sample], lags_[sample]});
        age_[sample] = 0;
        static_stale_[sample] = 0;
        undefined_[sample] = 0;
        lags_[sample] = 0.0f;
    }
}

std::vector<std::uint32_t> MapScheduler::to_clear(std::span<const std::uint32_t> drawn) const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t sample = 0; sample < undefined_.size(); ++sample)
        if (undefined_[sample] && !std::binary_search(drawn.begin(), drawn.end(), sample))
            result.push_back(sample);
    return result;
}

void MapScheduler::cleared(std::span<const std::uint32_t> samples) {
    for (const std::uint32_t sample : samples) {
        done_.push_back({sample, age_[sample], static_stale_[sample], undefined_[sample], 0.0f});
        undefined_[sample] = 0;
    }
}

} // namespace sunfleck::gi
