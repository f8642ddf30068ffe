#include "gi_module/many_light/visible_nodes.h"

namespace sunfleck::gi {

bool may_be_seen(const mat4& view_projection, const Bounds& bounds) {
    bool outside[5] = {true, true, true, true, true};
    for (int i = 0; i < 8; ++i) {
        const vec4 corner(i & 1 ? bounds.maximum.x : bounds.minimum.x, i & 2 ? bounds.maximum.y : bounds.minimum.y,
                          i & 4 ? bounds.maximum.z : bounds.minimum.z, 1.0f);
        const vec4 clip = view_projection * corner;
        outside[0] = outside[0] && clip.x < -clip.w;
        outside[1] = outside[1] && clip.x > clip.w;
        outside[2] = outside[2] && clip.y < -clip.w;
        outside[3] = outside[3] && clip.y > clip.w;
        outside[4] = outside[4] && clip.w <= 0.0f;
    }
    return !(outside[0] || outside[1] || outside[2] || outside[3] || outside[4]);
}

std::map<std::uint32_t, PassLights> tested_lights_of_visible_nodes(const VisibilityDatabase& database,
                                                                   const mat4& view_projection, bool extras) {
    std::map<std::uint32_t, PassLights> result;
    const auto& patches = database.patches().nodes();
    for (std::uint32_t node = 0; node < database.node_count(); ++node) {
        if (node < patches.size() && (!patches[node].is_leaf() || !may_be_seen(view_projection, patches[node].bounds)))
            continue;
        PassLights lights;
        lights.needed.resize((database.sample_count() + 63) / 64, 0);
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
