#include "gi_module/many_light/pass_optimisation.h"

#include <algorithm>
#include <bit>
#include <iterator>

namespace sunfleck::gi {
namespace {

std::uint32_t count(const LightSet& set) {
    std::uint32_t bits = 0;
    for (const std::uint64_t word : set)
        bits += std::uint32_t(std::popcount(word));
    return bits;
}

} // namespace

std::int64_t PassOptimiser::passes_for(std::uint32_t lights) const {
    const std::uint32_t passes = (lights + lights_per_pass_ - 1) / lights_per_pass_;
    return 2 * std::int64_t(passes + passes % 2);
}

std::int64_t PassOptimiser::passes_of(const LightSet& lights) const {
    return passes_for(count(lights));
}

// Lights that move to the merged element: what one needs and the other needs or tolerates.
std::int64_t PassOptimiser::passes_saved(const PassElement& a, const PassElement& b) const {
    std::uint32_t in_a = 0, in_b = 0, left_a = 0, left_b = 0, shared = 0;
    for (std::size_t i = 0; i < a.lights.size(); ++i) {
        const std::uint64_t both = (a.lights[i] & b.harmless[i]) | (b.lights[i] & a.harmless[i]);
        in_a += std::uint32_t(std::popcount(a.lights[i]));
        in_b += std::uint32_t(std::popcount(b.lights[i]));
        left_a += std::uint32_t(std::popcount(a.lights[i] & ~both));
        left_b += std::uint32_t(std::popcount(b.lights[i] & ~both));
        shared += std::uint32_t(std::popcount(both));
    }
    return passes_for(in_a) + passes_for(in_b) - (passes_for(left_a) + passes_for(left_b) + passes_for(shared));
}

void PassOptimiser::add_element(std::uint32_t object, const PassLights& lights) {
    if (count(lights.needed) > 0)
        elements_.push_back({{object}, lights.needed, lights.harmless});
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
    merged.harmless = merged.lights;
    for (std::size_t i = 0; i < merged.lights.size(); ++i) {
        merged.lights[i] =
            (elements_[a].lights[i] & elements_[b].harmless[i]) | (elements_[b].lights[i] & elements_[a].harmless[i]);
        merged.harmless[i] = elements_[a].harmless[i] & elements_[b].harmless[i];
        elements_[a].lights[i] &= ~merged.lights[i];
        elements_[b].lights[i] &= ~merged.lights[i];
        // Drawn once, such a light is not harmless any more.
        elements_[a].harmless[i] &= ~merged.lights[i];
        elements_[b].harmless[i] &= ~merged.lights[i];
    }
    elements_.push_back(std::move(merged));
    best_.push_back({});
    const std::size_t fresh = elements_.size() - 1;
    // Whoever counted on one of the two looks again, and all look at the new element.
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
    std::erase_if(elements_,
                  [](const PassElement& element) { return element.objects.empty() || count(element.lights) == 0; });
    best_.assign(elements_.size(), {});
}

void PassOptimiser::rebuild() {
    elements_.clear();
    for (const auto& [object, lights] : objects_)
        add_element(object, lights);
    best_.assign(elements_.size(), {});
    for (std::size_t i = 0; i < elements_.size(); ++i)
        for (std::size_t k = i + 1; k < elements_.size(); ++k)
            consider(i, k);
    merge_all();
}

void PassOptimiser::update(const std::map<std::uint32_t, PassLights>& changed) {
    std::map<std::uint32_t, PassLights> different;
    for (const auto& [object, lights] : changed) {
        const auto known = objects_.find(object);
        if (known != objects_.end() ? known->second == lights : count(lights.needed) == 0)
            continue;
        different[object] = lights;
        if (count(lights.needed) == 0)
            objects_.erase(object);
        else
            objects_[object] = lights;
    }
    if (different.empty())
        return;
    if (elements_.empty() || different.size() * 2 > objects_.size())
        return rebuild();
    for (PassElement& element : elements_)
        std::erase_if(element.objects, [&](std::uint32_t object) { return different.contains(object); });
    remove_empty();
    const std::size_t old = elements_.size();
    for (const auto& [object, lights] : different)
        add_element(object, lights);
    best_.assign(elements_.size(), {});
    for (std::size_t i = old; i < elements_.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            consider(i, k);
    merge_all();
}

std::uint64_t PassOptimiser::passes_unoptimised() const {
    std::uint64_t sum = 0;
    for (const auto& [object, lights] : objects_)
        sum += std::uint64_t(passes_of(lights.needed));
    return sum;
}

std::uint64_t PassOptimiser::passes() const {
    std::uint64_t sum = 0;
    for (const PassElement& element : elements_)
        sum += std::uint64_t(passes_of(element.lights));
    return sum;
}

double PassOptimiser::fill() const {
    double drawn = 0, needed = 0;
    for (const PassElement& element : elements_)
        drawn += double(element.objects.size()) * double(count(element.lights));
    for (const auto& [object, lights] : objects_)
        needed += double(count(lights.needed));
    return needed > 0 ? drawn / needed : 1.0;
}

} // namespace sunfleck::gi
