// What a SampleSet puts off: new samples, and changes of strength.
#include "gi_module/light_sampling/sample_set.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace sunfleck::gi {

// The emitters that samples were made for, in that order, as they are now; what is gone gives no light. They are looked
// for again in every frame, until they fit or samples are made.
void SampleSet::keep_emitters(const std::vector<Emitter>& fixed, const std::vector<Emitter>& dynamic) {
    const auto now = [&](const Emitter& known) -> const Emitter* {
        for (const auto* present : {&dynamic_emitters_, &emitters_})
            for (const Emitter& emitter : *present)
                if (emitter.entity == known.entity && emitter.kind == known.kind && emitter.punctual == known.punctual)
                    return &emitter;
        return nullptr;
    };
    std::vector<Emitter> followed = dynamic;
    for (Emitter& emitter : followed)
        if (const Emitter* present = now(emitter))
            emitter = *present;
        else
            emitter.flux = vec3(0.0f);
    dynamic_emitters_ = std::move(followed);
    emitters_ = fixed;
    emitter_cursor_ = {};
}

// Samples that changed nothing but their strength keep the one before once the budget is spent. The nearest come first:
// they show most, and as they light the same surfaces, less has to be baked again in a frame. Those that have waited
// for so long that all could have had their turn go before them, so that lamps that change all the time let nobody
// starve.
void SampleSet::limit_changes(const std::vector<shared::LightRow>& before, const Strengths& strengths) {
    struct Change {
        bool overdue;
        float distance;
        std::uint32_t sample;
    };
    std::vector<Change> changes;
    waited_.resize(size(), 0);
    const std::uint32_t longest = size() / std::max(strengths.change_budget, 1u);
    for (std::uint32_t i = 0; i < size(); ++i) {
        shared::LightRow late = rows_[i];
        late.intensity_slot = vec4(vec3(before[i].intensity_slot), rows_[i].intensity_slot.w);
        if (std::memcmp(&late, &before[i], sizeof late) != 0 ||
            vec3(rows_[i].intensity_slot) == vec3(late.intensity_slot))
            waited_[i] = 0;
        else
            changes.push_back(
                {waited_[i] > longest, strengths.eye ? glm::distance(*strengths.eye, samples_[i].position) : 0.0f, i});
    }
    std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
        return std::pair(!a.overdue, a.distance) < std::pair(!b.overdue, b.distance);
    });
    for (std::size_t k = 0; k < changes.size(); ++k) {
        const std::uint32_t i = changes[k].sample;
        const bool late = k >= strengths.change_budget;
        waited_[i] = late ? waited_[i] + 1 : 0;
        late_changes_ += late ? 1 : 0;
        if (late)
            rows_[i].intensity_slot = vec4(vec3(before[i].intensity_slot), rows_[i].intensity_slot.w);
    }
}

} // namespace sunfleck::gi
