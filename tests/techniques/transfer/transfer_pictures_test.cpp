// Movers lit by precomputed transfer, in pictures.
#include "gi_module/reference/path_tracer.h"
#include "gi_module/transfer/transfer_settings.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

namespace sunfleck::tests {
namespace {

class TransferTest : public GpuTest {};

constexpr std::uint32_t width = 120, height = 90;

// A ball that a shadow's edge crosses (thesis fig. 4-14): a lamp overhead, behind the edge of a board.
void make_edge(assets::SceneBuilder& scene) {
    scene.quad("floor", vec3(-3, 0, -3), vec3(0, 0, 6), vec3(6, 0, 0), assets::diffuse(vec3(0.6f)));
    scene.quad("board", vec3(0, 2, -3), vec3(0, 0, 6), vec3(3, 0, 0), assets::diffuse(vec3(0.4f)));
    const ecs::Entity ball = scene.add("ball", scene::make_sphere(0.6f, 48, 24), assets::diffuse(vec3(0.8f)));
    scene.registry().emplace_or_replace<scene::Transform>(ball, scene::Transform{vec3(0.0f, 0.9f, 0.0f)});
    scene.registry().emplace_or_replace<scene::Mover>(ball, scene::Mover{});
    scene.ceiling_light("lamp", vec3(0.3f, 4.0f, 0.0f), 1.0f, 1.0f, vec3(20.0f));
    scene.camera("view", vec3(0.0f, 2.0f, 3.2f), vec3(0.0f, 0.8f, 0.0f), 40.0f);
}

// Irradiance by the path tracer.
std::vector<vec4> traced(GpuWorld& world, std::uint32_t bounces, std::uint32_t samples) {
    const Bounds bounds = viewer::scene_bounds(world.renderer->registry(), world.renderer->meshes());
    const auto rays = raytrace::RayScene::create().value(); // in the world's space
    EXPECT_TRUE(rays->update(world.renderer->registry(), world.renderer->meshes()));
    const gi::reference::PathTracer tracer(
        *rays, gi::collect_emitters(world.renderer->registry(), world.renderer->meshes(), bounds));
    gi::reference::ReferenceSettings settings;
    settings.width = width;
    settings.height = height;
    settings.bounces = bounces;
    settings.view = gi::reference::ReferenceView::irradiance;
    settings.antialiasing = false;
    gi::reference::Accumulation sums;
    tracer.accumulate(sums, world.request.camera, settings, samples, {});
    std::vector<vec4> result(sums.covered.size(), vec4(0.0f));
    for (std::size_t i = 0; i < result.size(); ++i)
        for (int c = 0; c < 3; ++c)
            result[i][c] = float(sums.sums[3 * i + std::size_t(c)] / double(sums.samples));
    return result;
}

// Pixels whose centre shows the entity.
std::vector<std::size_t> pixels_of(GpuWorld& world, const std::string& name) {
    const ecs::Entity entity = scene::find_by_name(world.renderer->registry(), name);
    const shared::CameraRow camera =
        scene::make_camera_row(world.renderer->space().view(world.request.camera), width, height);
    std::vector<std::size_t> pixels;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const raytrace::Ray ray{vec3(camera.position),
                                    shared::camera_ray(camera, vec2(float(x) + 0.5f, float(y) + 0.5f))};
            const auto hit = world.renderer->rays().closest_hit(ray);
            if (hit && world.renderer->rays().surface(ray, *hit).entity == entity)
                pixels.push_back(std::size_t(y) * width + x);
        }
    return pixels;
}

struct Error {
    double relative_mean = 0, relative_root_mean_square = 0;
};

Error error_of(const std::vector<vec4>& picture, const std::vector<vec4>& truth,
               const std::vector<std::size_t>& pixels) {
    double sum = 0, sum_truth = 0, squares = 0, squares_truth = 0;
    for (const std::size_t i : pixels) {
        const double a = double(luminance(vec3(picture[i]))), b = double(luminance(vec3(truth[i])));
        sum += a;
        sum_truth += b;
        squares += (a - b) * (a - b);
        squares_truth += b * b;
    }
    return {sum / sum_truth - 1.0, std::sqrt(squares / squares_truth)};
}

std::size_t changed_pixels(const io::Picture& a, const io::Picture& b, const std::vector<std::size_t>& leave_out) {
    std::vector<std::uint8_t> counts(a.pixels.size(), 1);
    for (const std::size_t i : leave_out)
        counts[i] = 0;
    std::size_t changed = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        changed += counts[i] && a.pixels[i] != b.pixels[i];
    return changed;
}

TEST_F(TransferTest, SeveralPointsLetAShadowCrossAMover) {
    GpuWorld world(make_edge, "view");
    world.request.width = width;
    world.request.height = height;
    gi::Settings settings;
    settings.with("indirect", "none");
    settings.lights = 100;
    settings.shadow_map_resolution = 512;
    settings.low_resolution = 1;
    settings.of<gi::TransferSettings>().transfer_reflections = 0;
    world.set(settings);
    const io::Picture per_pixel = world.picture();
    const std::vector<vec4> truth = traced(world, 0, by_size(64, 512));
    const std::vector<std::size_t> ball = pixels_of(world, "ball");
    ASSERT_GT(ball.size(), 500u);
    settings.with("movers", "prt");
    std::map<std::uint32_t, Error> errors;
    for (const std::uint32_t points : {1u, 4u, 6u}) {
        settings.of<gi::TransferSettings>().transfer_points = points;
        world.set(settings);
        const io::Picture picture = world.picture();
        EXPECT_GT(world.renderer->lighting().counters()["transfer_vertices"], 0u);
        errors[points] = error_of(picture.pixels, truth, ball);
        std::printf("%u points a side: mean %+.3f, root mean square %.3f\n", points, errors[points].relative_mean,
                    errors[points].relative_root_mean_square);
        // The rest of the picture is as it was.
        EXPECT_LT(changed_pixels(picture, per_pixel, ball), 20u) << "pixels at the ball's outline";
    }
    EXPECT_LT(errors[4].relative_root_mean_square, 0.5 * errors[1].relative_root_mean_square);
    EXPECT_LT(errors[6].relative_root_mean_square, errors[4].relative_root_mean_square);
    EXPECT_LT(std::abs(errors[6].relative_mean), 0.03);
}

// The whole light of a room on a knot, with its own shadows and reflections, against the path tracer.
TEST_F(TransferTest, AKnotInARoomIsAsThePathTracerSees) {
    GpuWorld world(assets::make_table_room, "bench_2");
    world.request.width = width;
    world.request.height = height;
    gi::Settings settings;
    settings.lights = 2000;
    settings.direct_share = 0.5f;
    settings.shadow_map_resolution = 64;
    settings.with("movers", "prt");
    world.set(settings);
    const io::Picture picture = world.picture();
    std::string name;
    world.renderer->registry().view<scene::Name, scene::Mover, scene::MeshInstance>().each(
        [&](ecs::Entity, const scene::Name& n, const scene::Mover&, const scene::MeshInstance& mesh) {
            if (world.renderer->meshes()[mesh.mesh].triangle_count() > 1000)
                name = n.name;
        });
    const std::vector<std::size_t> knot = pixels_of(world, name);
    ASSERT_GT(knot.size(), 80u);
    const std::vector<vec4> truth = traced(world, 5, by_size(64, 1024)); // their noise is in the root
    const Error error = error_of(picture.pixels, truth, knot);
    std::printf("%zu pixels: mean %+.3f, root mean square %.3f\n", knot.size(), error.relative_mean,
                error.relative_root_mean_square);
    EXPECT_LT(std::abs(error.relative_mean), 0.03);
    EXPECT_LT(error.relative_root_mean_square, 0.1);
}

} // namespace
} // namespace sunfleck::tests
