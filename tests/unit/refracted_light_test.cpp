// Light through smooth glass against closed forms: a pane, total reflection, a ball that focuses.
#include "gi_module/light_sampling/refracted_light.h"

#include "gi_module/transport/reflectance.h"
#include "tests/support/sampled_scene.h"

#include <cmath>

namespace sunfleck::gi {
namespace {

scene::Material glass_of(float index) {
    scene::Material glass;
    glass.base_colour = vec3(1.0f);
    glass.transmission = 1.0f;
    glass.index_of_refraction = index;
    return glass;
}

// A pane 0.2 m thick, whose upper side is at y = 0.
struct Pane : SampledScene {
    Pane() {
        assets::SceneBuilder builder(registry, meshes);
        builder.box("pane", vec3(-2.0f, -0.2f, -2.0f), vec3(2.0f, 0.0f, 2.0f), glass_of(1.5f));
        builder.point_light("bulb", vec3(0.0f, 1.0f, 0.0f), vec3(3.0f));
        finish();
    }
    // From above, to the middle of the pane, at an angle from the vertical, rad.
    std::optional<PassedGlass> pass(float angle, Refraction refraction) const {
        const vec3 direction(std::sin(angle), -std::cos(angle), 0.0f);
        return pass_glass({-direction, direction, 0.0f, 1e30f}, refraction, *rays, registry);
    }
};

// Places are exact within what rays start above surfaces at, some 1.5e-5 m here.
TEST(SplatRefraction, APaneShiftsLightAndKeepsItsDirection) {
    const Pane pane;
    for (const float angle : {0.0f, 0.3f, 0.9f, 1.4f}) {
        const auto passed = pane.pass(angle, Refraction::traced);
        ASSERT_TRUE(passed) << angle;
        const float inside = std::asin(std::sin(angle) / 1.5f);
        EXPECT_NEAR(passed->point.position.x, 0.2f * std::tan(inside), 4e-5f) << angle;
        EXPECT_NEAR(passed->point.position.y, -0.2f, 1e-5f);
        EXPECT_NEAR(passed->direction.x, std::sin(angle), 1e-5f);
        EXPECT_EQ(passed->normal, vec3(0.0f, -1.0f, 0.0f));
        EXPECT_EQ(passed->surfaces, 2u);
        const float through = 1.0f - fresnel_dielectric(std::cos(angle), 1.5f);
        EXPECT_NEAR(passed->share.x, through * through, 1e-4f) << angle;
    }
    EXPECT_FALSE(pane.pass(0.0f, Refraction::traced)->by_mover);
}

// Straight to the lower side, where it is refracted as from within glass, up to the angle of total reflection.
TEST(SplatRefraction, SingleIsRefractedWhereLightLeaves) {
    const Pane pane;
    for (const float angle : {0.1f, 0.5f, 0.7f}) {
        const auto passed = pane.pass(angle, Refraction::single);
        ASSERT_TRUE(passed) << angle;
        EXPECT_NEAR(passed->point.position.x, 0.2f * std::tan(angle), 4e-5f) << angle;
        EXPECT_NEAR(passed->direction.x, 1.5f * std::sin(angle), 1e-4f) << angle;
    }
    EXPECT_FALSE(pane.pass(0.8f, Refraction::single)) << "sin 0.8 > 1 / 1.5: it never leaves";
}

// Whatever enters a cube from above is totally reflected at its sides, and leaves below.
TEST(SplatRefraction, TotalReflectionIsFollowed) {
    SampledScene scene;
    assets::SceneBuilder builder(scene.registry, scene.meshes);
    builder.box("cube", vec3(-0.5f, -1.0f, -0.5f), vec3(0.5f, 0.0f, 0.5f), glass_of(1.5f));
    builder.point_light("bulb", vec3(0.0f, 1.0f, 0.0f), vec3(3.0f));
    scene.finish();
    const vec3 direction = glm::normalize(vec3(1.0f, -1.0f, 0.0f));
    const vec3 start = vec3(0.2f, 0.0f, 0.1f) - direction;
    const auto passed = pass_glass({start, direction, 0.0f, 1e30f}, Refraction::traced, *scene.rays, scene.registry);
    ASSERT_TRUE(passed);
    EXPECT_EQ(passed->surfaces, 3u);
    EXPECT_NEAR(passed->point.position.y, -1.0f, 1e-5f);
    EXPECT_NEAR(passed->direction.x, -direction.x, 1e-5f) << "mirrored by the side";
    EXPECT_NEAR(passed->direction.y, direction.y, 1e-5f);
}

TEST(SplatRefraction, LightEndsWithinGlassAndNeedsSome) {
    SampledScene scene;
    assets::SceneBuilder builder(scene.registry, scene.meshes);
    builder.box("pane", vec3(-1.0f, -0.5f, -1.0f), vec3(1.0f, 0.0f, 1.0f), glass_of(1.5f));
    builder.box("stone", vec3(-0.2f, -0.3f, -0.2f), vec3(0.2f, -0.2f, 0.2f), assets::diffuse(vec3(0.5f)));
    builder.box("wall", vec3(2.0f, -1.0f, -1.0f), vec3(3.0f, 1.0f, 1.0f), assets::diffuse(vec3(0.5f)));
    builder.point_light("bulb", vec3(0.0f, 1.0f, 0.0f), vec3(3.0f));
    scene.finish();
    const auto passes = [&](vec3 from, vec3 direction) {
        const raytrace::Ray ray{from, direction, 0.0f, 1e30f};
        return pass_glass(ray, Refraction::traced, *scene.rays, scene.registry).has_value();
    };
    EXPECT_TRUE(passes(vec3(0.5f, 1.0f, 0.0f), vec3(0, -1, 0)));
    EXPECT_FALSE(passes(vec3(0.0f, 1.0f, 0.0f), vec3(0, -1, 0))) << "a stone is in the way";
    EXPECT_FALSE(passes(vec3(1.5f, 0.5f, 0.0f), vec3(1, 0, 0))) << "no glass";
}

// All texels of a lamp's map that meet the pane have the flux that Fresnel's law leaves them.
TEST(SplatRefraction, AMapHasTheFluxThatPasses) {
    const Pane pane;
    const ReflectiveShadowMap map = trace_reflective_map(pane.emitters.front(), 128, {}, *pane.rays, pane.registry);
    const ReflectiveShadowMap passed =
        trace_refracted_map(pane.emitters.front(), map, Refraction::traced, *pane.rays, pane.registry);
    double flux = 0.0, expected = 0.0;
    std::size_t lit = 0;
    for (std::size_t i = 0; i < map.texels.size(); ++i) {
        ASSERT_TRUE(!passed.texels[i].lit || map.texels[i].is_glass);
        if (!passed.texels[i].lit)
            continue;
        ++lit;
        flux += double(passed.texels[i].glossy.x);
        const vec3 direction = reflective_map_ray(pane.emitters.front(), i, map.side, *pane.rays).direction;
        const float through = 1.0f - fresnel_dielectric(-direction.y, 1.5f);
        expected += 4.0 * 3.14159265 * 3.0 / (128.0 * 128.0) * double(through * through);
    }
    EXPECT_GT(lit, map.texels.size() / 8);
    EXPECT_NEAR(flux / expected, 1.0, 1e-3);
}

// Rays near the axis of a ball with index n and radius R meet n R / (2 (n - 1)) from its centre; the differences of
// neighbouring texels, which the beams of pixel lights are made from, do so, too.
TEST(SplatRefraction, ABallFocusesWhereItsFocalLengthIs) {
    for (const float index : {1.5f, 1.7f}) {
        SampledScene scene;
        assets::SceneBuilder builder(scene.registry, scene.meshes);
        builder.add("ball", scene::make_sphere(1.0f, 512, 256), glass_of(index));
        scene::Transform place;
        place.position = vec3(0.0f, 0.0f, 400.0f); // so far away that its light is parallel
        place.rotation = assets::facing(vec3(0.0f, 0.0f, 1.0f));
        builder.spot_light("spot", place, {vec3(1000.0f), 2e-4f, 2.5e-4f}); // 0.1 m wide where the ball is
        scene.finish();
        const Emitter& spot = scene.emitters.front();
        const ReflectiveShadowMap map = trace_reflective_map(spot, 32, {}, *scene.rays, scene.registry);
        const ReflectiveShadowMap passed =
            trace_refracted_map(spot, map, Refraction::traced, *scene.rays, scene.registry);
        double along = 0.0, squares = 0.0; // of the distance at which neighbours meet: least squares
        for (std::size_t i = 0; i + 1 < passed.texels.size(); ++i) {
            const ReflectiveTexel &a = passed.texels[i], &b = passed.texels[i + 1];
            ASSERT_TRUE(a.lit && b.lit);
            const vec2 apart(b.position - a.position), turned(b.mirror - a.mirror);
            along -= double(glm::dot(apart, turned));
            squares += double(glm::dot(turned, turned));
        }
        const double focal = double(index) / (2.0 * (double(index) - 1.0));
        // Of the ball's surface; shading normals of its triangles, and rays 5 cm off the axis, are 1 % off.
        EXPECT_NEAR(1.0 + along / squares, focal, 0.02 * focal) << index;
    }
}

} // namespace
} // namespace sunfleck::gi
