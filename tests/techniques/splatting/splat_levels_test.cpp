// Multiresolution: light at nodes of flat pieces of the picture, interpolated, is that of every pixel, for far fewer
// evaluations.
#include "editor/command_line/metrics.h"
#include "gi_module/splatting/splatting_shared.h"
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"
#include "tests/techniques/splatting/evaluations.h"

#include <cstdio>
#include <utility>

namespace sunfleck::tests {
namespace {

TEST(TileNodes, InterpolatePolynomialsOfDegreeTwo) {
    const auto polynomial = [](vec2 at) { return 2.0f - at.x + 3.0f * at.y + 0.5f * at.x * at.x - at.x * at.y; };
    for (std::uint32_t node = 0; node < shared::tile_nodes; ++node)
        for (std::uint32_t other = 0; other < shared::tile_nodes; ++other)
            EXPECT_FLOAT_EQ(shared::node_weight(node, shared::node_place(other)), node == other ? 1.0f : 0.0f);
    for (const vec2 at : {vec2(0.0f), vec2(0.3f, -0.8f), vec2(-0.55f, 0.1f), vec2(0.9f, 0.95f)}) {
        float sum = 0.0f, value = 0.0f;
        for (std::uint32_t node = 0; node < shared::tile_nodes; ++node) {
            sum += shared::node_weight(node, at);
            value += shared::node_weight(node, at) * polynomial(shared::node_place(node));
        }
        EXPECT_NEAR(sum, 1.0f, 1e-6f);
        EXPECT_NEAR(value, polynomial(at), 1e-5f);
    }
}

TEST(TileNodes, CornersInterpolateBilinearly) {
    const auto plane = [](vec2 at) { return 2.0f - at.x + 3.0f * at.y - 0.5f * at.x * at.y; };
    for (const vec2 at : {vec2(0.0f), vec2(0.3f, -0.8f), vec2(-1.0f, 1.0f)}) {
        float value = 0.0f;
        for (std::uint32_t node = 0; node < shared::corner_nodes; ++node)
            value += shared::corner_weight(node, at) * plane(shared::node_place(node));
        EXPECT_NEAR(value, plane(at), 1e-5f);
    }
    EXPECT_EQ(shared::waves_of(1, shared::tile_nodes, 0), 1u);
    EXPECT_EQ(shared::waves_of(2, shared::corner_nodes, 1), 2u);
}

class SplatLevels : public GpuTest {
protected:
    // The first bounce alone, of 300 lights: two batches.
    static gi::Settings settings(const char* levels, const char* occlusion = "none") {
        gi::Settings result;
        result.lights = 4;
        result.bounces = 1;
        result.low_resolution = 1;
        result.with("direct", "none").with("punctual", "none").with("splat_lights", "all").with("splats", "300");
        // Lights in a pattern do not depend on the frames before.
        result.with("splat_pattern", "fixed").with("splat_occlusion", occlusion);
        return result.with("splat_levels", levels);
    }
    static void size(GpuWorld& world, std::uint32_t width, std::uint32_t height) {
        world.request.width = width;
        world.request.height = height;
    }
    static double error(GpuWorld& world, const gi::Settings& by_levels, const gi::Settings& every_pixel) {
        world.set(every_pixel);
        const io::Picture expected = world.picture();
        world.set(by_levels);
        return command_line::compare_pictures(world.picture(), expected, true).relative_mean_square_error;
    }
};

// Walls, crates, spheres and figures; the size is no multiple of a tile's.
TEST_F(SplatLevels, IsTheLightOfEveryPixel) {
    for (const auto& [make, most] : {std::pair(&assets::make_arena, 0.17), std::pair(&assets::make_hall, 0.24)}) {
        GpuWorld world(make, "bench_1");
        size(world, 340, 190);
        EXPECT_LT(error(world, settings("on"), settings("off")), 0.002);
        const double few = evaluations(world);
        world.set(settings("off"));
        const double all = evaluations(world);
        std::printf("evaluations: %.3f of every pixel's\n", few / all);
        EXPECT_GT(few, 0.01 * all);
        EXPECT_LT(few, most * all);
    }
}

// The nodes of low-resolution pixels are between those; repaired pixels have none.
TEST_F(SplatLevels, LightLowResolutionPixels) {
    GpuWorld world(assets::make_arena, "bench_1");
    size(world, 640, 360);
    gi::Settings by_levels = settings("on"), every_pixel = settings("off");
    by_levels.low_resolution = every_pixel.low_resolution = 4;
    EXPECT_LT(error(world, by_levels, every_pixel), 0.002);
}

// Shadows are interpolated over no more than the texels of a light's map that blend anyway.
TEST_F(SplatLevels, KeepShadows) {
    GpuWorld world(assets::make_arena, "bench_1");
    size(world, 340, 190);
    EXPECT_LT(error(world, settings("on", "maps"), settings("off", "maps")), 0.01);
}

// A lobe is narrower than a tile: with glossy lights beside, those are evaluated at every pixel.
TEST_F(SplatLevels, LeaveLobesToPixels) {
    GpuWorld world(assets::make_ring, "view");
    size(world, 160, 90);
    EXPECT_LT(error(world, settings("on").with("glossy_splats", "300"), settings("off").with("glossy_splats", "300")),
              0.002);
}

} // namespace
} // namespace sunfleck::tests
