// What the inspection of a pixel says: the lights' shares add up to the irradiance that the picture has there.
#include "viewer/pixel_report.h"

#include "engine/core/random.h"
#include "engine/scene/simulation_components.h"
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

void make_pillars_with_area_and_spot(assets::SceneBuilder& builder) {
    assets::make_four_pillars(builder);
    ecs::Registry& registry = builder.registry();
    const ecs::Entity area = registry.create();
    registry.emplace(area, scene::Transform{.position = vec3(2.8f, 1.8f, 0.0f)}); // beside the pillar in front
    registry.emplace(area, scene::GameArea{.half_size = vec3(1.0f, 0.5f, 0.75f)});
    registry.emplace(area, scene::SpotLight{});
}

// What the lines of the scene's own overlays join, in the world.
TEST_F(EditorInspection, LampsAreasAndSensorsAreDrawnWhereTheyAre) {
    tests::GpuWorld world(assets::make_four_pillars);
    ecs::Registry& registry = world.renderer->registry();
    const auto add = [&](vec3 place, const quat& turn) {
        const ecs::Entity entity = registry.create();
        registry.emplace(entity, scene::Transform{.position = place, .rotation = turn});
        return entity;
    };
    const quat to_right = glm::angleAxis(-0.5f * pi, vec3(0.0f, 1.0f, 0.0f)); // -Z becomes +X, +Z -X, +X +Z
    registry.emplace(add(vec3(2.0f, 1.0f, 3.0f), to_right), scene::GameArea{.half_size = vec3(3.0f, 1.0f, 0.5f)});
    registry.emplace(add(vec3(1.0f, 2.0f, 0.0f), to_right), scene::LightSensor{});
    registry.emplace(add(vec3(0.0f, 2.5f, 1.0f), to_right),
                     scene::SpotLight{.inner_angle = 0.25f * pi, .outer_angle = pi / 3.0f});
    scene::update_world_transforms(registry);
    ASSERT_TRUE(world.renderer->update(world.request));
    const auto has = [&](std::string_view overlay, vec3 from, vec3 to) {
        gi::OverlayLines lines;
        EXPECT_TRUE(viewer::draw_overlay(*world.renderer, overlay, lines));
        const scene::SceneSpace& space = world.renderer->space();
        const auto near = [&](vec3 a, vec3 b) { return glm::length(a - space.point(b)) < 1e-5f; };
        return std::any_of(lines.lines().begin(), lines.lines().end(), [&](const gi::OverlayLines::Line& line) {
            return (near(line.from, from) && near(line.to, to)) || (near(line.from, to) && near(line.to, from));
        });
    };
    EXPECT_TRUE(has("areas", vec3(1.5f, 0.0f, 0.0f), vec3(1.5f, 2.0f, 0.0f))) << "an upright edge";
    EXPECT_TRUE(has("areas", vec3(2.5f, 2.0f, 0.0f), vec3(2.5f, 2.0f, 6.0f))) << "a long one";
    EXPECT_TRUE(has("areas", vec3(2.0f, 1.0f, 3.0f), vec3(2.0f, 2.72f, 3.0f))) << "who begins again there";
    const float unit = world.renderer->space().unit;
    EXPECT_TRUE(has("areas", vec3(1.0f, 2.0f, 0.0f), vec3(1.0f - 0.4f * unit, 2.0f, 0.0f))) << "a sensor's normal";
    const vec3 spot(0.0f, 2.5f, 1.0f);
    const float length = 0.6f * unit;
    const vec3 rim = length * vec3(std::cos(pi / 3.0f), std::sin(pi / 3.0f), 0.0f);
    EXPECT_TRUE(has("lamps", spot, spot + rim)) << "along the outer cone";
    const float inner = length * std::cos(0.25f * pi), piece = pi / 16.0f;
    EXPECT_TRUE(has("lamps", spot + inner * vec3(1.0f, 0.0f, 1.0f),
                    spot + inner * vec3(1.0f, std::sin(piece), std::cos(piece))))
        << "round the end of the inner one";
    EXPECT_TRUE(has("lamps", spot, spot + vec3(0.4f * unit, 0.0f, 0.0f)));
}

// Lines are in the picture, and none where an overlay is off; unknown names are an error.
TEST_F(EditorInspection, OverlaysDrawLines) {
    tests::GpuWorld world(make_pillars_with_area_and_spot, "bench_1");
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
