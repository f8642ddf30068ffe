#include "gi_module/visibility/view_bounds.h"

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

} // namespace sunfleck::gi
