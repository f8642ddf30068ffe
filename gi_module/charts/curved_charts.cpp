#include "gi_module/charts/curved_charts.h"

#include "engine/core/octahedral.h"
#include "gi_module/transport/flat_shading_shared.h"

#include <algorithm>
#include <array>
#include <limits>

namespace sunfleck::gi {
namespace {

// On small objects light varies within their size, on thin ones within their thickness: so many texels along and across
// them, but no finer than this fraction of the texels of large surfaces.
constexpr float texels_along = 32.0f, texels_across = 16.0f, finest_share = 0.125f;
constexpr std::uint32_t max_columns = 256;
constexpr float outside = 1.5f;          // texels: texels so far beyond a surface's rim get its nearest point
constexpr float same_layer = 0.1f;       // texels: height differences of adjacent triangles are less
constexpr int margin = 1;                // texels around a chart
constexpr float min_height_range = 8.0f; // texels: so that nearly flat charts still distinguish steps from slopes

struct Triangle {
    std::array<vec3, 3> corners, normals; // world space; normals of any length
    vec3 geometric{0.0f};                 // unit
};

// The part of an instance's mesh that has no light maps.
struct CurvedMesh {
    ecs::Entity entity;
    std::vector<Triangle> triangles;
};

bool has_normal_map(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* textures = registry.try_get<scene::MaterialTextures>(entity);
    return textures != nullptr && textures->normal;
}

bool is_flat_shaded(const Triangle& triangle) {
    return std::all_of(triangle.normals.begin(), triangle.normals.end(), [&](const vec3& normal) {
        const vec3 bend = glm::normalize(normal) - triangle.geometric;
        return glm::dot(bend, bend) < shared::flat_shaded_limit;
    });
}

CurvedMesh curved_part(ecs::Entity entity, const scene::Mesh& mesh, const mat4& matrix, const SurfacePatches& patches) {
    CurvedMesh part;
    part.entity = entity;
    const mat3 to_world = normal_matrix(matrix); // as the G-buffer has it
    const float side = glm::determinant(mat3(matrix)) < 0.0f ? -1.0f : 1.0f;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        Triangle triangle;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = mesh.indices[t * 3 + k];
            triangle.corners[k] = vec3(matrix * vec4(mesh.positions[vertex], 1.0f));
            triangle.normals[k] = to_world * mesh.normals[vertex];
        }
        const vec3 cross =
            side * glm::cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]);
        const float length = glm::length(cross);
        if (!(length > 1e-12f))
            continue;
        triangle.geometric = cross / length;
        const vec3 centre = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0f;
        const std::uint32_t node = patches.node_at(entity, centre, triangle.geometric);
        if (node == shared::no_node || (patches.nodes()[node].planar && is_flat_shaded(triangle)))
            continue;
        part.triangles.push_back(triangle);
    }
    return part;
}

// The grid of a chart, as large as its triangles, before points are found.
struct Grid {
    std::vector<std::uint32_t> triangles; // of the mesh, front faces; of open meshes (sheets) also back faces
    std::uint32_t direction = 0;
    vec3 low{std::numeric_limits<float>::max()},
        high{-std::numeric_limits<float>::max()}; // chart coordinates of the corners
    vec3 origin{0.0f};                            // chart coordinates of texel (0, 0)
    float texel = 0.0f;                           // m
    std::uint32_t columns = 0, rows = 0;
};

Grid find_facing(const CurvedMesh& mesh, bool closed, std::uint32_t direction) {
    Grid grid;
    grid.direction = direction;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const float cosine = shared::curved_place(direction, mesh.triangles[i].geometric).z;
        if ((closed ? cosine : std::abs(cosine)) <= shared::curved_min_cosine)
            continue;
        grid.triangles.push_back(i);
        for (const vec3& corner : mesh.triangles[i].corners) {
            grid.low = glm::min(grid.low, shared::curved_place(direction, corner));
            grid.high = glm::max(grid.high, shared::curved_place(direction, corner));
        }
    }
    return grid;
}

void lay_out(Grid& grid, float texel_side) {
    if (grid.triangles.empty())
        return;
    const vec2 extent(grid.high - grid.low);
    const float longer = std::max(extent.x, extent.y), shorter = std::min(extent.x, extent.y);
    const float texel =
        std::clamp(std::min(longer / texels_along, shorter / texels_across), finest_share * texel_side, texel_side);
    grid.texel = std::max(texel, longer / float(max_columns - 2 * margin - 2));
    const auto texels = [&](float side) { return std::uint32_t(std::ceil(side / grid.texel)) + 1 + 2 * margin; };
    grid.columns = texels(extent.x);
    grid.rows = texels(extent.y);
    const vec2 room = vec2(grid.columns - 1, grid.rows - 1) * grid.texel - extent;
    grid.origin = vec3(vec2(grid.low) - 0.5f * room, grid.low.z);
}

// A point on a triangle that a texel may use.
struct Candidate {
    float distance = std::numeric_limits<float>::max(); // texels from the texel to the triangle's projection; 0: within
    float height = 0.0f;                                // m
    std::uint32_t triangle = 0;
    vec3 weights{0.0f}; // barycentric

    bool better_than(const Candidate& other) const {
        return distance == 0.0f && other.distance == 0.0f ? height > other.height : distance < other.distance;
    }
};

// The nearest point of a 2D triangle, as barycentric weights.
vec3 nearest_weights(const std::array<vec2, 3>& corners, vec2 point) {
    vec3 best(1.0f, 0.0f, 0.0f);
    float least = std::numeric_limits<float>::max();
    for (int k = 0; k < 3; ++k) {
        const vec2 from = corners[std::size_t(k)], along = corners[std::size_t((k + 1) % 3)] - from;
        const float t =
            std::clamp(glm::dot(point - from, along) / std::max(glm::dot(along, along), 1e-12f), 0.0f, 1.0f);
        const vec2 off = from + t * along - point;
        if (glm::dot(off, off) >= least)
            continue;
        least = glm::dot(off, off);
        best = vec3(0.0f);
        best[k] = 1.0f - t;
        best[(k + 1) % 3] = t;
    }
    return best;
}

// Calls visit(texel, candidate) for the texels in or near a triangle's projection.
template <typename Visit>
void visit_texels(const CurvedMesh& mesh, const Grid& grid, std::uint32_t number, const Visit& visit) {
    const Triangle& triangle = mesh.triangles[number];
    std::array<vec2, 3> corners;
    vec3 heights;
    vec2 low(1e30f), high(-1e30f);
    for (std::size_t k = 0; k < 3; ++k) {
        const vec3 place = shared::curved_place(grid.direction, triangle.corners[k]);
        corners[k] = (vec2(place) - vec2(grid.origin)) / grid.texel;
        heights[int(k)] = place.z;
        low = glm::min(low, corners[k]);
        high = glm::max(high, corners[k]);
    }
    const vec2 a = corners[1] - corners[0], b = corners[2] - corners[0];
    const float area = a.x * b.y - a.y * b.x;
    if (!(std::abs(area) > 1e-12f))
        return;
    const glm::ivec2 first = glm::max(glm::ivec2(glm::ceil(low - outside)), glm::ivec2(0));
    const glm::ivec2 last =
        glm::min(glm::ivec2(glm::floor(high + outside)), glm::ivec2(int(grid.columns) - 1, int(grid.rows) - 1));
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
            const vec2 point = vec2(x, y), off = point - corners[0];
            const float v = (off.x * b.y - off.y * b.x) / area, w = (a.x * off.y - a.y * off.x) / area;
            Candidate candidate{0.0f, 0.0f, number, vec3(1.0f - v - w, v, w)};
            if (std::min({v, w, 1.0f - v - w}) < -1e-5f) {
                candidate.weights = nearest_weights(corners, point);
                vec2 nearest(0.0f);
                for (std::size_t k = 0; k < 3; ++k)
                    nearest += candidate.weights[int(k)] * corners[k];
                candidate.distance = std::max(glm::length(nearest - point), 1e-6f);
                if (candidate.distance > outside)
                    continue;
            }
            candidate.height = glm::dot(candidate.weights, heights);
            visit(std::uint32_t(y) * grid.columns + std::uint32_t(x), candidate);
        }
}

shared::CurvedPoint point_of(const Triangle& triangle, std::uint32_t direction, const Candidate& candidate) {
    shared::CurvedPoint point{};
    const bool behind = shared::curved_place(direction, triangle.geometric).z < 0.0f;
    const vec3 geometric = behind ? -triangle.geometric : triangle.geometric;
    vec3 position(0.0f), normal(0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
        position += candidate.weights[int(k)] * triangle.corners[k];
        normal += candidate.weights[int(k)] * triangle.normals[k];
    }
    if (!(glm::dot(normal, normal) > 0.0f))
        normal = geometric;
    point.position = vec4(position, 1.0f);
    point.normal = shared::pack_normal(glm::dot(normal, geometric) < 0.0f ? -normal : normal);
    point.geometric_normal = shared::pack_normal(geometric);
    point.exists = 1;
    return point;
}

// Each texel's point on the outermost surface; none where another surface is so close below that pixels could not tell
// which of the two the texel belongs to.
std::vector<shared::CurvedPoint> find_points(const CurvedMesh& mesh, const Grid& grid) {
    std::vector<Candidate> best(std::size_t(grid.columns) * grid.rows);
    for (const std::uint32_t triangle : grid.triangles)
        visit_texels(mesh, grid, triangle, [&](std::uint32_t texel, const Candidate& candidate) {
            if (candidate.better_than(best[texel]))
                best[texel] = candidate;
        });
    std::vector<std::uint8_t> ambiguous(best.size(), 0);
    for (const std::uint32_t triangle : grid.triangles)
        visit_texels(mesh, grid, triangle, [&](std::uint32_t texel, const Candidate& candidate) {
            const float below = (best[texel].height - candidate.height) / grid.texel;
            if (candidate.distance == 0.0f && below > same_layer && below < shared::curved_cell_span)
                ambiguous[texel] = 1;
        });
    std::vector<shared::CurvedPoint> points(best.size());
    for (std::size_t i = 0; i < best.size(); ++i)
        if (best[i].distance <= outside && !ambiguous[i])
            points[i] = point_of(mesh.triangles[best[i].triangle], grid.direction, best[i]);
    return points;
}

std::vector<CurvedMesh> curved_parts(ecs::Registry& registry, const scene::MeshStore& meshes,
                                     const SurfacePatches& patches) {
    std::vector<CurvedMesh> parts;
    registry.view<scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
            if (patches.instance(entity) == nullptr || has_normal_map(registry, entity))
                return;
            const mat4 matrix = patches.space().place(world.matrix);
            parts.push_back(curved_part(entity, meshes[instance.mesh], matrix, patches));
        });
    std::erase_if(parts, [](const CurvedMesh& part) { return part.triangles.empty(); });
    return parts;
}

using Grids = std::array<Grid, shared::curved_directions>;

// One set of grids per part, with texels so large that there are at most `max_points`.
std::vector<Grids> make_grids(const std::vector<CurvedMesh>& parts, const SurfacePatches& patches, float texel_side,
                              std::uint64_t max_points) {
    std::vector<Grids> grids(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (std::uint32_t direction = 0; direction < shared::curved_directions; ++direction)
            grids[i][direction] = find_facing(parts[i], patches.is_closed(parts[i].entity), direction);
    std::uint64_t total = 0;
    do {
        total = 0;
        for (Grids& of_part : grids)
            for (Grid& grid : of_part) {
                lay_out(grid, texel_side);
                total += std::uint64_t(grid.columns) * grid.rows;
            }
        texel_side *= 1.25f;
    } while (total > max_points && texel_side < 1e3f);
    return grids;
}

CurvedChart chart_of(const Grid& grid, std::size_t surface, std::size_t first_point) {
    CurvedChart chart;
    chart.surface = std::uint32_t(surface);
    chart.direction = grid.direction;
    chart.first_point = std::uint32_t(first_point);
    chart.columns = grid.columns;
    chart.rows = grid.rows;
    if (grid.columns > 0) {
        chart.row.place = vec4(grid.origin, 1.0f / grid.texel);
        const float range = std::max(grid.high.z - grid.low.z, min_height_range * grid.texel);
        chart.row.size = vec4(grid.columns, grid.rows, chart.first_point, shared::curved_max_height / range);
    }
    return chart;
}

} // namespace

void CurvedCharts::build(ecs::Registry& registry, const scene::MeshStore& meshes, const SurfacePatches& patches,
                         float texel_side, std::uint64_t max_points) {
    *this = {};
    const std::vector<CurvedMesh> parts = curved_parts(registry, meshes, patches);
    const std::vector<Grids> grids = make_grids(parts, patches, texel_side, max_points);
    std::unordered_map<ecs::Entity, std::vector<std::uint32_t>> leaves;
    for (std::uint32_t node = 0; node < patches.nodes().size(); ++node)
        if (patches.nodes()[node].is_leaf())
            leaves[patches.nodes()[node].entity].push_back(node);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        nodes_.push_back(leaves[parts[i].entity]);
        first_chart_[parts[i].entity] = std::uint32_t(charts_.size());
        for (const Grid& grid : grids[i]) {
            charts_.push_back(chart_of(grid, i, points_.size()));
            if (grid.columns == 0)
                continue;
            const std::vector<shared::CurvedPoint> points = find_points(parts[i], grid);
            points_.insert(points_.end(), points.begin(), points.end());
        }
    }
}

std::uint32_t CurvedCharts::first_chart(ecs::Entity entity) const {
    const auto found = first_chart_.find(entity);
    return found == first_chart_.end() ? shared::no_node : found->second;
}

} // namespace sunfleck::gi
