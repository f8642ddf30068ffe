// Rooms whose walls are single sheets, as modelling programs make them: light from outside must not come in where they
// meet. Held to the same light samples with shadows traced by rays.
#include "tests/support/scaled_scene.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"
#include "tests/support/traced_light.h"

namespace sunfleck::tests {
namespace {

class AnywhereSheets : public GpuTest {};

// 3 m wide, open towards the camera, under a sky of 1 W/(sr m2) and a sun that comes in through the opening.
void make_sheet_box(assets::SceneBuilder& builder) {
    const scene::Material white = assets::diffuse(vec3(0.7f));
    const vec3 x(3, 0, 0), y(0, 3, 0), z(0, 0, 3), corner(-1.5f, 0.0f, -1.5f);
    builder.quad("floor", corner, z, x, white);
    builder.quad("ceiling", corner + y, x, z, white);
    builder.quad("back", corner, x, y, white);
    builder.quad("left", corner, y, z, assets::diffuse(vec3(0.7f, 0.2f, 0.2f)));
    builder.quad("right", corner + x, z, y, assets::diffuse(vec3(0.2f, 0.7f, 0.2f)));
    const ecs::Entity sky = builder.registry().create();
    builder.registry().emplace<scene::Environment>(sky, {vec3(1.0f)});
    const ecs::Entity sun = builder.registry().create();
    scene::Transform transform;
    transform.rotation = assets::facing(glm::normalize(vec3(0.3f, 1.0f, 0.8f))); // shines along its -Z
    builder.registry().emplace<scene::Transform>(sun, transform);
    builder.registry().emplace<scene::DirectionalLight>(sun, {vec3(8.0f)});
    builder.camera("view", vec3(0.0f, 1.5f, 6.0f), vec3(0.0f, 1.5f, 0.0f), 30.0f);
}

// How a picture stands to the traced one.
struct Errors {
    int pixels = 0, too_bright = 0, too_dark = 0;
    double worst = 0.0;                        // of what is too bright: times the traced value
    double edges = 0.0, traced_at_edges = 0.0; // sums within 0.3 m of where walls meet
};

double edge_distance(vec3 p) {
    const float to[] = {1.5f - std::abs(p.x), std::min(p.y, 3.0f - p.y), p.z + 1.5f};
    float sorted[] = {to[0], to[1], to[2]};
    std::sort(std::begin(sorted), std::end(sorted));
    return double(sorted[1]); // the nearest wall is the one that the point is on
}

Errors compare(GpuWorld& world, float scale) {
    for (int frame = 0; frame < 8; ++frame) // light is baked over some
        world.render();
    const io::Picture picture = world.picture();
    const TracedLight traced(world, 2);
    double mean = 0.0;
    Errors errors;
    for (const TracedPixel& pixel : traced.pixels())
        if (pixel.surface)
            ++errors.pixels, mean += pixel.exact;
    mean /= errors.pixels;
    for (std::size_t i = 0; i < traced.pixels().size(); ++i) {
        const TracedPixel& pixel = traced.pixels()[i];
        if (!pixel.surface)
            continue;
        const vec3 place = (pixel.position * world.renderer->space().unit + world.renderer->space().origin) / scale;
        if (edge_distance(place) < 1e-4) // on the edge, to rounding: rays may start behind the other wall
            continue;
        const vec3 drawn(picture.pixels[i]);
        const double light = double(drawn.x + drawn.y + drawn.z) / 3.0;
        errors.too_bright += light > 1.3 * pixel.most + 0.02 * mean;
        errors.too_dark += light < pixel.least / 1.3 - 0.02 * mean;
        errors.worst = std::max(errors.worst, light / (pixel.most + 0.02 * mean));
        if (edge_distance(place) < 0.3) {
            errors.edges += light;
            errors.traced_at_edges += pixel.exact;
        }
    }
    return errors;
}

TEST_F(AnywhereSheets, KeepTheLightOut) {
    for (const std::string_view technique : techniques_for_all_light())
        for (const float scale : tests::by_size(std::vector{1.0f}, {1.0f, 0.01f})) {
            ScaledWorld world(make_sheet_box, scale);
            world.request.width = 160;
            world.request.height = 120;
            gi::Settings settings = gi::Settings().all_light_by(technique);
            settings.with("punctual", "automatic");
            settings.clamp_scale = 100.0f;
            settings.map_budget = 65536;
            settings.low_resolution = 1;
            world.set(settings);
            const Errors errors = compare(world, scale);
            std::printf("%.*s at %g: %d of %d too bright, %d too dark, worst %.2f, edges %.3f\n", int(technique.size()),
                        technique.data(), double(scale), errors.too_bright, errors.pixels, errors.too_dark,
                        errors.worst, errors.edges / errors.traced_at_edges);
            EXPECT_GT(errors.pixels, 10000);
            EXPECT_EQ(errors.too_bright, 0);
            EXPECT_NEAR(errors.edges / errors.traced_at_edges, 1.0, 0.1);
        }
}

} // namespace
} // namespace sunfleck::tests
