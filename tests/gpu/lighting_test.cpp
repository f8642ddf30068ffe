// Light at single pixels against closed forms.
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"

#include <cmath>

namespace sunfleck::tests {
namespace {

class Lighting : public GpuTest {};

// A floor of 8 m by 8 m at y = 0, seen from above.
void add_floor(GpuWorld& world) {
    assets::SceneBuilder builder(world.renderer->registry(), world.renderer->meshes());
    builder.quad("floor", vec3(-4, 0, -4), vec3(0, 0, 8), vec3(8, 0, 0), assets::diffuse(vec3(0.5f)));
    builder.camera("view", vec3(0.5f, 5.0f, 2.0f), vec3(0.2f, 0.0f, 0.1f), 60.0f);
}

gi::Settings one_light() {
    gi::Settings settings = plain_light();
    settings.lights = 1;
    settings.with("indirect", "none");
    return settings;
}

// Calls check(irradiance, position) for every pixel that shows the floor.
template <typename Check>
void each_floor_pixel(GpuWorld& world, Check&& check) {
    const io::Picture picture = world.picture();
    const shared::CameraRow camera = scene::make_camera_row(world.request.camera, picture.width, picture.height);
    int pixels = 0;
    for (std::uint32_t y = 0; y < picture.height; ++y)
        for (std::uint32_t x = 0; x < picture.width; ++x) {
            const vec4 pixel = picture.pixels[y * picture.width + x];
            const vec3 ray = shared::camera_ray(camera, vec2(float(x) + 0.5f, float(y) + 0.5f));
            const vec3 origin(camera.position);
            const vec3 position = origin - ray * (origin.y / ray.y);
            if (pixel.w == 0.0f || std::max(std::abs(position.x), std::abs(position.z)) > 3.99f)
                continue;
            ++pixels;
            check(vec3(pixel), position);
        }
    EXPECT_GT(pixels, 500);
}

TEST_F(Lighting, PointLightOnAPlane) {
    GpuWorld world;
    add_floor(world);
    const ecs::Entity light = world.renderer->registry().create();
    scene::Transform transform;
    transform.position = vec3(0.7f, 1.5f, -0.4f);
    world.renderer->registry().emplace<scene::Transform>(light, transform);
    world.renderer->registry().emplace<scene::PointLight>(light, {vec3(10.0f, 5.0f, 1.0f)});
    world.finish();
    world.set(one_light());
    each_floor_pixel(world, [&](vec3 irradiance, vec3 position) {
        const vec3 v = transform.position - position;
        const float expected = v.y / std::pow(glm::dot(v, v), 1.5f);
        EXPECT_NEAR(irradiance.x / (10.0f * expected), 1.0f, 1e-3f);
        EXPECT_NEAR(irradiance.z / expected, 1.0f, 1e-3f);
    });
}

TEST_F(Lighting, SpotLightOnAPlane) {
    GpuWorld world;
    add_floor(world);
    const ecs::Entity light = world.renderer->registry().create();
    scene::Transform transform;
    transform.position = vec3(-0.5f, 2.0f, 0.3f);
    transform.rotation = assets::facing(vec3(-0.2f, 1.0f, 0.1f));
    world.renderer->registry().emplace<scene::Transform>(light, transform);
    world.renderer->registry().emplace<scene::SpotLight>(light, {vec3(8.0f), 0.3f, 0.6f});
    world.finish();
    world.set(one_light());
    const vec3 axis = -glm::normalize(vec3(-0.2f, 1.0f, 0.1f));
    float brightest = 0;
    each_floor_pixel(world, [&](vec3 irradiance, vec3 position) {
        const vec3 v = transform.position - position;
        const float cosine = glm::dot(-glm::normalize(v), axis);
        const float falloff = std::clamp((cosine - std::cos(0.6f)) / (std::cos(0.3f) - std::cos(0.6f)), 0.0f, 1.0f);
        const float expected = 8.0f * falloff * falloff * v.y / std::pow(glm::dot(v, v), 1.5f);
        // Where the falloff is steep, a rounding of the cosine is magnified: an absolute part in the tolerance.
        EXPECT_NEAR(irradiance.x, expected, 1e-3f * expected + 2e-5f);
        brightest = std::max(brightest, irradiance.x);
    });
    EXPECT_GT(brightest, 1.5f);
}

TEST_F(Lighting, DirectionalLightOnAPlane) {
    GpuWorld world;
    add_floor(world);
    const ecs::Entity light = world.renderer->registry().create();
    scene::Transform transform;
    transform.rotation = assets::facing(vec3(0.5f, 1.0f, -0.3f));
    world.renderer->registry().emplace<scene::Transform>(light, transform);
    world.renderer->registry().emplace<scene::DirectionalLight>(light, {vec3(3.0f)});
    world.finish();
    world.set(one_light());
    const float expected = 3.0f * glm::normalize(vec3(0.5f, 1.0f, -0.3f)).y;
    each_floor_pixel(world, [&](vec3 irradiance, vec3) { EXPECT_NEAR(irradiance.x / expected, 1.0f, 1e-3f); });
}

// Irradiance of a polygon, by Lambert's formula: radiance / 2 times the sum over edges of angle times cosine.
double polygon_irradiance(const std::vector<vec3>& corners, vec3 position, vec3 normal) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(glm::dvec3(corners[i] - position));
        const glm::dvec3 b = glm::normalize(glm::dvec3(corners[(i + 1) % corners.size()] - position));
        const glm::dvec3 across = glm::cross(a, b);
        const double length = glm::length(across);
        if (length > 1e-12)
            sum += std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)) * glm::dot(across / length, glm::dvec3(normal));
    }
    return 0.5 * std::abs(sum);
}

TEST_F(Lighting, RectangleOnAPlaneInTheMean) {
    GpuWorld world;
    add_floor(world);
    assets::SceneBuilder builder(world.renderer->registry(), world.renderer->meshes());
    builder.ceiling_light("lamp", vec3(0.0f, 2.5f, 0.0f), 1.0f, 2.0f, vec3(2.0f));
    world.request.camera.position = vec3(0.5f, 2.0f, 2.0f); // below the lamp
    world.finish();
    world.request.camera.position = vec3(0.5f, 2.0f, 2.0f);
    world.request.camera.target = vec3(0.2f, 0.0f, 0.1f);
    gi::Settings settings = one_light();
    settings.lights = 1024;
    world.set(settings);
    const std::vector<vec3> corners = {
        {-0.5f, 2.5f, -1.0f}, {0.5f, 2.5f, -1.0f}, {0.5f, 2.5f, 1.0f}, {-0.5f, 2.5f, 1.0f}};
    double sum = 0, expected = 0;
    each_floor_pixel(world, [&](vec3 irradiance, vec3 position) {
        sum += double(irradiance.x);
        expected += 2.0 * polygon_irradiance(corners, position, vec3(0, 1, 0));
    });
    EXPECT_NEAR(sum / expected, 1.0, 1e-3);
}

TEST_F(Lighting, MoversTakePartInWalksOnlyWhereTheyCountAsStatic) {
    for (const std::uint32_t movers : {gi::movers_per_pixel, gi::movers_static}) {
        GpuWorld world(assets::make_four_pillars, "view");
        gi::Settings settings = plain_light();
        settings.lights = 300;
        settings.shadow_map_resolution = 32;
        settings.movers = movers;
        settings.mover_share = 0.1f;
        world.set(settings);
        world.render();
        const auto now = world.renderer->lighting().samples();
        const std::vector<gi::LightSample> before(now.begin(), now.end());
        world.request.step = 60;
        world.render();
        const std::span<const gi::LightSample> after = world.renderer->lighting().samples();
        ASSERT_EQ(before.size(), after.size());
        bool same = true;
        for (std::size_t i = 0; i < before.size(); ++i)
            same = same && (before[i].dynamic || before[i].position == after[i].position);
        EXPECT_EQ(same, movers == gi::movers_per_pixel);
        const auto on_mover = [](const gi::LightSample& sample) { return sample.on_mover; };
        EXPECT_EQ(std::any_of(after.begin(), after.end(), on_mover), movers == gi::movers_per_pixel);
        EXPECT_EQ(after.size(), 300u);
    }
}

TEST_F(Lighting, AFilteredLookUpKeepsTheMean) {
    GpuWorld world(assets::make_table_room, "view");
    gi::Settings settings = plain_light();
    settings.lights = 64;
    settings.shadow_filter = false;
    world.set(settings);
    const io::Picture sharp = world.picture();
    settings.shadow_filter = true;
    world.set(settings);
    const io::Picture soft = world.picture();
    double a = 0, b = 0;
    for (std::size_t i = 0; i < sharp.pixels.size(); ++i) {
        a += double(sharp.pixels[i].y);
        b += double(soft.pixels[i].y);
    }
    EXPECT_NEAR(b / a, 1.0, 0.01);
    EXPECT_NE(a, b);
}

} // namespace
} // namespace sunfleck::tests
