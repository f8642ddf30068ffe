#include "gi_module/many_light/pass_cover.h"

#include <algorithm>
#include <bit>

namespace sunfleck::gi {
namespace {

// How much worse the maintained cover may get before everything is grouped from scratch.
constexpr double max_decay = 1.15;

std::uint32_t shared_count(const LightSet& a, const LightSet& b) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        bits += std::uint32_t(std::popcount(a[i] & b[i]));
    return bits;
}

bool contains(const LightSet& set, const LightSet& part) {
    for (std::size_t i = 0; i < set.size(); ++i)
        if ((part[i] & ~set[i]) != 0)
            return false;
    return true;
}

template <typename Function>
void for_each_light(std::uint64_t word, std::size_t i, Function function) {
    for (; word != 0; word &= word - 1)
        function(i * 64 + std::size_t(std::countr_zero(word)));
}

} // namespace

PassCover::Open PassCover::open(std::uint32_t object) const {
    const PassLights& lights = objects_.at(object);
    return {object, lights.needed, lights.harmless};
}

// With lights that the object tolerates. Needed lights must be drawn exactly once; harmless ones stay tolerated.
void PassCover::draw(Open& object, const LightSet& lights) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
        object.tolerated[i] &= ~(object.left[i] & lights[i]);
        object.left[i] &= ~lights[i];
    }
}

// Pairs that a draft covers with one more object, if its lights are chosen again: the largest counts of those allowed.
std::uint32_t PassCover::covered_with(const Draft& draft, const Open& object) const {
    histogram_.assign(draft.members.size() + 2, 0);
    for (std::size_t i = 0; i < draft.allowed.size(); ++i) {
        const std::uint64_t allowed = draft.allowed[i] & object.tolerated[i] & (draft.needed[i] | object.left[i]);
        for_each_light(allowed & object.left[i], i, [&](std::size_t light) { ++histogram_[draft.counts[light] + 1]; });
        for_each_light(allowed & ~object.left[i], i, [&](std::size_t light) { ++histogram_[draft.counts[light]]; });
    }
    std::uint32_t covered = 0, places = room();
    for (std::size_t count = histogram_.size() - 1; count > 0 && places > 0; --count) {
        const std::uint32_t taken = std::min(histogram_[count], places);
        covered += taken * std::uint32_t(count);
        places -= taken;
    }
    return covered;
}

// The open object that adds most pairs, at least `min_gain_`. An upper bound is the number of its remaining lights that
// are allowed, or the room in a pass; candidates are tried in the order of this bound, so few have to be.
std::optional<std::size_t> PassCover::best_addition(const Draft& draft, const std::vector<Open>& open_objects,
                                                    const std::vector<char>& is_member) {
    candidates_.clear();
    for (std::size_t i = 0; i < open_objects.size(); ++i) {
        if (is_member[i] != 0)
            continue;
        const std::uint32_t bound = std::min(shared_count(open_objects[i].left, draft.allowed), room());
        if (bound >= min_gain_)
            candidates_.push_back({i, bound});
    }
    std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
        return a.bound != b.bound ? a.bound > b.bound : a.member < b.member;
    });
    std::optional<std::size_t> best;
    std::uint32_t most = draft.covered + min_gain_ - 1;
    for (const Candidate& candidate : candidates_) {
        if (draft.covered + candidate.bound <= most)
            break;
        const std::uint32_t covered = covered_with(draft, open_objects[candidate.member]);
        if (covered > most) {
            most = covered;
            best = candidate.member;
        }
    }
    return best;
}

void PassCover::add(Draft& draft, const std::vector<Open>& open_objects, std::size_t member) const {
    const Open& object = open_objects[member];
    draft.covered = covered_with(draft, object);
    draft.members.push_back(member);
    for (std::size_t i = 0; i < draft.allowed.size(); ++i) {
        draft.allowed[i] &= object.tolerated[i];
        draft.needed[i] |= object.left[i];
        for_each_light(object.left[i], i, [&](std::size_t light) { ++draft.counts[light]; });
    }
}

// As many as there is room for; ties go to the first.
LightSet PassCover::best_lights(const Draft& draft) const {
    std::vector<std::size_t> lights;
    for (std::size_t i = 0; i < draft.allowed.size(); ++i)
        for_each_light(draft.allowed[i] & draft.needed[i], i, [&](std::size_t light) { lights.push_back(light); });
    std::stable_sort(lights.begin(), lights.end(),
                     [&](std::size_t a, std::size_t b) { return draft.counts[a] > draft.counts[b]; });
    lights.resize(std::min(lights.size(), std::size_t(room())));
    LightSet set(draft.allowed.size(), 0);
    for (const std::size_t light : lights)
        set[light / 64] |= std::uint64_t(1) << (light % 64);
    return set;
}

void PassCover::cover(std::vector<Open>& open_objects) {
    const auto is_done = [](const Open& object) { return light_count(object.left) == 0; };
    for (;;) {
        std::erase_if(open_objects, is_done);
        if (open_objects.empty())
            return;
        const auto most = std::max_element(open_objects.begin(), open_objects.end(), [](const Open& a, const Open& b) {
            return light_count(a.left) < light_count(b.left);
        });
        Draft draft;
        draft.allowed.assign(most->left.size(), ~std::uint64_t(0));
        draft.needed.assign(most->left.size(), 0);
        draft.counts.assign(most->left.size() * 64, 0);
        std::vector<char> is_member(open_objects.size(), 0);
        for (std::optional<std::size_t> next = std::size_t(most - open_objects.begin()); next;
             next = best_addition(draft, open_objects, is_member)) {
            add(draft, open_objects, *next);
            is_member[*next] = 1;
        }
        PassElement element{{}, best_lights(draft)};
        for (const std::size_t member : draft.members) {
            Open& object = open_objects[member];
            if (shared_count(object.left, element.lights) == 0)
                continue;
            element.objects.push_back(object.object);
            draw(object, element.lights);
        }
        std::sort(element.objects.begin(), element.objects.end());
        elements_.push_back(std::move(element));
    }
}

void PassCover::rebuild() {
    elements_.clear();
    std::vector<Open> open_objects;
    for (const auto& [object, lights] : objects_)
        open_objects.push_back(open(object));
    cover(open_objects);
    ratio_when_rebuilt_ = objects_.empty() ? 1.0 : double(passes()) / double(passes_unoptimised());
}

// An object joins elements whose lights it tolerates, those that draw most of what it needs first: that costs no pass.
void PassCover::join_elements(Open& object) {
    for (;;) {
        PassElement* best = nullptr;
        std::uint32_t most = min_gain_ - 1;
        for (PassElement& element : elements_) {
            const std::uint32_t gain = shared_count(object.left, element.lights);
            if (gain > most && contains(object.tolerated, element.lights)) {
                most = gain;
                best = &element;
            }
        }
        if (best == nullptr)
            return;
        best->objects.insert(std::lower_bound(best->objects.begin(), best->objects.end(), object.object),
                             object.object);
        draw(object, best->lights);
    }
}

void PassCover::regroup(const std::map<std::uint32_t, PassLights>& changed) {
    for (PassElement& element : elements_) {
        const std::size_t erased =
            std::erase_if(element.objects, [&](std::uint32_t object) { return changed.contains(object); });
        if (erased == 0)
            continue;
        // Lights that no other object needs are removed.
        LightSet wanted(element.lights.size(), 0);
        for (const std::uint32_t object : element.objects)
            for (std::size_t i = 0; i < wanted.size(); ++i)
                wanted[i] |= objects_.at(object).needed[i] & element.lights[i];
        element.lights = std::move(wanted);
    }
    std::erase_if(elements_, [](const PassElement& element) { return light_count(element.lights) == 0; });
    std::vector<Open> open_objects;
    for (const auto& [object, lights] : changed)
        if (objects_.contains(object)) {
            open_objects.push_back(open(object));
            join_elements(open_objects.back());
        }
    cover(open_objects);
    if (double(passes()) > max_decay * ratio_when_rebuilt_ * double(passes_unoptimised()))
        rebuild();
}

} // namespace sunfleck::gi
