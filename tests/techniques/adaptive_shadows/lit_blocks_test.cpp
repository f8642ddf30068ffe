// Lights are added in the blocks of the picture that they may reach, and in no others: the sum is that of all.
#include "tests/support/gpu_world.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

namespace sunfleck::tests {
namespace {

class LitBlocks : public GpuTest {};

// 75 spots, of which some light less than a block of pixels and some nearly a hemisphere, point lights, one of them
// dark, and a sun: more than are lit at once.
void make_many_lamps(assets::SceneBuilder& builder) {
    std::mt19937 random(5);
    const auto uniform = [&](float low, float high) {
        return low + (high - low) * float(random() >> 8) / float(1u << 24);
    };
    assets::make_four_pillars(builder);
    for (int i = 0; i < 75; ++i) {
        scene::Transform place;
        place.position = vec3(uniform(-2.5f, 2.5f), uniform(0.3f, 2.2f), uniform(-2.5f, 2.5f));
        const float up = uniform(-1.0f, 1.0f), angle = uniform(0.0f, glm::two_pi<float>());
        const float across = std::sqrt(1.0f - up * up);
        place.rotation = assets::facing(vec3(across * std::cos(angle), up, across * std::sin(angle)));
        const float outer = i % 5 == 0 ? uniform(1.4f, 1.55f) : std::pow(uniform(0.02f, 1.0f), 2.0f);
        builder.spot_light("spot", place, {vec3(uniform(0.5f, 2.0f)), 0.7f * outer, outer});
    }
    builder.point_light("lamp", vec3(0.4f, 1.5f, 0.3f), vec3(0.7f, 0.2f, 0.1f));
    builder.point_light("dark lamp", vec3(-0.4f, 1.5f, 0.3f), vec3(0.0f));
    const ecs::Entity sun = builder.registry().create();
    scene::Transform high;
    high.rotation = assets::facing(glm::normalize(vec3(0.3f, 1.0f, 0.2f)));
    builder.registry().emplace<scene::Transform>(sun, high);
    builder.registry().emplace<scene::DirectionalLight>(sun, {vec3(0.3f)});
}

TEST_F(LitBlocks, AddUpToAllLights) {
    GpuWorld world(make_many_lamps, "bench_1");
    world.request.width = 333; // no whole number of blocks
    world.request.height = 187;
    for (int place = 0; place < 3; ++place) {
        gi::Settings settings;
        settings.with("direct", "none").with("indirect", "none").with("punctual_lights", "100");
        settings.shadows = false;
        settings.with("punctual", "brute_force");
        world.set(settings);
        const io::Picture all = world.picture();
        settings.with("punctual", "adaptive_shadows");
        world.set(settings);
        const io::Picture blocks = world.picture();
        EXPECT_GT(world.renderer->lighting().counters()["punctual_lights"], 70.0);
        float worst = 0.0f, brightest = 0.0f;
        for (std::size_t i = 0; i < all.pixels.size(); ++i) {
            const vec3 a(all.pixels[i]), b(blocks.pixels[i]);
            brightest = std::max(brightest, a.g);
            worst = std::max(worst, glm::length(a - b) / (glm::length(a) + 1e-4f));
        }
        EXPECT_GT(brightest, 0.05f);
        // Six passes add to a picture of half floats, and brute force rounds once.
        EXPECT_LE(worst, 7.0f / 2048.0f) << "place " << place;
        world.request.camera.position += vec3(0.3f, -0.2f, 0.35f);
    }
}

} // namespace
} // namespace sunfleck::tests
