// How bright pictures are shown, and what lights a scene that may be dark.
#include "assets/scene_builder.h"
#include "viewer/exposure.h"
#include "viewer/scene_renderer.h"

#include <gtest/gtest.h>

namespace sunfleck::tests {
namespace {

io::Picture picture_of(std::vector<float> luminances) {
    io::Picture picture;
    picture.width = std::uint32_t(luminances.size());
    picture.height = 1;
    for (const float value : luminances)
        picture.pixels.emplace_back(value, value, value, 1.0f);
    return picture;
}

// ISO 2720: 2^EV = L S / K; 683 lm/W, S = 100, K = 12.5 cd s/m2.
TEST(Exposure, IsThatOfALightMeter) {
    const float radiance = 0.02f;
    EXPECT_NEAR(viewer::automatic_exposure(picture_of(std::vector<float>(100, radiance))),
                std::log2(radiance * 683.0f * 100.0f / 12.5f), 1e-4f);
    // A white surface of that irradiance.
    EXPECT_NEAR(viewer::automatic_exposure(picture_of(std::vector<float>(100, radiance * pi)), true),
                std::log2(radiance * 683.0f * 100.0f / 12.5f), 1e-4f);
}

TEST(Exposure, LampsAndBlackCornersDecideNothing) {
    std::vector<float> values(100, 0.5f);
    const float plain = viewer::automatic_exposure(picture_of(values));
    for (std::size_t i = 0; i < 8; ++i)
        values[i] = 1e5f, values[99 - i] = 1e-6f;
    values.resize(150, 0.0f);
    EXPECT_NEAR(viewer::automatic_exposure(picture_of(values)), plain, 1e-4f);
}

TEST(Exposure, FollowsTheLightWithinItsLimits) {
    const float plain = viewer::automatic_exposure(picture_of({0.5f, 1.0f, 2.0f}));
    EXPECT_NEAR(viewer::automatic_exposure(picture_of({2.0f, 4.0f, 8.0f})), plain + 2.0f, 1e-4f);
    EXPECT_EQ(viewer::automatic_exposure(picture_of({0.0f, 0.0f})), viewer::default_exposure);
    EXPECT_EQ(viewer::automatic_exposure(picture_of({1e-30f})), viewer::lowest_exposure);
    EXPECT_EQ(viewer::automatic_exposure(picture_of({1e30f})), viewer::highest_exposure);
}

TEST(DefaultLight, IsOnlyWhereNothingEmits) {
    for (const float emission : {0.0f, 1e-6f}) {
        ecs::Registry registry;
        scene::MeshStore meshes;
        assets::SceneBuilder builder(registry, meshes);
        scene::Material material;
        material.emission = vec3(emission);
        builder.add("ball", scene::make_sphere(1.0f), material);
        EXPECT_EQ(viewer::add_default_light(registry), emission == 0.0f);
    }
}

} // namespace
} // namespace sunfleck::tests
