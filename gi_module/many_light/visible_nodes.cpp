#include "gi_module/many_light/visible_nodes.h"

#include "engine/core/divide_up.h"

namespace sunfleck::gi {

std::map<std::uint32_t, PassLights> tested_lights_of_visible_nodes(const VisibilityDatabase& database,
                                                                   const mat4& view_projection, bool extras) {
    std::map<std::uint32_t, PassLights> result;
    const auto& patches = database.patches().nodes();
    for (std::uint32_t node = 0; node < database.node_count(); ++node) {
        if (node < patches.size() && (!patches[node].is_leaf() || !may_be_seen(view_projection, patches[node].bounds)))
            continue;
        PassLights lights;
        lights.needed.resize(divide_up(database.sample_count(), 64), 0);
        lights.harmless = lights.needed;
        for (std::uint32_t sample = 0; sample < database.sample_count(); ++sample) {
            const PairState state = database.state(node, sample);
            const std::uint64_t bit = std::uint64_t(1) << (sample % 64);
            if (state == PairState::partial)
                lights.needed[sample / 64] |= bit;
            if (state == PairState::partial || (extras && state != PairState::full))
                lights.harmless[sample / 64] |= bit;
        }
        result[node] = std::move(lights);
    }
    return result;
}

} // namespace sunfleck::gi
