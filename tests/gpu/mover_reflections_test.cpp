// What movers reflect: the picture minus the one with the mover black, against the same of the path tracer.
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"
#include "tests/support/traced_picture.h"

#include "assets/mesh_parts.h"

#include <cstdio>

namespace sunfleck::tests {
namespace {

using assets::diffuse;

struct Shape {
    const char* name;
    vec3 colour;
    scene::Mesh (*make)();
    float height; // of its centre above the floor, m
};

const Shape shapes[] = {
    {"red_box", vec3(0.8f, 0.1f, 0.1f), [] { return scene::make_box(vec3(0.7f)); }, 0.36f},
    {"white_box", vec3(0.9f), [] { return scene::make_box(vec3(0.7f)); }, 0.36f},
    {"red_ball", vec3(0.8f, 0.1f, 0.1f), [] { return scene::make_sphere(0.4f, 32, 16); }, 0.45f},
    {"red_figure", vec3(0.8f, 0.1f, 0.1f), [] { return assets::make_figure(1.5f, 12); }, 0.01f},
};

class MoverReflects : public GpuTest, public testing::WithParamInterface<int> {
protected:
    const Shape& shape() const { return shapes[GetParam()]; }
    void add_room(assets::SceneBuilder& scene) {
        const vec3 white(0.75f);
        scene.room(vec3(-2, 0, -2), vec3(2, 2.5f, 2), white, white, {white, white, white, white},
                   {{"lamp", vec2(0.4f, 0.3f), 0.7f, 0.7f, vec3(9.0f)}});
        mover_ = scene.add("mover", shape().make(), diffuse(shape().colour), {vec3(-0.5f, shape().height, -0.7f)});
        scene::Mover line;
        line.path = scene::MoverPath::line;
        line.travel = vec3(0.9f, 0.0f, 0.3f);
        line.spin_period = 5.0f;
        scene.mover(mover_, line);
        scene.camera("view", vec3(1.9f, 1.8f, 1.9f), vec3(-0.5f, 0.7f, -0.6f), 70.0f);
    }
    std::unique_ptr<GpuWorld> make_world(std::uint32_t width) {
        auto world = std::make_unique<GpuWorld>();
        assets::SceneBuilder builder(world->renderer->registry(), world->renderer->meshes());
        add_room(builder);
        world->finish("view");
        world->request.width = width;
        world->request.height = width * 3 / 4;
        return world;
    }
    void paint(GpuWorld& world, vec3 colour) {
        world.renderer->registry().patch<scene::Material>(
            mover_, [&](scene::Material& material) { material.base_colour = colour; });
    }
    // Irradiance by paths; the same random numbers whatever the mover's colour.
    static std::vector<vec3> traced(GpuWorld& world, std::uint32_t samples) {
        const gi::reference::Accumulation sums =
            trace_picture(world, gi::reference::ReferenceView::irradiance, samples);
        std::vector<vec3> result(sums.covered.size(), vec3(0.0f));
        for (std::size_t i = 0; i < result.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                if (sums.covered[i])
                    result[i][int(c)] = float(sums.sums[3 * i + c] / double(sums.samples));
        return result;
    }
    static std::vector<vec3> rendered(GpuWorld& world) {
        std::vector<vec3> result;
        for (const vec4 pixel : world.picture().pixels)
            result.emplace_back(pixel);
        return result;
    }
    // Of pixels that do not show the mover.
    std::vector<std::uint8_t> background(GpuWorld& world) const {
        const shared::CameraRow row = scene::make_camera_row(world.renderer->space().view(world.request.camera),
                                                             world.request.width, world.request.height);
        std::vector<std::uint8_t> result;
        for (std::uint32_t y = 0; y < world.request.height; ++y)
            for (std::uint32_t x = 0; x < world.request.width; ++x) {
                const raytrace::Ray ray{vec3(row.position), shared::camera_ray(row, vec2(x, y) + 0.5f)};
                const auto hit = world.renderer->rays().closest_hit(ray);
                const auto point = hit ? world.renderer->rays().surface(ray, *hit) : raytrace::SurfacePoint{};
                result.push_back(hit && point.entity != mover_ && point.material.emission == vec3(0.0f));
            }
        return result;
    }

    ecs::Entity mover_;
};

struct Sums {
    glm::dvec3 truth{0.0}, found{0.0}, light{0.0}; // reflected by the mover; all light
    void add(vec3 t, vec3 f, vec3 l) { truth += glm::dvec3(t), found += glm::dvec3(f), light += glm::dvec3(l); }
};

// Of all pixels that do not show the mover, and by how much the worst block of 8x8 is off, as a share of its light.
struct ReflectionErrors {
    Sums all;
    double worst = 0.0;
};

// With and without the mover's colour.
using TwoPictures = std::array<std::vector<vec3>, 2>;

void add_reflection_errors(ReflectionErrors& errors, const TwoPictures& truth, const TwoPictures& found,
                           const std::vector<std::uint8_t>& counts, std::uint32_t width) {
    const std::uint32_t height = std::uint32_t(counts.size()) / width;
    for (std::uint32_t y = 0; y < height; y += 8)
        for (std::uint32_t x = 0; x < width; x += 8) {
            Sums block;
            int pixels = 0;
            for (std::uint32_t i = 0; i < 64; ++i) {
                const std::size_t p = std::size_t(y + i / 8) * width + x + i % 8;
                if (!counts[p])
                    continue;
                block.add(truth[0][p] - truth[1][p], found[0][p] - found[1][p], truth[0][p]);
                ++pixels;
            }
            errors.all.add(block.truth, block.found, block.light);
            for (int c = 0; c < 3 && pixels >= 32; ++c)
                errors.worst = std::max(errors.worst, std::abs(block.found[c] - block.truth[c]) / block.light[c]);
        }
}

// With one set of samples, the mean at two places is off by 6 % (standard deviation over seeds): the short size takes
// the mean over four sets at two places, the long one that of one set over 20 places. The worst block is the first
// set's.
TEST_P(MoverReflects, AsMuchAsThePathTracerFinds) {
    const std::uint32_t width = by_size(64u, 96u), steps = by_size(2u, 20u), paths = by_size(128u, 256u);
    const std::uint32_t seeds = by_size(4u, 1u);
    const std::unique_ptr<GpuWorld> world = make_world(width);
    gi::Settings settings;
    settings.mover_share = 0.2f; // half of it, and the worst block is off by up to 0.13
    settings.map_budget = 65536; // the mover is somewhere else at each step
    std::vector<ReflectionErrors> errors(seeds);
    for (std::uint32_t step = 0; step < steps; ++step) {
        world->request.step = 31 + step * (480 / steps);
        TwoPictures truth;
        std::vector<TwoPictures> found(seeds);
        for (const std::size_t black : {0, 1}) {
            paint(*world, black ? vec3(1e-4f) : shape().colour); // not quite, so that it keeps its samples
            for (std::uint32_t seed = 0; seed < seeds; ++seed) {
                settings.seed = 1 + seed;
                world->set(settings);
                for (int frame = 0; frame < 4; ++frame) // light that bounced on walls is followed over some
                    found[seed][black] = rendered(*world);
            }
            truth[black] = traced(*world, paths);
        }
        const std::vector<std::uint8_t> counts = background(*world);
        for (std::uint32_t seed = 0; seed < seeds; ++seed)
            add_reflection_errors(errors[seed], truth, found[seed], counts, width);
    }
    glm::dvec3 ratio(0.0);
    for (const ReflectionErrors& one : errors)
        ratio += one.all.found / one.all.truth / double(seeds);
    const Sums& first = errors[0].all;
    std::printf("%s: reflected by the mover, share of all light: %.4f %.4f %.4f; found of it: %.3f %.3f %.3f; worst "
                "block off by %.3f of its light\n",
                shape().name, first.truth.x / first.light.x, first.truth.y / first.light.y,
                first.truth.z / first.light.z, ratio.x, ratio.y, ratio.z, errors[0].worst);
    for (const ReflectionErrors& one : errors)
        std::printf("  %.3f, worst %.3f\n", one.all.found.x / one.all.truth.x, one.worst);
    for (int c = 0; c < 3; ++c)
        if (first.truth[c] > 0.01 * first.light[c]) {
            EXPECT_NEAR(ratio[c], 1.0, 0.1) << c;
        }
    EXPECT_LT(errors[0].worst, 0.08);
}

TEST_P(MoverReflects, TakesItsLightAlongWhenItGoes) {
    const std::unique_ptr<GpuWorld> world = make_world(32);
    gi::Settings settings;
    settings.mover_share = 0.1f;
    world->set(settings);
    ecs::Registry& registry = world->renderer->registry();
    assets::SceneBuilder builder(registry, world->renderer->meshes());
    const ecs::Entity other = builder.box("other", vec3(1.2f, 0.0f, 1.2f), vec3(1.5f, 0.3f, 1.5f), diffuse(vec3(0.5f)));
    builder.mover(other, {});
    scene::update_world_transforms(registry);
    ASSERT_TRUE(world->renderer->upload_meshes());
    world->render();
    const auto light_of = [&](ecs::Entity mover) {
        vec3 sum(0.0f);
        for (const gi::LightSample& sample : world->renderer->lighting().samples())
            sum += sample.emitter == mover && sample.dynamic ? sample.flux : vec3(0.0f);
        return luminance(sum);
    };
    EXPECT_GT(light_of(mover_), 0.0f);
    EXPECT_GT(light_of(other), 0.0f);
    const std::uint64_t samples = world->renderer->lighting().sample_set().generation();
    registry.destroy(mover_);
    for (int frame = 0; frame < 5; ++frame)
        world->render();
    EXPECT_EQ(light_of(mover_), 0.0f);
    EXPECT_GT(light_of(other), 0.0f);
    EXPECT_EQ(world->renderer->lighting().sample_set().generation(), samples); // the others were not made again
}

INSTANTIATE_TEST_SUITE_P(Anywhere, MoverReflects, testing::Range(0, int(std::size(shapes))),
                         [](const testing::TestParamInfo<int>& one) { return std::string(shapes[one.param].name); });

} // namespace
} // namespace sunfleck::tests
