// Lamps that move have few light samples, and low bounds of the geometry term: what these take away is given back.
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"

#include "engine/core/random.h"

#include <cstdio>

namespace sunfleck::tests {
namespace {

constexpr float albedo = 0.8f, ball_radius = 0.1f, ball_radiance = 40.0f;

// A closed white room, a ball that shines and moves, and a light that stays.
void make_room_of_a_ball(assets::SceneBuilder& scene) {
    scene.add("room", scene::make_room(vec3(2.0f)), assets::diffuse(vec3(albedo)));
    scene::AreaLight ball;
    ball.shape = scene::AreaShape::sphere;
    ball.radius = ball_radius;
    ball.radiance = vec3(ball_radiance);
    scene::Mover circle;
    circle.path = scene::MoverPath::circle;
    scene.mover(scene.area_light("ball", ball, {}), circle);
    scene.point_light("bulb", vec3(0.0f, 0.8f, 0.0f), vec3(1.0f));
    scene.camera("view", vec3(0.3f, -0.2f, 0.4f), vec3(-0.5f, 0.1f, -1.0f), 70.0f);
}

// Luminance of one sample's irradiance on a wall of a convex room.
double irradiance(const shared::LightRow& row, vec3 point, vec3 normal) {
    const vec3 v = point - vec3(row.position_bound);
    const double squared = double(glm::dot(v, v)), along = double(glm::dot(vec3(row.normal_offset), v)),
                 facing = -double(glm::dot(normal, v));
    const double term = std::max(along, 0.0) * std::max(facing, 0.0) / (squared * squared);
    return double(luminance(vec3(row.intensity_slot))) * std::min(term, double(row.position_bound.w));
}

// What arrives of the moving lamp's reflected light on the walls of a cube, W: its closed form at points of the walls,
// which have nothing to do with the rays by which losses are found.
double arriving(const gi::SampleSet& samples, const Bounds& room) {
    constexpr std::uint32_t points = 1024; // a wall
    double sum = 0.0;
    for (std::uint32_t k = 0; k < 6 * points; ++k) {
        const RandomSequence random(SequenceKind::sobol, k % 6, k / 6);
        const int axis = int(k % 6) / 2;
        vec3 place(k % 2 ? 1.0f : 0.0f), normal(0.0f);
        place[(axis + 1) % 3] = random.at(0);
        place[(axis + 2) % 3] = random.at(1);
        normal[axis] = k % 2 ? -1.0f : 1.0f;
        const vec3 point = room.minimum + place * room.extent();
        for (const gi::LightSample& sample : samples.samples())
            if (sample.dynamic && sample.bounce > 0)
                sum += irradiance(samples.rows()[sample.index], point, normal);
    }
    return sum / points * double(room.extent().x * room.extent().x);
}

class GivenBack : public GpuTest {};

// In a closed room all light arrives, reflected up to five times. A lamp's thirty samples carry what they should to a
// few percent, which is why the mean of eight seeds is judged.
TEST_F(GivenBack, AllLightOfALampThatMovesArrives) {
    constexpr std::uint32_t seeds = 8;
    GpuWorld world(make_room_of_a_ball, "view");
    ecs::Registry& registry = world.renderer->registry();
    gi::Settings settings = plain_light();
    settings.lights = 200;
    double reflections = 0.0, power = 1.0, mean = 0.0;
    for (std::uint32_t bounce = 1; bounce <= settings.bounces; ++bounce)
        reflections += power *= double(albedo);
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        settings.seed = seed;
        world.set(settings);
        world.render();
        registry.patch<scene::Transform>(scene::find_by_name(registry, "ball"), [&](scene::Transform& place) {
            place.position = vec3(0.2f * float(seed) - 0.9f, -0.6f, 0.3f);
        });
        scene::update_world_transforms(registry);
        world.render();
        const double radius = double(ball_radius / world.renderer->space().unit),
                     flux = 4.0 * double(pi * pi * ball_radiance) * radius * radius;
        const double share =
            arriving(world.renderer->lighting().sample_set(), world.renderer->gpu_scene().static_bounds()) /
            (flux * reflections);
        std::printf("seed %u: %.4f\n", seed, share);
        mean += share / seeds;
    }
    std::printf("mean %.4f\n", mean);
    EXPECT_NEAR(mean, 1.0, 0.03);
}

} // namespace
} // namespace sunfleck::tests
