// Charts of curved surfaces: what a point of a mesh finds in them must be near that point.
#include "engine/core/octahedral.h"
#include "engine/scene/components.h"
#include "engine/scene/procedural.h"
#include "gi_module/charts/curved_charts.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <optional>
#include <random>

namespace sunfleck::tests {
namespace {

struct Place {
    vec3 position, geometric, shading;
};

// A point of one of the mesh's triangles, by area, as its front shows it.
class Points {
public:
    Points(const scene::Mesh& mesh, const mat4& matrix) : mesh_(mesh), matrix_(matrix) {
        std::vector<float> areas;
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
            areas.push_back(glm::length(glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0))));
        triangle_ = std::discrete_distribution<std::size_t>(areas.begin(), areas.end());
    }
    Place operator()(std::mt19937& random) {
        const std::size_t t = triangle_(random);
        float u = uniform_(random), v = uniform_(random);
        if (u + v > 1.0f) {
            u = 1.0f - u;
            v = 1.0f - v;
        }
        const float side = glm::determinant(mat3(matrix_)) < 0.0f ? -1.0f : 1.0f;
        Place place;
        place.position = corner(t, 0) * (1.0f - u - v) + corner(t, 1) * u + corner(t, 2) * v;
        place.geometric = side * glm::normalize(glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
        const auto normal = [&](std::size_t k) { return mesh_.normals[mesh_.indices[t * 3 + k]]; };
        place.shading = glm::normalize(glm::transpose(glm::inverse(mat3(matrix_))) *
                                       (normal(0) * (1.0f - u - v) + normal(1) * u + normal(2) * v));
        return place;
    }

private:
    vec3 corner(std::size_t t, std::size_t k) const {
        return vec3(matrix_ * vec4(mesh_.positions[mesh_.indices[t * 3 + k]], 1.0f));
    }
    const scene::Mesh& mesh_;
    mat4 matrix_;
    std::discrete_distribution<std::size_t> triangle_;
    std::uniform_real_distribution<float> uniform_{0.0f, 1.0f};
};

struct Found {
    float distance = 0.0f; // texels from the point to what its cell says
    float turn = 0.0f;     // of the normals, rad
};

// As gather.comp and baked_light_cells.comp do it: nothing if the cell is not all there, has a step, or is not at the
// point's height.
std::optional<Found> look_up(const gi::CurvedCharts& charts, std::uint32_t first, const Place& place) {
    const std::uint32_t direction = shared::curved_direction(place.geometric);
    const gi::CurvedChart& chart = charts.charts()[first + direction];
    const vec3 point = shared::curved_place(direction, place.position) - vec3(chart.row.place);
    const vec2 texel = vec2(point) * chart.row.place.w;
    if (chart.columns == 0 || texel.x < 0.0f || texel.y < 0.0f || texel.x > float(chart.columns - 1) ||
        texel.y > float(chart.rows - 1))
        return std::nullopt;
    const glm::uvec2 corner = glm::min(glm::uvec2(texel), glm::uvec2(chart.columns - 2, chart.rows - 2));
    vec3 position(0.0f), normal(0.0f);
    float low = 1e30f, high = -1e30f, sum = 0.0f;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const glm::uvec2 at = corner + glm::uvec2(i & 1, i >> 1);
        const shared::CurvedPoint& here = charts.points()[chart.first_point + at.y * chart.columns + at.x];
        if (here.exists == 0)
            return std::nullopt;
        const vec2 weight = vec2(1.0f) - glm::abs(texel - vec2(at));
        const float height = shared::curved_place(direction, vec3(here.position)).z - chart.row.place.z;
        low = std::min(low, height);
        high = std::max(high, height);
        sum += height;
        position += weight.x * weight.y * vec3(here.position);
        normal += weight.x * weight.y * shared::unpack_normal(here.normal);
    }
    const float cell = 1.0f / chart.row.place.w;
    EXPECT_LE(high * chart.row.size.w, shared::curved_max_height * 1.0001f);
    if (high - low > shared::curved_cell_span * cell ||
        std::abs(point.z - 0.25f * sum) > shared::curved_point_span * cell)
        return std::nullopt;
    return Found{glm::length(position - place.position) / cell,
                 std::acos(std::clamp(glm::dot(glm::normalize(normal), place.shading), -1.0f, 1.0f))};
}

struct World {
    ecs::Registry registry;
    scene::MeshStore meshes;
    gi::SurfacePatches patches;
    gi::StaticBlockers blockers;
    gi::CurvedCharts charts;
    ecs::Entity entity;

    World(scene::Mesh mesh, const mat4& matrix) {
        entity = registry.create();
        registry.emplace<scene::MeshInstance>(entity, scene::MeshInstance{meshes.add(std::move(mesh))});
        registry.emplace<scene::WorldTransform>(entity, scene::WorldTransform{matrix});
    }
    void build(std::uint64_t max_points = 1u << 20) {
        patches.build(registry, meshes, {}, blockers);
        patches.finish();
        charts.build(registry, meshes, patches, 0.05f, max_points);
    }
};

mat4 turned() {
    return glm::rotate(glm::translate(mat4(1.0f), vec3(3.0f, -2.0f, 1.0f)), 0.7f,
                       glm::normalize(vec3(1.0f, 2.0f, 3.0f)));
}

// The least share that is found: bodies that no direction sees twice have texels nearly everywhere; a knot hides parts
// of itself in all directions. What is found is within the flat facets' height of the surface, and the normals within
// the turn of a facet.
TEST(CurvedCharts, PointsFindThemselves) {
    const mat4 mirrored = turned() * glm::scale(mat4(1.0f), vec3(-1.0f, 1.5f, 1.0f));
    struct Case {
        const char* name;
        scene::Mesh mesh;
        mat4 matrix;
        double least;
    };
    const Case cases[] = {{"sphere", scene::make_sphere(0.5f), turned(), 0.99},
                          {"cylinder", scene::make_cylinder(0.3f, 2.0f, 48), turned(), 0.99},
                          {"coarse cylinder", scene::make_cylinder(0.3f, 2.0f, 12), turned(), 0.95},
                          {"torus", scene::make_torus(0.6f, 0.2f), turned(), 0.95},
                          {"mirrored torus", scene::make_torus(0.6f, 0.2f), mirrored, 0.9},
                          {"knot", scene::make_knot(1.0f), turned(), 0.7}};
    for (const Case& one : cases) {
        World world(one.mesh, one.matrix);
        world.build();
        const std::uint32_t first = world.charts.first_chart(world.entity);
        ASSERT_NE(first, shared::no_node) << one.name;
        Points points(one.mesh, one.matrix);
        std::mt19937 random(11);
        int asked = 0, found = 0;
        float farthest = 0.0f, turn = 0.0f;
        for (int i = 0; i < 20000; ++i) {
            const Place place = points(random);
            const std::uint32_t node = world.patches.node_at(world.entity, place.position, place.geometric);
            if (world.patches.nodes()[node].planar && glm::dot(place.shading, place.geometric) > 0.999999f)
                continue;
            ++asked;
            if (const auto result = look_up(world.charts, first, place)) {
                ++found;
                farthest = std::max(farthest, result->distance);
                turn = std::max(turn, result->turn);
            }
        }
        std::printf("%-15s %5d points, %.1f %% found, at most %.2f texels and %.2f rad off\n", one.name, asked,
                    100.0 * found / asked, double(farthest), double(turn));
        EXPECT_GT(asked, 5000) << one.name;
        EXPECT_GT(found, one.least * asked) << one.name;
        EXPECT_LT(farthest, 0.6f) << one.name;
        EXPECT_LT(turn, 0.3f) << one.name;
    }
}

// Half a pipe is seen from both sides; each side has texels with its own normals.
TEST(CurvedCharts, SheetsHaveTwoSides) {
    const int columns = 60;
    scene::Mesh pipe = scene::make_rectangle(3.0f, 2.0f, columns, 4);
    for (std::size_t i = 0; i < pipe.positions.size(); ++i) {
        const float angle = pipe.positions[i].x;
        pipe.positions[i] = vec3(std::sin(angle), pipe.positions[i].y, std::cos(angle));
        pipe.normals[i] = vec3(std::sin(angle), 0.0f, std::cos(angle));
    }
    World world(pipe, mat4(1.0f));
    world.build();
    Points points(pipe, mat4(1.0f));
    std::mt19937 random(12);
    for (const float side : {1.0f, -1.0f}) {
        int asked = 0, found = 0;
        for (int i = 0; i < 4000; ++i) {
            Place place = points(random);
            place.geometric *= side;
            place.shading *= side;
            ++asked;
            if (const auto result = look_up(world.charts, world.charts.first_chart(world.entity), place)) {
                ++found;
                ASSERT_LT(result->distance, 0.5f);
                ASSERT_LT(result->turn, 0.3f);
            }
        }
        EXPECT_GT(asked, 1000);
        // Along two directions the outside hides a half of the inside.
        EXPECT_GT(found, (side > 0.0f ? 0.9 : 0.5) * asked) << side;
    }
}

TEST(CurvedCharts, KeepsItsBound) {
    World world(scene::make_knot(4.0f), mat4(1.0f));
    world.build();
    const std::size_t free = world.charts.points().size();
    world.build(free / 3);
    EXPECT_LE(world.charts.points().size(), free / 3);
    EXPECT_GT(world.charts.points().size(), free / 8);
}

// Flat-shaded from twelve sides, all of them charts.
scene::Mesh faceted_cylinder() {
    scene::Mesh facets = scene::make_cylinder(0.3f, 2.0f, 12);
    for (std::size_t t = 0; t < facets.triangle_count(); ++t) {
        // Its vertices are shared: a copy for each triangle.
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = facets.indices[t * 3 + k];
            facets.positions.push_back(vec3(facets.positions[vertex]));
            facets.indices[t * 3 + k] = std::uint32_t(facets.positions.size() - 1);
        }
        const vec3* const corner = &facets.positions[facets.positions.size() - 3];
        facets.normals.resize(facets.positions.size(),
                              glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0])));
    }
    return facets;
}

TEST(CurvedCharts, NothingForWhatTexelsDoNotKnow) {
    World flat(scene::make_box(vec3(1.0f)), mat4(1.0f));
    flat.build();
    EXPECT_EQ(flat.charts.first_chart(flat.entity), shared::no_node);
    World mapped(scene::make_sphere(0.5f), mat4(1.0f));
    scene::MaterialTextures textures;
    textures.normal.texture = 0;
    mapped.registry.emplace<scene::MaterialTextures>(mapped.entity, textures);
    mapped.build();
    EXPECT_EQ(mapped.charts.first_chart(mapped.entity), shared::no_node);
    World faceted(faceted_cylinder(), mat4(1.0f));
    faceted.build();
    EXPECT_EQ(faceted.charts.first_chart(faceted.entity), shared::no_node);
    // Squeezed flat: what there is of it has normals.
    World squeezed(scene::make_sphere(0.5f), glm::scale(mat4(1.0f), vec3(1.0f, 0.0f, 1.0f)));
    squeezed.build();
    for (const shared::CurvedPoint& point : squeezed.charts.points())
        if (point.exists != 0) {
            ASSERT_NEAR(glm::length(shared::unpack_normal(point.normal)), 1.0f, 1e-3f);
        }
    World nothing(scene::make_sphere(0.0f), mat4(1.0f));
    nothing.build();
    EXPECT_TRUE(nothing.charts.points().empty());
}

} // namespace
} // namespace sunfleck::tests
