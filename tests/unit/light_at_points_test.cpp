// What arrives at places on movers, and what of it leaves them, against closed forms.
#include "gi_module/light_sampling/light_at_points.h"
#include "gi_module/light_sampling/mover_places.h"
#include "gi_module/transport/light_row.h"
#include "tests/support/sampled_scene.h"

namespace sunfleck::gi {
namespace {

const vec3 upwards(0.0f, 1.0f, 0.0f);

// Of a disc on the floor, at the origin.
IncomingLight disc_light(float radius, vec3 flux) {
    LightSample sample;
    sample.normal = upwards;
    sample.flux = flux;
    sample.bounce = 1;
    const Bounds bounds{vec3(-10.0f), vec3(10.0f)};
    return {make_light_row(sample, 0, 1e30f, bounds), light_class(sample.kind), 1, radius};
}

float light_at(vec3 point, vec3 normal, const IncomingLight& light, const raytrace::RayScene& rays) {
    Bounds bounds;
    bounds.add(point);
    vec3 sum(0.0f);
    LightAtPoints(std::span(&light, 1), bounds, 100.0f, rays).gather(point, normal, [&](std::size_t, vec3 e) {
        sum += e;
    });
    return sum.x;
}

struct Scene : SampledScene {
    explicit Scene(const std::function<void(assets::SceneBuilder&)>& make) {
        assets::SceneBuilder builder(registry, meshes);
        make(builder);
        finish();
    }
};

void nothing_near(assets::SceneBuilder& builder) {
    builder.box("far away", vec3(50.0f), vec3(51.0f), {});
}

// E = M r^2 / (d^2 + r^2) on the axis of a disc of radiosity M.
TEST(LightAtPoints, DiscsAreAsBrightAsTheirClosedForm) {
    const Scene scene(nothing_near);
    for (const float radius : {0.02f, 0.5f, 30.0f})
        for (const float heights : {1.0f, 1.5f, 3.0f, 3.99f, 4.01f, 20.0f}) {
            const float flux = 7.0f, height = heights * radius;
            const float exact = flux / (pi * (height * height + radius * radius));
            const float found =
                light_at(vec3(0.0f, height, 0.0f), -upwards, disc_light(radius, vec3(flux)), *scene.rays);
            // The midpoint rule with four points is 0.9 % off at one radius; beyond four, a disc is a point.
            EXPECT_NEAR(found / exact, 1.0f, heights < 4.0f ? 0.01f : 0.065f)
                << radius << " at " << heights << " radii";
        }
    const IncomingLight point = disc_light(0.0f, vec3(7.0f));
    EXPECT_NEAR(light_at(vec3(0.0f, 0.5f, 0.0f), -upwards, point, *scene.rays), 7.0f / (pi * 0.25f), 1e-4f);
}

// W/m2 at a point that faces down, of a disc of 1 W at the origin whose light all leaves where x is below `end`.
double of_cut_disc(float radius, float end, vec3 point) {
    double sum = 0.0, count = 0.0;
    for (int i = -200; i <= 200; ++i)
        for (int j = -200; j <= 200; ++j) {
            const vec3 part = radius * vec3(float(i) / 200.0f, 0.0f, float(j) / 200.0f), away = point - part;
            if (glm::length(part) > radius || part.x >= end)
                continue;
            const double squared = double(glm::dot(away, away));
            sum += double(away.y * away.y) / (squared * squared * double(pi));
            count += 1.0;
        }
    return sum / count;
}

// A disc that is wider than its room lights nobody next door, and loses nothing in its own.
TEST(LightAtPoints, DiscsEndAtWalls) {
    const Scene scene([](assets::SceneBuilder& builder) {
        builder.quad("wall", vec3(0.1f, -5.0f, -5.0f), vec3(0.0f, 0.0f, 10.0f), vec3(0.0f, 10.0f, 0.0f), {});
    });
    const Scene open(nothing_near);
    const IncomingLight light = disc_light(0.5f, vec3(1.0f));
    const vec3 behind(0.4f, 0.3f, 0.0f), before(-0.2f, 1.0f, 0.0f);
    EXPECT_NEAR(light_at(behind, -upwards, light, *open.rays) / of_cut_disc(0.5f, 9.0f, behind), 1.0, 0.25);
    EXPECT_EQ(light_at(behind, -upwards, light, *scene.rays), 0.0f);
    EXPECT_NEAR(light_at(before, -upwards, light, *open.rays) / of_cut_disc(0.5f, 9.0f, before), 1.0, 0.1);
    EXPECT_NEAR(light_at(before, -upwards, light, *scene.rays) / of_cut_disc(0.5f, 0.1f, before), 1.0, 0.1);
}

// A floor with a wall along one side, and what the wall hides of a place on the floor: (1 - d / sqrt(d^2 + h^2)) / 2 of
// a wall of height h at a distance d, as wide as anybody can see.
TEST(LightAtPoints, MoversHideWhatTheirFormFactorsSay) {
    const auto corner = [](float height) {
        scene::Mesh mesh;
        mesh.positions = {{-1e4f, 0, 0}, {-1e4f, 0, 1e4f},   {1e4f, 0, 1e4f},
                          {1e4f, 0, 0},  {-1e4f, height, 0}, {1e4f, height, 0}};
        mesh.indices = {0, 1, 2, 0, 2, 3, 0, 3, 5, 0, 5, 4};
        scene::compute_normals(mesh);
        return mesh;
    };
    for (const float heights : {0.05f, 1.0f, 3.0f, 1000.0f}) {
        ecs::Entity mover;
        const Scene scene([&](assets::SceneBuilder& builder) {
            mover = builder.add("corner", corner(heights), {}, {});
            builder.mover(mover, {});
        });
        // On the second triangle, from (-1e4, 0, 0) by way of (1e4, 0, 1e4) and (1e4, 0, 0): at x = 0 and z = 1.
        const SurfacePlace place{1, 1e-4f, 0.5f - 0.5e-4f, 1.0f};
        const auto now = place_now(mover, place, *scene.rays);
        ASSERT_TRUE(now);
        ASSERT_NEAR(now->point.z, 1.0f, 0.01f);
        const float exact = 0.5f * (1.0f - 1.0f / std::sqrt(1.0f + heights * heights));
        EXPECT_NEAR(hidden_share(mover, *now, *scene.rays), exact, 1.0f / 8.0f) << heights;
        EXPECT_EQ(hidden_share({}, *now, *scene.rays), 0.0f) << "what others hide does not count";
    }
}

} // namespace
} // namespace sunfleck::gi
