#include "editor/window/heat_map.h"

#include <algorithm>
#include <iterator>

namespace sunfleck::editor {

vec3 heat_colour(float share) {
    static const vec3 colours[] = {{0.0f, 0.0f, 0.0f},    {0.15f, 0.08f, 0.42f}, {0.55f, 0.13f, 0.50f},
                                   {0.90f, 0.31f, 0.25f}, {0.99f, 0.66f, 0.16f}, {1.0f, 1.0f, 0.75f}};
    const float place = std::clamp(share, 0.0f, 1.0f) * float(std::size(colours) - 1);
    const std::size_t below = std::min(std::size_t(place), std::size(colours) - 2);
    return glm::mix(colours[below], colours[below + 1], place - float(below));
}

io::Picture heat_picture(const io::Picture& a, const io::Picture& b) {
    io::Picture result = a;
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
        const bool counts = a.pixels[i].a != 0.0f && b.pixels[i].a != 0.0f;
        const vec3 error = glm::abs(vec3(a.pixels[i]) - vec3(b.pixels[i]));
        result.pixels[i] = vec4(heat_colour(counts ? std::max({error.x, error.y, error.z}) / heat_end : 0.0f), 1.0f);
    }
    return result;
}

} // namespace sunfleck::editor
