// Where rays meet triangles, on any processor.
#include "engine/raytrace/ray_scene.h"

#include "assets/scene_builder.h"
#include "assets/test_rooms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sunfleck::raytrace {
namespace {

class RayPlaces : public testing::Test {
protected:
    std::unique_ptr<RayScene> scene(const char* instructions = nullptr) {
        std::unique_ptr<RayScene> made = RayScene::create(instructions).value();
        EXPECT_TRUE(made->update(registry, meshes));
        return made;
    }
    float random(float from, float to) { return std::uniform_real_distribution<float>(from, to)(engine); }
    vec3 random(vec3 from, vec3 to) { return {random(from.x, to.x), random(from.y, to.y), random(from.z, to.z)}; }

    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder{registry, meshes};
    std::mt19937 engine{1};
};

// The oldest instructions against the best that this processor has: other widths, other roundings, other approximations
// of a quotient. Which of two triangles a ray meets may differ where they share an edge, or lie in the same place.
TEST_F(RayPlaces, DoNotDependOnTheProcessorsInstructions) {
    assets::make_lantern_house(builder); // with movers
    scene::update_world_transforms(registry);
    const auto best = scene(), oldest = scene("sse2");
    constexpr int count = 200000;
    int met = 0, others = 0;
    for (int i = 0; i < count; ++i) {
        Ray ray;
        ray.origin = random(vec3(-8.0f, 0.1f, -9.0f), vec3(8.0f, 5.0f, 6.0f));
        ray.direction = random(vec3(-1.0f), vec3(1.0f));
        const std::optional<Hit> a = best->closest_hit(ray), b = oldest->closest_hit(ray);
        met += a.has_value();
        if (!a || !b || a->instance != b->instance || a->primitive != b->primitive) {
            others += a.has_value() != b.has_value() || (a && std::abs(a->distance / b->distance - 1.0f) > 0x1p-20f);
            continue;
        }
        ASSERT_EQ(a->distance, b->distance) << i;
        ASSERT_EQ(a->u, b->u) << i;
        ASSERT_EQ(a->v, b->v) << i;
    }
    EXPECT_GT(met, count / 2);
    EXPECT_LT(others, met / 20000);
}

// A triangle and a ray to a known place of it, far and near, steep and grazing: as exact as floats can say.
TEST_F(RayPlaces, AreWhereTheTriangleIs) {
    const vec3 corners[] = {{0.3f, 1.7f, -2.1f}, {4.9f, 1.2f, -1.3f}, {0.1f, 5.3f, 0.7f}};
    scene::Mesh mesh;
    mesh.positions.assign(std::begin(corners), std::end(corners));
    mesh.normals.assign(3, vec3(0.0f, 0.0f, 1.0f));
    mesh.indices = {0, 1, 2};
    builder.add("triangle", std::move(mesh), assets::diffuse(vec3(0.5f)));
    scene::update_world_transforms(registry);
    const auto rays = scene();
    const vec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    for (int i = 0; i < 20000; ++i) {
        const float u = random(0.05f, 0.9f), v = random(0.02f, 0.95f - u);
        const vec3 target = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
        const vec3 along = glm::normalize(glm::cross(normal, random(vec3(-1.0f), vec3(1.0f))));
        const float slope = std::exp2(random(-8.0f, 0.0f)), length = std::exp2(random(-3.0f, 8.0f));
        Ray ray;
        ray.origin = target + length * (slope * normal + (1.0f - slope) * along);
        ray.direction = target - ray.origin;
        const auto hit = rays->closest_hit(ray);
        ASSERT_TRUE(hit.has_value()) << i;
        // The ray was rounded as its origin and direction were, which shows the more the flatter it is.
        const float rounding = 0x1p-23f * (length + 8.0f) / (slope * length);
        ASSERT_NEAR(hit->distance, 1.0f, 4.0f * rounding) << i;
        ASSERT_NEAR(hit->u, u, 4.0f * rounding * length) << i;
        ASSERT_NEAR(hit->v, v, 4.0f * rounding * length) << i;
        // What the ray is, exactly, meets the plane there: only the distance was rounded.
        const glm::dvec3 at = glm::dvec3(ray.origin) + double(hit->distance) * glm::dvec3(ray.direction);
        const double height = glm::dot(at - glm::dvec3(corners[0]), glm::dvec3(normal));
        ASSERT_LT(std::abs(height), 0x1p-23 * (double(slope) * length + 8.0)) << i;
    }
}

} // namespace
} // namespace sunfleck::raytrace
