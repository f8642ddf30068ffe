// Light samples carry the flux of each bounce that the path tracer finds on surfaces.
#include "tests/support/sampled_scene.h"
#include "tests/support/test_size.h"

#include "engine/core/random.h"
#include "gi_module/reference/path_tracer.h"

#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t flux_bounces = 3;

// Means over repetitions, with the standard error of each.
struct FluxPerBounce {
    double mean[flux_bounces] = {}, error[flux_bounces] = {};
};

// From `count` repetitions, each of which gives a flux per bounce.
template <typename Repeat>
FluxPerBounce mean_of(std::uint32_t count, const Repeat& repeat) {
    FluxPerBounce result;
    double square[flux_bounces] = {};
    for (std::uint32_t i = 0; i < count; ++i) {
        double value[flux_bounces] = {};
        repeat(i, value);
        for (std::uint32_t k = 0; k < flux_bounces; ++k) {
            result.mean[k] += value[k] / count;
            square[k] += value[k] * value[k] / count;
        }
    }
    for (std::uint32_t k = 0; k < flux_bounces; ++k)
        result.error[k] = std::sqrt(std::max(0.0, square[k] - result.mean[k] * result.mean[k]) / (count - 1));
    return result;
}

FluxPerBounce flux_of_walks(const SampledScene& world, std::uint32_t candidates, std::uint32_t seeds) {
    return mean_of(seeds, [&](std::uint32_t seed, double* flux) {
        SampleRequest settings;
        settings.bounces = flux_bounces;
        settings.candidates = candidates;
        settings.seed = seed + 1;
        for (const LightSample& sample : sample_indirect(world.emitters, 4096, settings, *world.rays))
            flux[sample.bounce - 1] += double(luminance(sample.flux));
    });
}

// The surfaces of a scene, to take points from in proportion to area.
struct Surfaces {
    struct Triangle {
        vec3 p[3];
        vec3 albedo;
    };
    explicit Surfaces(SampledScene& world) {
        world.registry.view<scene::MeshInstance, scene::WorldTransform, scene::Material>().each(
            [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& transform,
                const scene::Material& material) {
                const scene::Mesh& mesh = world.meshes[instance.mesh];
                for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
                    Triangle t;
                    for (int k = 0; k < 3; ++k)
                        t.p[k] = vec3(transform.matrix * vec4(mesh.positions[mesh.indices[i + std::size_t(k)]], 1.0f));
                    t.albedo = material.base_colour;
                    area += 0.5 * double(glm::length(glm::cross(t.p[1] - t.p[0], t.p[2] - t.p[0])));
                    cumulative.push_back(area);
                    triangles.push_back(t);
                }
            });
    }
    const Triangle& triangle(float random) const {
        const auto found = std::upper_bound(cumulative.begin(), cumulative.end(), double(random) * area);
        return triangles[std::min<std::size_t>(std::size_t(found - cumulative.begin()), triangles.size() - 1)];
    }
    std::vector<Triangle> triangles;
    std::vector<double> cumulative;
    double area = 0;
};

// The adjoint of walks: radiosity (albedo times irradiance that was reflected k - 1 times before) integrated over the
// static surfaces by the path tracer from random surface points.
FluxPerBounce flux_of_path_tracer(SampledScene& world, std::uint32_t points, std::uint32_t rays_per_point) {
    const reference::PathTracer tracer(*world.rays, world.emitters);
    const Surfaces surfaces(world);
    return mean_of(points, [&](std::uint32_t i, double* value) {
        const RandomSequence random(SequenceKind::sobol, 99, i);
        const Surfaces::Triangle& t = surfaces.triangle(random.at(0));
        const float root = std::sqrt(random.at(1)), v = random.at(2);
        const vec3 position = t.p[0] + root * (1.0f - v) * (t.p[1] - t.p[0]) + root * v * (t.p[2] - t.p[0]);
        const vec3 normal = glm::normalize(glm::cross(t.p[1] - t.p[0], t.p[2] - t.p[0]));
        // Surfaces are two-sided.
        for (const float side : {1.0f, -1.0f}) {
            const auto irradiance = tracer.irradiance_by_bounce(position, side * normal, flux_bounces - 1,
                                                                rays_per_point, i * 2 + (side > 0 ? 0 : 1));
            for (std::uint32_t k = 0; k < flux_bounces; ++k)
                value[k] += double(luminance(irradiance[k] * t.albedo)) * surfaces.area;
        }
    });
}

// Reflected flux of bounce k, from samples as they are drawn and from the medoids of clusters, against the adjoint
// computation. The tolerance is three standard errors of what was measured, most of it the points' error, which is
// below 1 % of each bounce at the long size; the short one has a sixteenth of the points and four times the error.
TEST(LightSampling, IndirectFluxPerBounceAgreesWithThePathTracer) {
    for (auto make : {assets::make_cornell, assets::make_four_pillars}) {
        SampledScene world(make);
        // Movers are left out of walks; take them out of the reference too.
        std::vector<ecs::Entity> movers;
        world.registry.view<scene::Mover>().each([&](ecs::Entity e, const scene::Mover&) { movers.push_back(e); });
        for (const ecs::Entity mover : movers)
            world.registry.destroy(mover);
        ASSERT_TRUE(world.rays->update(world.registry, world.meshes));
        const FluxPerBounce traced = flux_of_path_tracer(world, tests::by_size(4096u, 65536u), 4);
        for (const std::uint32_t candidates : {1u, 64u}) {
            const FluxPerBounce walked = flux_of_walks(world, candidates, tests::by_size(4u, 32u));
            for (std::uint32_t k = 0; k < flux_bounces; ++k) {
                std::printf("%u candidates, bounce %u: %+.2f %%, standard errors %.2f and %.2f %%\n", candidates, k + 1,
                            100.0 * (walked.mean[k] / traced.mean[k] - 1.0), 100.0 * walked.error[k] / walked.mean[k],
                            100.0 * traced.error[k] / traced.mean[k]);
                EXPECT_NEAR(walked.mean[k], traced.mean[k], 3.0 * std::hypot(traced.error[k], walked.error[k]))
                    << candidates << " candidates, bounce " << k + 1;
                EXPECT_LT(traced.error[k] / traced.mean[k], tests::by_size(0.06, 0.01)) << "it must be able to fail";
            }
        }
    }
}

} // namespace
} // namespace sunfleck::gi
