#include "gi_module/adaptive_shadows/receiver_cells.h"

#include <algorithm>
#include <array>
#include <map>

namespace sunfleck::gi {
namespace {

constexpr float cells_along_side = 48.0f;

using Triangle = std::array<vec3, 3>;
using Cell = std::array<std::int32_t, 3>;

struct Grid {
    vec3 origin{0.0f};
    float cell = 1.0f;
    std::map<Cell, Bounds> boxes;

    void add(const Triangle& part) {
        const vec3 place = ((part[0] + part[1] + part[2]) / 3.0f - origin) / cell;
        Bounds& box = boxes[{std::int32_t(place.x), std::int32_t(place.y), std::int32_t(place.z)}];
        for (const vec3 corner : part)
            box.add(corner);
    }
};

// Halves the longest edge until no part is longer than a cell.
void add_in_parts(const Triangle& triangle, Grid& grid) {
    std::vector<Triangle> open = {triangle};
    while (!open.empty()) {
        const Triangle part = open.back();
        open.pop_back();
        std::size_t longest = 0;
        float length = 0.0f;
        for (std::size_t i = 0; i < 3; ++i)
            if (const float edge = glm::length(part[(i + 1) % 3] - part[i]); edge > length) {
                length = edge;
                longest = i;
            }
        if (!(length > grid.cell)) {
            grid.add(part);
            continue;
        }
        const std::size_t next = (longest + 1) % 3;
        const vec3 middle = 0.5f * (part[longest] + part[next]);
        Triangle halves[2] = {part, part};
        halves[0][next] = middle;
        halves[1][longest] = middle;
        open.insert(open.end(), {halves[0], halves[1]});
    }
}

} // namespace

std::vector<Bounds> receiver_cells(const scene::SceneChanges& changes, const scene::MeshStore& meshes) {
    Bounds bounds;
    for (const scene::Drawable* drawable : changes.all)
        if (drawable->is_static)
            bounds.add(drawable->bounds);
    const vec3 extent = bounds.extent();
    const float side = std::max({extent.x, extent.y, extent.z});
    if (bounds.empty() || !(side > 0.0f))
        return {};
    Grid grid{bounds.minimum, side / cells_along_side, {}};
    for (const scene::Drawable* drawable : changes.all) {
        if (!drawable->is_static)
            continue;
        const scene::Mesh& mesh = meshes[drawable->mesh];
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            Triangle triangle;
            for (std::size_t k = 0; k < 3; ++k)
                triangle[k] = vec3(drawable->matrix * vec4(mesh.positions[mesh.indices[i + k]], 1.0f));
            add_in_parts(triangle, grid);
        }
    }
    std::vector<Bounds> cells;
    cells.reserve(grid.boxes.size());
    for (const auto& [place, box] : grid.boxes)
        cells.push_back(box);
    return cells;
}

} // namespace sunfleck::gi
