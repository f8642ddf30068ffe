#include "gi_module/many_light/pass_optimisation.h"

#include <algorithm>
#include <bit>
#include <iterator>

namespace sunfleck::gi {

std::int64_t PassOptimiser::passes_saved(const PassElement& a, const PassElement& b) const {
    std::uint32_t in_a = 0, in_b = 0, shared = 0;
    for (std::size_t i = 0; i < a.lights.size(); ++i) {
        in_a += std::uint32_t(std::popcount(a.lights[i]));
        in_b += std::uint32_t(std::popcount(b.lights[i]));
        shared += std::uint32_t(std::popcount(a.lights[i] & b.lights[i]));
    }
    return passes_for(in_a) + passes_for(in_b) -
           (passes_for(in_a - shared) + passes_for(in_b - shared) + passes_for(shared));
}

void PassOptimiser::consider(std::size_t a, std::size_t b) {
    const std::int64_t saved = passes_saved(elements_[a], elements_[b]);
    if (saved > best_[a].saved)
        best_[a] = {saved, b};
    if (saved > best_[b].saved)
        best_[b] = {saved, a};
}

void PassOptimiser::find_best(std::size_t element) {
    best_[element] = {};
    for (std::size_t other = 0; other < elements_.size(); ++other)
        if (other != element) {
            const std::int64_t saved = passes_saved(elements_[element], elements_[other]);
            if (saved > best_[element].saved)
                best_[element] = {saved, other};
        }
}

// Fig. 4-10: the shared lights move to a new element with both elements' objects.
void PassOptimiser::merge(std::size_t a, std::size_t b) {
    PassElement merged;
    std::set_union(elements_[a].objects.begin(), elements_[a].objects.end(), elements_[b].objects.begin(),
                   elements_[b].objects.end(), std::back_inserter(merged.objects));
    merged.lights.resize(elements_[a].lights.size());
    for (std::size_t i = 0; i < merged.lights.size(); ++i) {
        merged.lights[i] = elements_[a].lights[i] & elements_[b].lights[i];
        elements_[a].lights[i] &= ~merged.lights[i];
        elements_[b].lights[i] &= ~merged.lights[i];
    }
    elements_.push_back(std::move(merged));
    best_.push_back({});
    const std::size_t fresh = elements_.size() - 1;
    // Elements whose best partner was one of the two search again, and all consider the new element.
    for (std::size_t i = 0; i < fresh; ++i)
        if (i == a || i == b || (best_[i].saved > 0 && (best_[i].partner == a || best_[i].partner == b)))
            find_best(i);
    for (std::size_t i = 0; i < fresh; ++i)
        consider(i, fresh);
}

void PassOptimiser::merge_all() {
    while (!elements_.empty()) {
        const auto best = std::max_element(best_.begin(), best_.end(),
                                           [](const Best& a, const Best& b) { return a.saved < b.saved; });
        if (best->saved <= 0)
            break;
        merge(std::size_t(best - best_.begin()), best->partner);
    }
    remove_empty();
}

void PassOptimiser::remove_empty() {
    std::erase_if(elements_, [](const PassElement& element) {
        return element.objects.empty() || light_count(element.lights) == 0;
    });
    best_.assign(elements_.size(), {});
}

void PassOptimiser::rebuild() {
    elements_.clear();
    for (const auto& [object, lights] : objects_)
        elements_.push_back({{object}, lights.needed});
    best_.assign(elements_.size(), {});
    for (std::size_t i = 0; i < elements_.size(); ++i)
        for (std::size_t k = i + 1; k < elements_.size(); ++k)
            consider(i, k);
    merge_all();
}

void PassOptimiser::regroup(const std::map<std::uint32_t, PassLights>& changed) {
    for (PassElement& element : elements_)
        std::erase_if(element.objects, [&](std::uint32_t object) { return changed.contains(object); });
    remove_empty();
    const std::size_t old = elements_.size();
    for (const auto& [object, lights] : changed)
        if (light_count(lights.needed) > 0)
            elements_.push_back({{object}, lights.needed});
    best_.assign(elements_.size(), {});
    for (std::size_t i = old; i < elements_.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            consider(i, k);
    merge_all();
}

} // namespace sunfleck::gi
