// Lamps that are small for their distance, with few samples: what is near to them must not go without their light.
#include "tests/support/techniques.h"
#include "tests/support/traced_picture.h"

#include <cstdio>

namespace sunfleck::tests {
namespace {

constexpr std::uint32_t paths = 256; // a pixel: 1 % of noise there, a fiftieth of that in a mean

class SmallLamps : public GpuTest {
protected:
    static void add_room(assets::SceneBuilder& scene, vec3 lamp) {
        const vec3 white(0.7f);
        scene.room(vec3(-3, 0, -3), vec3(3, 3, 3), white, white, {white, white, white, white},
                   {{"lamp", vec2(0.5f, 0.3f), 1.2f, 1.2f, lamp}});
    }
    // Direct light by paths; alpha 0 where nothing is lit.
    static std::vector<vec4> traced(GpuWorld& world) {
        const gi::reference::Accumulation sums = trace_picture(world, gi::reference::ReferenceView::direct, paths);
        std::vector<vec4> result;
        for (std::size_t i = 0; i < sums.covered.size(); ++i)
            result.emplace_back(vec3(sums.sums[3 * i], sums.sums[3 * i + 1], sums.sums[3 * i + 2]) / float(paths),
                                float(sums.covered[i]));
        return result;
    }

    struct Errors {
        double mean = 0.0, relative = 0.0; // ratio of means; relative mean squared error
    };
    // Of the luminance at pixels where it is at least `share` of the brightest.
    static Errors errors_of(const io::Picture& picture, const std::vector<vec4>& truth, float share) {
        float brightest = 0.0f;
        for (const vec4& pixel : truth)
            brightest = std::max(brightest, pixel.w * luminance(vec3(pixel)));
        double found = 0.0, expected = 0.0, squares = 0.0, of_truth = 0.0;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const double right = double(luminance(vec3(truth[i]))), shown = double(luminance(vec3(picture.pixels[i])));
            if (truth[i].w == 0.0f || picture.pixels[i].w == 0.0f || right < double(share * brightest))
                continue;
            found += shown;
            expected += right;
            squares += (shown - right) * (shown - right);
            of_truth += right * right;
        }
        return {found / expected, squares / of_truth};
    }
    // The bounds hold for each seed and technique.
    static void expect_truth(GpuWorld& world, float share, Errors bounds) {
        const std::vector<vec4> truth = traced(world);
        for (const std::string_view technique : techniques_for_all_light())
            for (std::uint32_t seed = 1; seed <= 3; ++seed) {
                gi::Settings settings = gi::Settings().all_light_by(technique);
                settings.with("indirect", "none");
                settings.lights = 200;
                settings.seed = seed;
                world.set(settings);
                const Errors errors = errors_of(world.picture(), truth, share);
                std::printf("%s, seed %u: mean %.3f, relative error %.4f\n", std::string(technique).c_str(), seed,
                            errors.mean, errors.relative);
                EXPECT_NEAR(errors.mean, 1.0, bounds.mean) << technique << seed;
                EXPECT_LE(errors.relative, bounds.relative) << technique << seed;
            }
    }
};

// The pool of light round a ball that may roll away: nearly all of it comes from the ball, whose shadow of the
// ceiling's lamp has few samples. With samples on its surface, and the bound of the whole scene's samples, the mean was
// half of the truth.
TEST_F(SmallLamps, ABallLightsTheFloorThatItLiesOn) {
    GpuWorld world(
        [](assets::SceneBuilder& scene) {
            add_room(scene, vec3(4.0f));
            scene::AreaLight ball;
            ball.shape = scene::AreaShape::sphere;
            ball.radius = 0.2f;
            ball.radiance = vec3(13.0f, 5.0f, 1.0f);
            scene::Transform transform;
            transform.position = vec3(-0.6f, ball.radius, 0.4f);
            scene.mover(scene.area_light("ball", ball, transform), {});
            scene.camera("view", vec3(0.8f, 1.3f, 1.6f), vec3(-0.6f, 0.1f, 0.4f), 50.0f);
        },
        "view");
    expect_truth(world, 0.1f, {0.05, 0.02});
}

// A lamp that moves, as large as a hand, before a wall: two thirds of the truth with the bound of the whole scene's
// samples.
TEST_F(SmallLamps, ALampLightsTheWallBeforeIt) {
    GpuWorld world(
        [](assets::SceneBuilder& scene) {
            add_room(scene, vec3(4.0f));
            scene::AreaLight disc;
            disc.shape = scene::AreaShape::disc;
            disc.radius = 0.08f;
            disc.radiance = vec3(90.0f, 70.0f, 50.0f);
            scene::Transform transform;
            transform.position = vec3(-0.4f, 1.2f, -2.75f);
            transform.rotation = assets::facing(vec3(0.0f, 0.0f, -1.0f));
            scene.mover(scene.area_light("disc", disc, transform), {});
            scene.camera("view", vec3(1.2f, 1.6f, -1.4f), vec3(-0.4f, 1.2f, -3.0f), 50.0f);
        },
        "view");
    expect_truth(world, 0.1f, {0.05, 0.02});
}

} // namespace
} // namespace sunfleck::tests
