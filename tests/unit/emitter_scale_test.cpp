// Suns and skies know no least scene: what they send into one grows with its size, in all bits, from dust on.
#include "tests/support/sampled_scene.h"

#include "gi_module/transport/light_row.h"
#include "gi_module/transport/scene_sphere.h"

#include <cmath>

namespace sunfleck::gi {
namespace {

void add_yard(SampledScene& world, float scale) {
    assets::SceneBuilder builder(world.registry, world.meshes);
    builder.quad("floor", vec3(-1, 0, -1) * scale, vec3(0, 0, 2) * scale, vec3(2, 0, 0) * scale,
                 assets::diffuse(vec3(0.5f)));
    builder.quad("wall", vec3(-1, 0, -1) * scale, vec3(2, 0, 0) * scale, vec3(0, 1, 0) * scale,
                 assets::diffuse(vec3(0.5f)));
    world.registry.emplace<scene::Environment>(world.registry.create(), {vec3(0.5f)});
    const ecs::Entity sun = world.registry.create();
    world.registry.emplace<scene::Transform>(sun);
    world.registry.emplace<scene::DirectionalLight>(sun, {vec3(2.0f)});
    world.finish();
}

TEST(AnywhereEmitters, SunsAndSkiesScaleWithTheScene) {
    SampledScene unscaled;
    add_yard(unscaled, 1.0f);
    ASSERT_EQ(unscaled.emitters.size(), 2u);
    for (const float scale : {0x1p-30f, 0x1p-12f, 0x1p-4f, 0x1p10f}) {
        SampledScene world;
        add_yard(world, scale);
        ASSERT_EQ(world.emitters.size(), 2u) << scale;
        for (std::size_t i = 0; i < 2; ++i) {
            EXPECT_EQ(world.emitters[i].scene_radius, scale * unscaled.emitters[i].scene_radius) << scale;
            EXPECT_EQ(world.emitters[i].flux, scale * scale * unscaled.emitters[i].flux) << scale;
        }
        // The sun's map is as wide as the scene.
        const LightSample sun = make_direct_sample(world.emitters[1], 0, 1, {}, *world.rays),
                          large = make_direct_sample(unscaled.emitters[1], 0, 1, {}, *unscaled.rays);
        EXPECT_EQ(make_light_row(sun, 0, 1e30f, world.bounds).tangent_scale.w * scale,
                  make_light_row(large, 0, 1e30f, unscaled.bounds).tangent_scale.w)
            << scale;
    }
}

TEST(AnywhereEmitters, PointsAndNothingHaveASphere) {
    EXPECT_EQ(bounding_radius({}), 1.0f);
    EXPECT_EQ(bounding_radius({vec3(0.0f), vec3(0.0f)}), 1.0f);
    const Bounds corner{vec3(1000.0f, 0.0f, 0.0f), vec3(1000.0f, 0.0f, 0.0f)};
    EXPECT_GT(bounding_radius(corner), std::nextafter(1000.0f, 2000.0f) - 1000.0f); // it is seen from outside
    EXPECT_LT(bounding_radius(corner), 1e-3f);
    EXPECT_EQ(bounding_radius({vec3(-1.0f), vec3(1.0f)}), std::sqrt(3.0f));
}

} // namespace
} // namespace sunfleck::gi
