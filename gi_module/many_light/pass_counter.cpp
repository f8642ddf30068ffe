#include "gi_module/many_light/pass_counter.h"

#include "gi_module/many_light/pass_cover.h"
#include "gi_module/many_light/pass_optimisation.h"
#include "gi_module/many_light/visible_nodes.h"

namespace sunfleck::gi {

void PassCounter::count(const VisibilityDatabase& database, const mat4& view_projection,
                        const ManyLightSettings& settings) {
    if (!passes_ || generation_ != database.generation() || lights_ != settings.lights_per_pass ||
        extras_ != settings.pass_extras) {
        if (settings.pass_extras)
            passes_ = std::make_unique<PassCover>(settings.lights_per_pass);
        else
            passes_ = std::make_unique<PassOptimiser>(settings.lights_per_pass);
        generation_ = database.generation();
        lights_ = settings.lights_per_pass;
        extras_ = settings.pass_extras;
        seen_.clear();
    }
    auto changed = tested_lights_of_visible_nodes(database, view_projection, settings.pass_extras);
    const auto seen = changed;
    for (const auto& [node, lights] : seen_) {
        const LightSet none(lights.needed.size(), 0);
        changed.try_emplace(node, PassLights{none, none});
    }
    passes_->update(changed);
    seen_ = seen;
}

} // namespace sunfleck::gi
