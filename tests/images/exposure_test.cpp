// How bright pictures are shown, and what lights a scene that may be dark.
#include "assets/scene_builder.h"
#include "tests/support/gpu_world.h"
#include "viewer/adaptation.h"
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

// Half of what the meter says of rooms, which are lighter than grey, is followed, exponentially and whatever the frame
// rate, and the way there ends.
TEST(Adaptation, FollowsHalfOfTheMeterAndEnds) {
    viewer::ExposureAdaptation eye;
    EXPECT_EQ(eye.advance(8.0f, std::nullopt, 0.1), 8.0f);
    EXPECT_EQ(eye.advance(8.0f, 10.0f, 0.1), 8.5f); // the first picture, at once
    viewer::ExposureAdaptation slow = eye, fast = eye;
    float once = slow.advance(8.0f, 7.0f, 0.2), twice = 0.0f;
    for (int i = 0; i < 2; ++i)
        twice = fast.advance(8.0f, 7.0f, 0.1);
    EXPECT_NEAR(once, twice, 1e-5f);
    EXPECT_NEAR(once, 7.0f + 1.5f * float(std::exp(-0.2 / 1.5)), 1e-5f);
    for (int i = 0; i < 200; ++i)
        once = slow.advance(8.0f, std::nullopt, 0.1);
    EXPECT_EQ(once, 7.0f);
    EXPECT_LT(slow.advance(8.0f, 30.0f, 1e6), 10.0f + 1e-5f); // within its reach
}

TEST(Adaptation, IsFasterToBrightness) {
    viewer::ExposureAdaptation up, down;
    up.advance(8.0f, 9.0f, 0.0), down.advance(8.0f, 9.0f, 0.0);
    EXPECT_GT(up.advance(8.0f, 11.0f, 0.3) - 8.0f, 1.5f * (8.0f - down.advance(8.0f, 7.0f, 0.3)));
}

class ExposureMeterTest : public GpuTest {};

// The meter's points say of a frame what all of its pixels do. (A grid of 48 x 27 points: a tenth of an EV.)
TEST_F(ExposureMeterTest, MeasuresThePicture) {
    GpuWorld world(assets::make_cornell, "view");
    gi::Settings settings;
    settings.lights = 60;
    settings.shadow_map_resolution = 64;
    world.set(settings);
    world.request.width = 160;
    world.request.height = 90;
    world.request.view = shared::view_final;
    world.request.meter = true;
    EXPECT_FALSE(world.renderer->metered_exposure());
    const io::Picture picture = world.picture();
    const std::optional<float> metered = world.renderer->metered_exposure();
    ASSERT_TRUE(metered);
    EXPECT_NEAR(*metered, viewer::automatic_exposure(picture), 0.1f);
    EXPECT_FALSE(world.renderer->metered_exposure()) << "it was collected";
}

} // namespace
} // namespace sunfleck::tests
