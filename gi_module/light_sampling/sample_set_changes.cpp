// What a SampleSet puts off: new samples, and changes of strength.
#include "gi_module/light_sampling/sample_set.h"

#include <cstring>

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

// Samples that changed nothing but their strength keep the one before once the budget is spent. They come first in the
// next frame, so that lamps that change all the time let nobody starve.
void SampleSet::limit_changes(const std::vector<shared::LightRow>& before, std::uint32_t budget) {
    std::uint32_t changes = 0, first_late = next_change_;
    for (std::uint32_t k = 0; k < size(); ++k) {
        const std::uint32_t i = (next_change_ + k) % size();
        shared::LightRow& row = rows_[i];
        shared::LightRow late = row;
        late.intensity_slot = vec4(vec3(before[i].intensity_slot), row.intensity_slot.w);
        const bool strength_alone =
            std::memcmp(&late, &before[i], sizeof late) == 0 && vec3(row.intensity_slot) != vec3(late.intensity_slot);
        if (!strength_alone || changes++ < budget)
            continue;
        first_late = late_changes_++ == 0 ? i : first_late;
        row = late;
    }
    next_change_ = first_late;
}

} // namespace sunfleck::gi
