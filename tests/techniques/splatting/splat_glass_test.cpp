// Light that glass refracts, splatted, against light tracing.
#include "editor/command_line/metrics.h"
#include "gi_module/reference/light_tracer.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

#include <vector>

namespace sunfleck::tests {
namespace {

using namespace gi::reference;

class SplatGlass : public GpuTest {
protected:
    static constexpr std::uint32_t width = 64, height = 36, places = 4; // places across a pixel

    // The mean over 4x4 places of each pixel.
    static io::Picture splatted(GpuWorld& world, const char* refraction) {
        gi::Settings settings;
        settings.lights = 4;
        settings.low_resolution = 1;
        settings.bounces = 1;
        settings.with("direct", "none").with("punctual", "none").with("splat_lights", "all").with("splats", "0");
        settings.with("splat_rays", "16384").with("glossy_splats", "2048").with("splat_refraction", refraction);
        world.request.width = places * width;
        world.request.height = places * height;
        world.set(settings);
        const io::Picture fine = world.picture();
        io::Picture mean{width, height, std::vector<vec4>(std::size_t(width) * height, vec4(0.0f))};
        for (std::size_t i = 0; i < fine.pixels.size(); ++i) {
            const std::size_t x = i % fine.width / places, y = i / fine.width / places;
            const float share = fine.pixels[i].w > 0.0f ? 1.0f / float(places * places) : 0.0f;
            mean.pixels[y * width + x] += vec4(share * vec3(fine.pixels[i]), share);
        }
        return mean;
    }
    // What glass alone brings, where it is more than in the mean.
    static io::Picture traced(GpuWorld& world, std::uint32_t particles) {
        ecs::Registry& registry = world.renderer->registry();
        std::vector<ecs::Entity> others;
        registry.view<scene::Material>().each([&](ecs::Entity entity, const scene::Material& material) {
            if (material.transmission <= 0.0f)
                others.push_back(entity);
        });
        for (const ecs::Entity entity : others) {
            registry.patch<scene::Material>(entity, [](scene::Material& of) { of = assets::diffuse(vec3(0.0f)); });
            if (registry.has<scene::SurfacePattern>(entity))
                registry.remove<scene::SurfacePattern>(entity);
        }
        scene::update_world_transforms(registry);
        const auto rays = raytrace::RayScene::create().value();
        EXPECT_TRUE(rays->update(registry, world.renderer->meshes()));
        const Bounds bounds = viewer::scene_bounds(registry, world.renderer->meshes());
        const LightTracer tracer(*rays, gi::collect_emitters(registry, world.renderer->meshes(), bounds));
        ReferenceSettings settings;
        settings.width = width;
        settings.height = height;
        settings.view = ReferenceView::indirect;
        settings.bounces = gi::most_glass_surfaces;
        Accumulation sums;
        EXPECT_TRUE(tracer.accumulate(sums, world.request.camera, settings, particles));
        io::Picture picture{width, height, {}};
        double mean = 0.0;
        for (std::size_t i = 0; i < sums.covered.size(); ++i) {
            const vec3 light(sums.sums[i * 3], sums.sums[i * 3 + 1], sums.sums[i * 3 + 2]);
            picture.pixels.emplace_back(light / float(particles), sums.covered[i] ? 1.0f : 0.0f);
            mean += double(luminance(light)) / particles / double(sums.covered.size());
        }
        for (vec4& pixel : picture.pixels)
            pixel.w = double(luminance(vec3(pixel))) > mean ? pixel.w : 0.0f;
        return picture;
    }
};

// Traced through all surfaces, the caustic has the reference's energy and shape; refracted once, it is elsewhere; off,
// there is none. The bounds are those that splatting aims at.
TEST_F(SplatGlass, TracedThroughAllSurfacesItIsTheReferences) {
    GpuWorld world(assets::make_glass, "view");
    const io::Picture pictures[] = {splatted(world, "off"), splatted(world, "single"), splatted(world, "traced")};
    const io::Picture truth = traced(world, by_size(512u, 16384u));
    double energy[3], error[3];
    for (int i = 0; i < 3; ++i) {
        const command_line::Metrics metrics = command_line::compare_pictures(pictures[i], truth, true);
        energy[i] = metrics.mean_a / metrics.mean_b;
        error[i] = metrics.relative_mean_square_error;
        std::printf("energy %.3f, truth error %.3f\n", energy[i], error[i]);
    }
    EXPECT_LT(energy[0], 0.05);
    EXPECT_NEAR(energy[2], 1.0, 0.1);
    EXPECT_LT(error[2], 0.3);
    EXPECT_LT(error[2], 0.5 * error[1]);
}

} // namespace
} // namespace sunfleck::tests
