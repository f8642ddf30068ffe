// Cameras that keep views, and what lamps give in lumens.
#include "editor/document/bookmarks.h"
#include "editor/document/lamp_flux.h"

#include "engine/core/random.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace sunfleck::editor {
namespace {

constexpr double circle = 3.14159265358979323846;

TEST(EditorBookmarks, KeepViewsAndAreUndone) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> number(-4.0f, 4.0f);
    Document document;
    for (int i = 0; i < 20; ++i) {
        scene::CameraView view;
        view.position = {number(random), number(random), number(random)};
        view.target = {number(random), number(random), number(random)};
        view.vertical_field_of_view = 0.5f + 0.1f * float(i);
        const Entity camera = add_camera(document, view);
        const scene::CameraView kept = scene::camera_view(document.registry(), camera);
        EXPECT_NEAR(glm::length(kept.position - view.position), 0.0f, 1e-5f);
        const vec3 wanted = glm::normalize(view.target - view.position);
        EXPECT_NEAR(glm::length(glm::normalize(kept.target - kept.position) - wanted), 0.0f, 1e-5f);
        EXPECT_EQ(kept.vertical_field_of_view, view.vertical_field_of_view);
    }
    EXPECT_EQ(cameras(document).size(), 20u);
    EXPECT_EQ(document.name(cameras(document)[1]), "view 2");

    // Below something that is turned and scaled, too.
    const Entity last = cameras(document).back(), above = group(document, {last});
    document.begin("turn");
    auto turned = std::make_shared<scene::Transform>();
    turned->position = {1.0f, 2.0f, 3.0f};
    turned->rotation = glm::angleAxis(0.7f, glm::normalize(vec3(1.0f, 2.0f, 0.5f)));
    document.set(above, pool_of<scene::Transform>(document), turned);
    document.commit();
    scene::CameraView view;
    view.position = {5.0f, 1.0f, 0.0f};
    view.target = {0.0f, 1.0f, -2.0f};
    move_camera(document, last, view);
    EXPECT_NEAR(glm::length(scene::camera_view(document.registry(), last).position - view.position), 0.0f, 1e-4f);
    while (document.undo()) {
    }
    EXPECT_TRUE(cameras(document).empty());
    EXPECT_EQ(document.entity_count(), 0u);
}

// The flux of a spot by a sum over directions; of the others, closed forms.
TEST(EditorLampFlux, IsTheIntegralOverAllDirections) {
    const scene::PointLight point;
    const Field& intensity = scene::PointLight::description().fields[0];
    EXPECT_NEAR(flux_per_unit(intensity, &point), 4.0 * circle, 1e-9);

    for (const auto& [inner, outer] : {std::pair(0.2f, 0.7f), {0.0f, 1.2f}, {0.5f, 0.5f}}) {
        scene::SpotLight spot;
        spot.inner_angle = inner;
        spot.outer_angle = outer;
        const double a = std::cos(double(inner)), b = std::cos(double(outer));
        double sum = 0.0;
        constexpr int steps = 200'000;
        for (int i = 0; i < steps; ++i) {
            const double cosine = -1.0 + 2.0 * (double(i) + 0.5) / steps;
            const double falloff = a > b ? std::clamp((cosine - b) / (a - b), 0.0, 1.0) : cosine >= b ? 1.0 : 0.0;
            sum += falloff * falloff * 2.0 * circle * 2.0 / steps;
        }
        EXPECT_NEAR(flux_per_unit(scene::SpotLight::description().fields[0], &spot), sum, 1e-3 * sum + 1e-5);
    }

    scene::AreaLight area;
    area.width = 2.0f;
    area.height = 3.0f;
    area.radius = 0.5f;
    for (const Field& field : scene::AreaLight::description().fields)
        if (field.name == "radiance") {
            EXPECT_NEAR(flux_per_unit(field, &area), circle * 6.0, 1e-5);
            area.shape = scene::AreaShape::sphere;
            EXPECT_NEAR(flux_per_unit(field, &area), circle * circle, 1e-5);
        } else {
            EXPECT_EQ(flux_per_unit(field, &area), 0.0);
        }
}

} // namespace
} // namespace sunfleck::editor
