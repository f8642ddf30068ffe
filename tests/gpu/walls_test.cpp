// The default sampler, held to the path tracer wall by wall: the light of its samples with shadows traced by rays, so
// that neither maps nor techniques have a part in it.
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"

#include "engine/core/jobs.h"
#include "gi_module/reference/path_tracer.h"

#include <cmath>
#include <cstdio>

namespace sunfleck::tests {
namespace {

class AnywhereSampler : public GpuTest {};

// What moves stands still: it blocks and reflects light like walls, in both.
struct StillWorld : GpuWorld {
    explicit StillWorld(void (*make)(assets::SceneBuilder&)) {
        ecs::Registry& registry = renderer->registry();
        {
            assets::SceneBuilder builder(registry, renderer->meshes());
            make(builder);
        }
        std::vector<ecs::Entity> movers;
        registry.view<scene::Mover>().each([&](ecs::Entity entity, const scene::Mover&) { movers.push_back(entity); });
        for (const ecs::Entity mover : movers)
            registry.remove<scene::Mover>(mover);
        finish("view");
        request.width = 64;
        request.height = 48;
    }
};

struct WallPoint {
    vec3 position{0.0f}, normal{0.0f}, shading_normal{0.0f};
    std::size_t wall = 0;
    double truth = 0.0; // irradiance, W/m2
};

double grey(vec3 light) {
    return double(light.x + light.y + light.z) / 3.0;
}

// Of one wall or of all.
struct WallLight {
    double sum = 0.0, truth = 0.0;
};

// Points of the picture on walls: pixels of one normal that are 2 % of the picture or more.
class Walls {
public:
    Walls(StillWorld& world, std::uint32_t paths) : world_(world) {
        world.render();
        viewer::SceneRenderer& renderer = *world.renderer;
        const gi::reference::PathTracer tracer(
            renderer.rays(), gi::collect_emitters(renderer.registry(), renderer.meshes(),
                                                  renderer.gpu_scene().static_bounds(), {}, renderer.space()));
        const scene::CameraView camera = renderer.space().view(world.request.camera);
        gi::reference::ReferenceSettings settings;
        settings.width = world.request.width;
        settings.height = world.request.height;
        settings.view = gi::reference::ReferenceView::irradiance;
        gi::reference::Accumulation truth;
        tracer.accumulate(truth, camera, settings, paths);
        find_points(camera, truth);
    }
    std::size_t count() const { return count_; }
    // Of each wall, by the world's samples. Adds to `squares` the mean square error of all points over the square of
    // their mean.
    std::vector<WallLight> light(double& squares) const {
        std::vector<double> at(points_.size());
        parallel_for_chunks(points_.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                at[i] = light_at(points_[i]);
        });
        std::vector<WallLight> walls(count_);
        double errors = 0.0, mean = 0.0;
        for (std::size_t i = 0; i < at.size(); ++i) {
            walls[points_[i].wall].sum += at[i];
            walls[points_[i].wall].truth += points_[i].truth;
            errors += std::pow(at[i] - points_[i].truth, 2.0);
            mean += points_[i].truth;
        }
        squares += errors * double(at.size()) / (mean * mean);
        return walls;
    }

private:
    void find_points(const scene::CameraView& camera, const gi::reference::Accumulation& truth) {
        const shared::CameraRow row = scene::make_camera_row(camera, truth.width, truth.height);
        const raytrace::RayScene& rays = world_.renderer->rays();
        std::vector<std::vector<WallPoint>> found;
        for (std::uint32_t i = 0; i < truth.width * truth.height; ++i) {
            const std::uint32_t line = i / truth.width;
            const vec2 pixel(float(i % truth.width) + 0.5f, float(line) + 0.5f);
            const raytrace::Ray view{vec3(row.position), shared::camera_ray(row, pixel), 0.0f, 1e30f};
            const auto hit = rays.closest_hit(view);
            if (!hit || !truth.covered[i])
                continue;
            const raytrace::SurfacePoint point = rays.surface(view, *hit);
            const float side = glm::dot(point.geometric_normal, view.direction) < 0.0f ? 1.0f : -1.0f;
            const vec3 normal = side * point.geometric_normal;
            auto wall = std::find_if(found.begin(), found.end(), [&](const std::vector<WallPoint>& points) {
                return glm::dot(points.front().normal, normal) > 0.999f;
            });
            if (wall == found.end())
                wall = found.insert(found.end(), std::vector<WallPoint>());
            const double* sums = &truth.sums[3 * std::size_t(i)];
            wall->push_back({point.on_triangle + point.offset * normal, normal, side * point.shading_normal, 0,
                             (sums[0] + sums[1] + sums[2]) / (3.0 * truth.samples)});
        }
        for (std::vector<WallPoint>& wall : found) {
            if (50 * wall.size() < truth.covered.size())
                continue;
            for (WallPoint& point : wall)
                point.wall = count_, points_.push_back(point);
            ++count_;
        }
    }

    double light_at(const WallPoint& point) const {
        const gi::System& lighting = world_.renderer->lighting();
        const raytrace::RayScene& rays = world_.renderer->rays();
        const float far = 4.0f * glm::length(world_.renderer->gpu_scene().bounds().extent());
        double sum = 0.0;
        for (const gi::LightSample& sample : lighting.samples()) {
            const shared::LightRow& row = lighting.sample_set().rows()[sample.index];
            const vec3 axis(row.normal_offset), v = point.position - vec3(row.position_bound);
            const bool parallel = sample.kind == gi::SampleKind::directional;
            const vec3 to_light = parallel ? -far * axis : -v;
            const double cosine = double(glm::dot(point.shading_normal, glm::normalize(to_light)));
            if (!(cosine > 0.0) || !(glm::dot(point.normal, to_light) > 0.0f) ||
                rays.occluded(raytrace::Ray{point.position, to_light, 0.0f, 0.9999f}))
                continue;
            double term = cosine;
            if (!parallel) {
                const double square = double(glm::dot(v, v)), along = double(glm::dot(axis, v)) / std::sqrt(square);
                const double cone =
                    std::clamp(along * double(row.tangent_scale.w) + double(row.normal_offset.w), 0.0, 1.0);
                term = sample.kind == gi::SampleKind::surface
                           ? std::min(cosine * std::max(along, 0.0) / square, double(row.position_bound.w))
                           : cosine * cone * cone / square;
            }
            sum += term * grey(vec3(row.intensity_slot));
        }
        return sum;
    }

    StillWorld& world_;
    std::vector<WallPoint> points_;
    std::size_t count_ = 0;
};

gi::Settings sampler(std::uint32_t lights, std::uint32_t candidates, std::uint32_t seed) {
    gi::Settings settings = plain_light();
    settings.lights = lights;
    settings.candidates = candidates;
    settings.seed = seed;
    settings.shadows = false; // rays find them
    return settings;
}

struct SamplerErrors {
    double worst = 0.0;   // of any wall, in the mean over seeds
    double off = 0.0;     // share of walls and seeds that are off by more than 6 %
    double squares = 0.0; // relative MSE of all points
};

SamplerErrors errors_of(StillWorld& world, const Walls& walls, std::uint32_t lights, std::uint32_t candidates,
                        std::uint32_t seeds) {
    SamplerErrors errors;
    std::vector<double> mean(walls.count());
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        world.set(sampler(lights, candidates, seed));
        world.render();
        const std::vector<WallLight> light = walls.light(errors.squares);
        for (std::size_t w = 0; w < light.size(); ++w) {
            const double error = light[w].sum / light[w].truth - 1.0;
            mean[w] += error / seeds;
            errors.off += std::abs(error) > 0.06 ? 1.0 / (seeds * double(walls.count())) : 0.0;
        }
    }
    for (const double error : mean)
        errors.worst = std::max(errors.worst, std::abs(error));
    errors.squares /= seeds;
    return errors;
}

struct SamplerCase {
    const char* name;
    void (*make)(assets::SceneBuilder&);
    double most;                // of SamplerErrors::worst
    double most_of_walks = 0.9; // of SamplerErrors::squares, as a share of that of plain walks
};

// The aim is 3 % of each wall's light in the mean over seeds, and at most 6 % in 95 % of single seeds, which reflected
// light does not reach everywhere: medoids stand for their clusters with an error that seeds share, and the bound of
// the geometry term takes more from corners than from the middle of a room. The limits are what was measured in the
// long size, and a fifth more at most; they guard what is there and do not say that it is enough. Clusters have less
// than 0.9 of the squared error of plain walks in each room but lantern_house (0.91), and less than half in the
// geometric mean.
TEST_F(AnywhereSampler, WallsAreAsBrightAsThePathTracerSays) {
    const SamplerCase cases[] = {{"cornell", assets::make_cornell, 0.03},
                                 {"area_room", assets::make_area_room, 0.061},
                                 {"table_room", assets::make_table_room, 0.01},
                                 {"four_pillars", assets::make_four_pillars, 0.029},
                                 {"near_occluder", assets::make_near_occluder, 0.023},
                                 {"gallery", assets::make_gallery, 0.057},
                                 {"chamber", assets::make_chamber, 0.085},
                                 {"classroom", assets::make_classroom, 0.034},
                                 {"office", assets::make_office, 0.045},
                                 {"atrium", assets::make_atrium, 0.077},
                                 {"hall", assets::make_hall, 0.041},
                                 {"gap_room", assets::make_gap_room, 0.075},
                                 {"lantern_house", assets::make_lantern_house, 0.087, 1.0},
                                 {"lantern_game", assets::make_lantern_game, 0.057}};
    constexpr std::uint32_t seeds = 32; // 8 do not tell 1.7 % from 4.5 %, where rays are rounded otherwise
    double logarithms = 0.0;
    const auto tested = std::span(cases).first(by_size<std::size_t>(4, std::size(cases)));
    for (const SamplerCase& one : tested) {
        StillWorld world(one.make);
        world.set(sampler(300, 64, 1));
        const Walls walls(world, by_size(256u, 1024u));
        ASSERT_GT(walls.count(), 1u);
        const SamplerErrors clusters = errors_of(world, walls, 300, 64, seeds),
                            walks = errors_of(world, walls, 300, 1, seeds);
        std::printf(
            "%s: worst wall %.1f %% in the mean, %.0f %% off by more than 6 %%, relative MSE %.4f, of plain walks "
            "%.4f\n",
            one.name, 100.0 * clusters.worst, 100.0 * clusters.off, clusters.squares, walks.squares);
        EXPECT_LT(clusters.worst, one.most) << one.name;
        EXPECT_LT(clusters.squares, one.most_of_walks * walks.squares) << one.name;
        logarithms += std::log(clusters.squares / walks.squares);
        if (!long_size())
            continue;
        const SamplerErrors more = errors_of(world, walls, 1024, 64, seeds);
        std::printf("  with 1,024: worst wall %.1f %%, %.0f %% off, relative MSE %.4f\n", 100.0 * more.worst,
                    100.0 * more.off, more.squares);
        EXPECT_LT(more.squares, clusters.squares) << one.name;
    }
    const double geometric_mean = std::exp(logarithms / double(tested.size()));
    std::printf("squared error over that of plain walks, geometric mean: %.2f\n", geometric_mean);
    EXPECT_LT(geometric_mean, 0.5);
}

} // namespace
} // namespace sunfleck::tests
