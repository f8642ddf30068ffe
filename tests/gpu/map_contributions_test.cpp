// What the scheduler thinks that stale maps cost the picture, against rays of the camera.
#include "tests/support/gpu_world.h"

#include "engine/core/random.h"
#include "gi_module/shadows/map_contributions.h"
#include "gi_module/transport/arrival.h"

#include <algorithm>
#include <numeric>

namespace sunfleck::tests {
namespace {

// They are read off the visibility database, which is there for a technique that wants it.
class MapContributions : public GpuTest {
protected:
    void SetUp() override {
        GpuTest::SetUp();
        const auto wants = [](const gi::TechniqueEntry& entry) { return entry.wants_visibility; };
        const auto found = std::find_if(gi::techniques().begin(), gi::techniques().end(), wants);
        if (found == gi::techniques().end())
            GTEST_SKIP() << "no technique of this build wants the visibility database";
        settings.all_light_by(found->name);
    }
    gi::Settings settings;
};

std::vector<float> contributions(GpuWorld& world, const scene::CameraView& in_world) {
    const scene::CameraView camera = world.renderer->space().view(in_world);
    gi::System& lighting = world.renderer->lighting();
    const std::vector<std::uint8_t> wanted(lighting.samples().size(), 1);
    return gi::map_contributions(lighting.visibility(), lighting.samples(), lighting.sample_set().rows(),
                                 world.renderer->gpu_scene().draws(),
                                 scene::make_camera_row(camera, 160, 120).view_projection, wanted);
}

// By sample: the light that only movers take away, or that falls on movers, summed over the picture's pixels.
std::vector<float> light_that_movers_decide(GpuWorld& world, const scene::CameraView& in_world) {
    const scene::CameraView camera = world.renderer->space().view(in_world);
    const raytrace::RayScene& rays = world.renderer->rays();
    gi::System& lighting = world.renderer->lighting();
    const shared::CameraRow row = scene::make_camera_row(camera, 160, 120);
    std::vector<float> result(lighting.samples().size(), 0.0f);
    for (int y = 0; y < 120; y += 2)
        for (int x = 0; x < 160; x += 2) {
            const raytrace::Ray ray{camera.position, shared::camera_ray(row, vec2(x, y) + 0.5f), 0.0f, 1e4f};
            const auto hit = rays.closest_hit(ray);
            if (!hit)
                continue;
            const raytrace::SurfacePoint point = rays.surface(ray, *hit);
            const vec3 towards = camera.position - point.position;
            const vec3 normal =
                glm::dot(point.geometric_normal, towards) < 0.0f ? -point.geometric_normal : point.geometric_normal;
            const bool on_mover = !scene::is_static(world.renderer->registry(), point.entity);
            for (const gi::LightSample& sample : lighting.samples()) {
                const gi::Arrival light = gi::arrival(lighting.sample_set().rows()[sample.index],
                                                      gi::light_class(sample.kind), point.position, 100.0f);
                const float cosine = glm::dot(normal, glm::normalize(light.to_light));
                if (cosine <= 0.0f)
                    continue;
                const raytrace::Ray shadow{point.position + 1e-4f * normal, light.to_light, 0.0f, 0.999f};
                if (rays.occluded(shadow, raytrace::Scope::static_only) || (!on_mover && !rays.occluded(shadow)))
                    continue;
                const vec3 e = light.irradiance;
                result[sample.index] += cosine * std::max({e.x, e.y, e.z});
            }
        }
    return result;
}

std::vector<float> ranks_of(const std::vector<float>& values) {
    std::vector<std::uint32_t> order(values.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return values[a] < values[b]; });
    std::vector<float> ranks(values.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        ranks[order[i]] = float(i);
    return ranks;
}

float correlation(const std::vector<float>& a, const std::vector<float>& b) {
    const float n = float(a.size());
    const float mean_a = std::accumulate(a.begin(), a.end(), 0.0f) / n;
    const float mean_b = std::accumulate(b.begin(), b.end(), 0.0f) / n;
    float both = 0, of_a = 0, of_b = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        both += (a[i] - mean_a) * (b[i] - mean_b);
        of_a += (a[i] - mean_a) * (a[i] - mean_a);
        of_b += (b[i] - mean_b) * (b[i] - mean_b);
    }
    return both / std::sqrt(of_a * of_b);
}

// Patches are larger than shadows, and the view's nodes may be hidden; but samples come in about the order of what the
// movers take from the picture, and the hundred that are drawn first decide most of it.
TEST_F(MapContributions, FollowWhatTheCameraSees) {
    for (const char* camera : {"bench_1", "bench_2"}) {
        GpuWorld world(assets::make_four_pillars, camera);
        world.set(settings);
        world.render();
        const std::vector<float> guessed = contributions(world, world.request.camera);
        const std::vector<float> true_ones = light_that_movers_decide(world, world.request.camera);
        const float ranked = correlation(ranks_of(guessed), ranks_of(true_ones));
        const std::vector<float> ranks = ranks_of(guessed);
        float first = 0, all = 0;
        for (std::size_t i = 0; i < ranks.size(); ++i) {
            all += true_ones[i];
            first += ranks[i] >= float(ranks.size() - 100) ? true_ones[i] : 0.0f;
        }
        std::printf("%s: rank correlation %.2f, the first hundred decide %.0f %%\n", camera, double(ranked),
                    100.0 * double(first / all));
        EXPECT_GT(ranked, 0.7f) << camera;
        EXPECT_GT(first, 0.6f * all) << camera;
    }
}

// A camera that looks away from all movers and shadows.
TEST_F(MapContributions, AreNothingOutOfSight) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    world.set(settings);
    world.render();
    scene::CameraView away = world.request.camera;
    away.position = vec3(0.0f, 100.0f, 0.0f);
    away.target = vec3(0.0f, 200.0f, 1.0f);
    for (const float value : contributions(world, away))
        EXPECT_EQ(value, 0.0f);
}

} // namespace
} // namespace sunfleck::tests
