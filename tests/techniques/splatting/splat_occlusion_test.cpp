// Shadow maps of pixel lights that are kept from frame to frame are what they would be if they were made anew.
#include "assets/test_rooms.h"
#include "gi_module/splatting/splat_occlusion.h"
#include "gi_module/transport/pixel_light.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>
#include <random>

namespace sunfleck::tests {
namespace {

using namespace gi;

shared::PixelLightRow row_at(vec3 position, vec3 normal) {
    PixelLight light;
    light.position = position;
    light.normal = light.axis = normal;
    light.flux = vec3(1.0f);
    light.area = 0.1f;
    return make_pixel_light_row(light, 0, 2.0f, 0.0f);
}

TEST(SplatOcclusionMaps, KeptOnesAreThoseMadeAnew) {
    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder(registry, meshes);
    assets::make_arena(builder); // with a knot that moves
    const ecs::Entity crate = builder.box("crate", vec3(-0.5f), vec3(0.5f), assets::diffuse(vec3(0.5f)));
    builder.mover(crate, {});
    const auto rays = raytrace::RayScene::create().value();
    scene::ChangeTracker tracker;
    std::mt19937 random(4);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    std::vector<shared::PixelLightRow> lights;
    PixelLightMaps kept;
    const std::size_t count = 40;
    std::uint64_t saved = 0, all = 0;
    for (int step = 0; step < by_size(8, 60); ++step) {
        registry.patch<scene::Transform>(crate, [&](scene::Transform& transform) {
            transform.position = vec3(5.0f * uniform(random), 2.0f + uniform(random), 5.0f * uniform(random));
        });
        scene::update_world_transforms(registry);
        const scene::SceneChanges& changes = tracker.collect(registry, meshes);
        ASSERT_TRUE(rays->update(changes, meshes));
        // Some lights stay, one goes, one comes.
        if (!lights.empty())
            lights.erase(lights.begin() + step % 7);
        while (lights.size() < count)
            lights.push_back(row_at(vec3(5.0f * uniform(random), 2.5f + 2.0f * uniform(random), 5.0f * uniform(random)),
                                    glm::normalize(vec3(uniform(random), uniform(random), uniform(random)))));
        PixelLightMaps fresh;
        kept.update(lights, 16, *rays, moving_spheres(changes));
        fresh.update(lights, 16, *rays, moving_spheres(changes));
        // All of it, whatever moves: with a sphere around everything.
        PixelLightMaps plain;
        const MovingSphere everywhere[] = {{vec3(0.0f), 100.0f}};
        plain.update(lights, 16, *rays, everywhere);
        ASSERT_EQ(kept.texels().size(), count * 256);
        std::size_t different = 0, with_mover = 0;
        for (std::size_t i = 0; i < count * 256; ++i) {
            EXPECT_EQ(kept.texels()[i], fresh.texels()[i]);
            // Static geometry is met by way of its own scene or by way of all: the same but for rounding.
            different += std::abs(int(kept.texels()[i]) - int(plain.texels()[i])) > 1;
        }
        EXPECT_EQ(different, 0u);
        PixelLightMaps without;
        without.update(lights, 16, *rays, {});
        for (std::size_t i = 0; i < count * 256; ++i)
            with_mover += without.texels()[i] != kept.texels()[i];
        EXPECT_GT(with_mover, 20u) << "movers are in no map";
        saved += step > 0 ? fresh.rays() - kept.rays() : 0;
        all += step > 0 ? fresh.rays() : 0;
        // Nothing moves: nothing is traced.
        kept.update(lights, 16, *rays, moving_spheres(changes));
        EXPECT_EQ(kept.rays(), 0u);
    }
    EXPECT_GT(double(saved), 0.5 * double(all));
}

} // namespace
} // namespace sunfleck::tests
