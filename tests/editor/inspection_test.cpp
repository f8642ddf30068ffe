// What the inspection of a pixel says: the lights' shares add up to the irradiance that the picture has there.
#include "viewer/pixel_report.h"

#include "engine/core/random.h"
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"
#include "viewer/overlays.h"

#include <algorithm>

namespace sunfleck {
namespace {

class EditorInspection : public tests::GpuTest {
protected:
    // Relative differences between sum of shares and picture, sorted, over every seventh pixel that shows a surface.
    static std::vector<double> differences(tests::GpuWorld& world) {
        const io::Picture picture = world.picture();
        std::vector<double> result;
        for (std::uint32_t i = 3; i < picture.width * picture.height; i += 7) {
            const std::uint32_t column = i % picture.width, line = i / picture.width;
            const vec2 place(float(column) + 0.5f, float(line) + 0.5f);
            const shared::CameraRow row = scene::make_camera_row(world.request.camera, picture.width, picture.height);
            const vec2 screen = place / vec2(float(picture.width), float(picture.height)) * 2.0f - 1.0f;
            const vec3 direction = vec3(row.forward) + screen.x * vec3(row.right) + screen.y * vec3(row.down);
            const viewer::PixelReport report =
                viewer::report_pixel(*world.renderer, world.request.camera.position, direction);
            const double shown = double(luminance(vec3(picture.pixels[i])));
            EXPECT_EQ(report.entity.is_null(), picture.pixels[i].w == 0.0f) << "pixel " << i;
            if (!report.entity.is_null() && shown > 0.0)
                result.push_back(std::abs(double(luminance(report.irradiance())) - shown) / shown);
        }
        std::sort(result.begin(), result.end());
        return result;
    }
    static double at(const std::vector<double>& sorted, double share) {
        return sorted.at(std::size_t(share * double(sorted.size() - 1)));
    }
};

// Without shortcuts, in maps four times as fine as usual: what is left are shadow edges and the maps' texels. A share
// without its cosine, its bound or its shadow test is off by more than a tenth nearly everywhere.
TEST_F(EditorInspection, SharesAddUpToThePicture) {
    tests::GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings = tests::plain_light();
    settings.lights = 200;
    settings.shadow_map_resolution = 512;
    world.set(settings);
    const std::vector<double> off = differences(world);
    ASSERT_GT(off.size(), 200u);
    std::printf("median %.4f, 95 %% %.4f, most %.4f\n", at(off, 0.5), at(off, 0.95), off.back());
    EXPECT_LT(at(off, 0.5), 0.01);
    EXPECT_LT(at(off, 0.95), 0.05);
}

// As artists have it: light is baked, interpolated, and evaluated at a quarter of the resolution.
TEST_F(EditorInspection, SharesAddUpWithTheUsualTechniques) {
    tests::GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings;
    settings.lights = 200;
    world.set(settings);
    world.render();
    const std::vector<double> off = differences(world);
    ASSERT_GT(off.size(), 200u);
    std::printf("median %.4f, 95 %% %.4f, most %.4f\n", at(off, 0.5), at(off, 0.95), off.back());
    EXPECT_LT(at(off, 0.5), 0.03);
    EXPECT_LT(at(off, 0.9), 0.15);
}

// Of each sample: what the visibility database says agrees with the ray, and its map is up to date.
TEST_F(EditorInspection, SaysWhatStandsBetween) {
    tests::GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings;
    settings.lights = 200;
    settings.map_budget = 65536;
    world.set(settings);
    world.render();
    world.render();
    if (world.renderer->lighting().visibility().node_count() == 0)
        GTEST_SKIP() << "no technique in use asks for visibility";
    std::size_t places = 0, free = 0, hidden = 0;
    for (int x = -4; x <= 4; ++x)
        for (int y = -3; y <= 3; ++y) {
            const shared::CameraRow row = scene::make_camera_row(world.request.camera, 64, 48);
            const vec3 direction =
                vec3(row.forward) + 0.2f * float(x) * vec3(row.right) + 0.25f * float(y) * vec3(row.down);
            const viewer::PixelReport report =
                viewer::report_pixel(*world.renderer, world.request.camera.position, direction);
            if (!report.patch || report.moves)
                continue;
            ++places;
            const gi::VisibilityCounters& counts = report.patch->samples;
            EXPECT_EQ(counts.full + counts.none + counts.partial + counts.unlit, report.samples.size());
            for (const gi::ExplainedLight& part : report.light)
                for (const gi::LightShare& share : part.shares) {
                    ASSERT_TRUE(share.sample);
                    const viewer::SampleState& state = report.samples[*share.sample];
                    EXPECT_EQ(state.map.frames_out_of_date, 0u);
                    EXPECT_EQ(state.blockers.empty(), state.between == gi::PairState::none);
                    if (state.between == gi::PairState::none) {
                        ++free;
                        EXPECT_EQ(share.irradiance, share.unshadowed) << "sample " << *share.sample;
                    }
                    if (state.between == gi::PairState::full) {
                        ++hidden;
                        EXPECT_EQ(share.irradiance, vec3(0.0f)) << "sample " << *share.sample;
                    }
                }
        }
    EXPECT_GT(places, 20u);
    EXPECT_GT(free, 500u);
    EXPECT_GT(hidden, 20u);
}

// Lines are in the picture, and none where an overlay is off; unknown names are an error.
TEST_F(EditorInspection, OverlaysDrawLines) {
    tests::GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings;
    settings.lights = 60;
    world.set(settings);
    world.request.tone_map = true;
    world.request.view = shared::view_final;
    world.render();
    const io::Picture plain = world.picture();
    for (const gi::Overlay* overlay : viewer::overlays()) {
        SCOPED_TRACE(std::string(overlay->name));
        EXPECT_FALSE(overlay->tooltip.empty());
        EXPECT_FALSE(overlay->legend.empty());
        world.request.overlays = {std::string(overlay->name)};
        const io::Picture drawn = world.picture();
        std::size_t changed = 0;
        for (std::size_t i = 0; i < plain.pixels.size(); ++i)
            changed += plain.pixels[i] != drawn.pixels[i] ? 1 : 0;
        if (overlay->group != "visibility" || world.renderer->lighting().visibility().node_count() > 0) {
            EXPECT_GT(changed, 10u);
        }
    }
    world.request.overlays = {"nothing"};
    const Status status = world.renderer->render_and_wait(world.request);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().message, "there is no overlay 'nothing'");
}

} // namespace
} // namespace sunfleck
