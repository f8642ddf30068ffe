// What glTF brings to pictures: textures, holes, vertex colours, deforming meshes and surroundings, against the path
// tracer, which looks everything up in its own way.
#include "engine/core/random.h"
#include "engine/scene/deformation.h"
#include "engine/scene/environment_map.h"
#include "engine/scene/summer_sky.h"
#include "gi_module/reference/path_tracer.h"
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"

namespace sunfleck::tests {
namespace {

class Imported : public GpuTest {};

constexpr std::uint32_t side = 64;

// A picture of squares of random colours; alpha is 0 in a quarter of them.
scene::Texture random_texture(std::uint32_t squares, bool srgb, bool holes) {
    scene::Texture texture;
    texture.name = "squares";
    texture.width = texture.height = squares * 8;
    texture.srgb = srgb;
    for (std::uint32_t y = 0; y < texture.height; ++y)
        for (std::uint32_t x = 0; x < texture.width; ++x) {
            const std::uint32_t hash = pcg_hash((y / 8) * squares + x / 8);
            for (int c = 0; c < 3; ++c)
                texture.pixels.push_back(std::uint8_t(40 + (hash >> (8 * c)) % 200));
            texture.pixels.push_back(holes && hash % 4 == 0 ? 0 : 255);
        }
    return texture;
}

// A square of 2 m with texture coordinates before a camera at z = 2, and a wall behind it.
struct Stage : GpuWorld {
    ecs::Entity square;
    Stage() {
        assets::SceneBuilder builder(renderer->registry(), renderer->meshes());
        scene::Mesh mesh = scene::make_rectangle(2.0f, 2.0f, 4, 4);
        for (const vec3 p : mesh.positions) {
            mesh.texture_coordinates.emplace_back(0.5f + 0.5f * p.x, 0.5f - 0.5f * p.y, 0.0f, 0.0f);
            mesh.tangents.emplace_back(1.0f, 0.0f, 0.0f, 1.0f);
        }
        square = builder.add("square", std::move(mesh), assets::diffuse(vec3(1.0f)));
        builder.quad("wall", vec3(-4, -4, -1), vec3(8, 0, 0), vec3(0, 8, 0), assets::diffuse(vec3(0.3f, 0.6f, 0.3f)));
        builder.camera("view", vec3(0.0f, 0.0f, 2.0f), vec3(0.0f), 60.0f);
        request.width = request.height = side;
    }
    void use(scene::Texture texture, scene::TextureUse scene::MaterialTextures::*which) {
        scene::MaterialTextures textures;
        if (const auto* present = renderer->registry().try_get<scene::MaterialTextures>(square))
            textures = *present;
        (textures.*which).texture = std::int32_t(renderer->textures().add(std::move(texture)));
        renderer->registry().emplace_or_replace<scene::MaterialTextures>(square, textures);
    }
    gi::reference::Accumulation reference(gi::reference::ReferenceView view, std::uint32_t samples) {
        const Bounds bounds = viewer::scene_bounds(renderer->registry(), renderer->meshes());
        EXPECT_TRUE(renderer->rays().update(renderer->registry(), renderer->meshes(), &renderer->textures()));
        const gi::reference::PathTracer tracer(renderer->rays(),
                                               gi::collect_emitters(renderer->registry(), renderer->meshes(), bounds));
        gi::reference::ReferenceSettings settings;
        settings.width = settings.height = side;
        settings.view = view;
        gi::reference::Accumulation accumulation;
        tracer.accumulate(accumulation, request.camera, settings, samples, {});
        return accumulation;
    }
};

// Nothing but emission: raster and rays must show the same texels. Edges of texels differ by the level of detail.
TEST_F(Imported, TexturesLieWhereRaysFindThem) {
    Stage stage;
    stage.use(random_texture(4, true, false), &scene::MaterialTextures::emission);
    stage.renderer->registry().patch<scene::MaterialTextures>(stage.square, [](scene::MaterialTextures& textures) {
        textures.emission.offset = vec2(0.3f, 0.1f);
        textures.emission.scale = vec2(1.5f, 0.75f);
        textures.emission.rotation = 0.4f;
    });
    stage.renderer->registry().patch<scene::Material>(stage.square, [](scene::Material& material) {
        material.base_colour = vec3(0.0f);
        material.emission = vec3(3.0f, 2.0f, 1.0f);
    });
    stage.finish("view");
    gi::Settings settings;
    settings.lights = 0;
    stage.set(settings);
    stage.request.view = shared::view_final;
    const io::Picture picture = stage.picture();
    const auto truth = stage.reference(gi::reference::ReferenceView::radiance, 1);
    int close = 0, lit = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const vec3 expected(truth.sums[i * 3], truth.sums[i * 3 + 1], truth.sums[i * 3 + 2]);
        if (expected.x < 0.01f)
            continue;
        ++lit;
        close += glm::length(vec3(picture.pixels[i]) - expected) < 0.03f * glm::length(expected);
    }
    EXPECT_GT(lit, 1000);
    EXPECT_GT(close, lit * 7 / 10) << "of " << lit;
}

// Cut-out squares: what shows through them, and their shadows.
TEST_F(Imported, HolesAreHolesForPicturesShadowsAndRays) {
    Stage stage;
    stage.use(random_texture(4, true, true), &scene::MaterialTextures::base_colour);
    stage.renderer->registry().patch<scene::Material>(
        stage.square, [](scene::Material& material) { material.alpha_mode = scene::AlphaMode::mask; });
    assets::SceneBuilder builder(stage.renderer->registry(), stage.renderer->meshes());
    builder.point_light("lamp", vec3(0.3f, 0.5f, 2.5f), vec3(9.0f));
    stage.finish("view");
    for (const std::string_view technique : techniques_for_all_light()) {
        gi::Settings settings = gi::Settings().all_light_by(technique);
        settings.lights = 1;
        settings.shadow_map_resolution = 512;
        settings.low_resolution = 1;
        stage.set(settings);
        stage.request.view = shared::view_irradiance;
        const io::Picture picture = stage.picture();
        const auto truth = stage.reference(gi::reference::ReferenceView::direct, 1);
        int wrong = 0, dark = 0;
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
            const double expected = truth.sums[i * 3];
            dark += expected < 0.01;
            wrong += std::abs(double(picture.pixels[i].x) - expected) > 0.05 * expected + 0.02;
        }
        EXPECT_GT(dark, 100) << "shadows of what is left";
        EXPECT_LT(wrong, int(side * side) / 12) << "pixels beside the edges of holes and shadows at most";
    }
    // A hole lets rays through, the rest does not: over many rays, as many as the texture has texels with alpha.
    int passed = 0;
    for (std::uint32_t i = 0; i < 4000; ++i) {
        const vec3 to(to_unit_float(pcg_hash(i)) * 1.9f - 0.95f, to_unit_float(pcg_hash(i + 50000)) * 1.9f - 0.95f,
                      -0.5f);
        passed += !stage.renderer->rays().occluded(raytrace::Ray{vec3(to.x, to.y, 1.0f), vec3(0, 0, -1), 0.0f, 1.5f});
    }
    int holes = 0;
    for (std::uint32_t square = 0; square < 16; ++square)
        holes += pcg_hash(square) % 4 == 0;
    EXPECT_NEAR(passed / 4000.0, holes / 16.0, 0.06);
}

// Half transparent: half of the rays pass, half of the pixels show what is behind.
// glTF's double-sided flag: what is not, pictures show from the front only, also where a mirror turns triangles round.
TEST_F(Imported, SingleSidedSurfacesAreSeenFromTheFrontOnly) {
    Stage stage;
    stage.renderer->registry().patch<scene::Material>(
        stage.square, [](scene::Material& material) { material.base_colour = vec3(0.8f, 0.1f, 0.1f); });
    viewer::add_default_light(stage.renderer->registry());
    stage.finish("view");
    stage.request.view = shared::view_albedo;
    for (const bool double_sided : {true, false})
        for (const bool from_behind : {false, true})
            for (const bool mirror : {false, true}) {
                stage.renderer->registry().patch<scene::Material>(
                    stage.square, [&](scene::Material& material) { material.double_sided = double_sided; });
                scene::Transform place;
                if (from_behind)
                    place.rotation = glm::angleAxis(glm::pi<float>(), vec3(0, 1, 0));
                place.scale.x = mirror ? -1.0f : 1.0f;
                stage.renderer->registry().emplace_or_replace<scene::Transform>(stage.square, place);
                scene::update_world_transforms(stage.renderer->registry());
                const io::Picture picture = stage.picture();
                const vec4 pixel = picture.pixels[(side / 2) * side + side / 2];
                const bool seen = double_sided || !from_behind;
                EXPECT_EQ(pixel.x > pixel.y, seen) << double_sided << from_behind << mirror;
                const auto reference = stage.reference(gi::reference::ReferenceView::radiance, 16);
                const double* traced = &reference.sums[3 * ((side / 2) * side + side / 2)];
                EXPECT_GT(traced[0] + traced[1], 0.0);
                EXPECT_EQ(traced[0] > traced[1], seen) << double_sided << from_behind << mirror;
            }
}

TEST_F(Imported, BlendingStopsItsShareOfLight) {
    Stage stage;
    stage.renderer->registry().patch<scene::Material>(stage.square, [](scene::Material& material) {
        material.alpha_mode = scene::AlphaMode::blend;
        material.alpha = 0.5f;
    });
    stage.finish("view");
    gi::Settings settings;
    settings.lights = 0;
    stage.set(settings);
    stage.request.view = shared::view_albedo;
    const io::Picture picture = stage.picture();
    int white = 0;
    for (std::uint32_t y = 16; y < 48; ++y)
        for (std::uint32_t x = 16; x < 48; ++x)
            white += picture.pixels[y * side + x].x > 0.9f;
    EXPECT_EQ(white, 32 * 32 / 2);
    int passed = 0;
    for (std::uint32_t i = 0; i < 4000; ++i)
        passed +=
            !stage.renderer->rays().occluded(raytrace::Ray{vec3(0.1f, 0.2f, 1.0f), vec3(0, 0, -1), 0.0f, 1.5f, i});
    EXPECT_NEAR(passed / 4000.0, 0.5, 0.04);
}

// A bent mesh is the same for the geometry pass, the shadow maps and the rays, and follows its pose.
TEST_F(Imported, DeformedMeshesMoveForAll) {
    Stage stage;
    ecs::Registry& registry = stage.renderer->registry();
    scene::DeformableMesh source;
    source.rest = stage.renderer->meshes()[registry.get<scene::MeshInstance>(stage.square).mesh];
    source.targets.push_back({std::vector<vec3>(source.rest.positions.size(), vec3(0.0f, 0.0f, -0.6f)), {}});
    scene::Deformation deformation;
    deformation.source = std::make_shared<scene::DeformableMesh>(source);
    deformation.weights_of = stage.square;
    registry.emplace<scene::Deformation>(stage.square, std::move(deformation));
    registry.emplace<scene::MorphWeights>(stage.square, {{0.0f}});
    registry.emplace<scene::Mover>(stage.square, {});
    assets::SceneBuilder builder(registry, stage.renderer->meshes());
    builder.point_light("lamp", vec3(0.3f, 0.5f, 1.5f), vec3(9.0f));
    stage.finish("view");
    gi::Settings settings;
    settings.lights = 1;
    settings.shadow_map_resolution = 512;
    settings.low_resolution = 1;
    stage.set(settings);
    stage.request.view = shared::view_irradiance;
    for (const float weight : {0.0f, 1.0f, 0.5f}) {
        registry.patch<scene::MorphWeights>(stage.square, [&](scene::MorphWeights& w) { w.weights = {weight}; });
        const io::Picture picture = stage.picture();
        const auto hit = stage.renderer->rays().closest_hit({vec3(0.1f, 0.1f, 2.0f), vec3(0, 0, -1)});
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->distance, 2.0f + 0.6f * weight, 1e-4f);
        const auto truth = stage.reference(gi::reference::ReferenceView::direct, 1);
        int wrong = 0;
        for (std::size_t i = 0; i < picture.pixels.size(); ++i)
            wrong += std::abs(double(picture.pixels[i].x) - truth.sums[i * 3]) > 0.05 * truth.sums[i * 3] + 0.02;
        EXPECT_LT(wrong, int(side * side) / 20) << weight;
    }
}

// A picture of the surroundings lights a floor as its integral says, by samples and by paths.
TEST_F(Imported, SurroundingsLightAsTheirIntegralSays) {
    constexpr std::uint32_t width = 64, height = 32;
    std::vector<vec3> texels;
    for (std::uint32_t i = 0; i < width * height; ++i)
        texels.push_back(vec3(to_unit_float(pcg_hash(i)), to_unit_float(pcg_hash(i + 7777)), 0.3f) *
                         (i == 9 * width + 20 ? 200.0f : 1.0f)); // and a small sun
    const auto image = std::make_shared<const scene::EnvironmentImage>(width, height, texels);
    // The integral over the upper half, texel by texel with 4 x 4 points each.
    glm::dvec3 expected(0.0);
    for (std::uint32_t row = 0; row < height / 2 * 4; ++row)
        for (std::uint32_t column = 0; column < width * 4; ++column) {
            const double theta = double(pi) * (row + 0.5) / (height * 4);
            const double phi = 2.0 * double(pi) * ((column + 0.5) / (width * 4) - 0.5);
            const vec3 d(float(std::sin(theta) * std::sin(phi)), float(std::cos(theta)),
                         float(-std::sin(theta) * std::cos(phi)));
            expected += glm::dvec3(image->radiance(d)) * (std::cos(theta) * std::sin(theta) * double(pi) /
                                                          (height * 4) * 2.0 * double(pi) / (width * 4));
        }
    // Drawn directions have the density that they say: the mean of radiance over density is the integral.
    glm::dvec3 drawn(0.0);
    RandomSequence random(SequenceKind::sobol, 5, 0);
    for (std::uint32_t i = 0; i < 20000; ++i) {
        const RandomSequence at(SequenceKind::sobol, 5, i);
        const auto draw = image->draw(at.at(0), at.at(1));
        EXPECT_NEAR(image->density(draw.direction), draw.density, 0.02f * draw.density);
        if (draw.direction.y > 0.0f)
            drawn += glm::dvec3(draw.radiance) * double(draw.direction.y / draw.density) / 20000.0;
    }
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(drawn[c], expected[c], 0.01 * expected[c]);
    GpuWorld world;
    assets::SceneBuilder builder(world.renderer->registry(), world.renderer->meshes());
    builder.quad("floor", vec3(-1, 0, 1), vec3(2, 0, 0), vec3(0, 0, -2), assets::diffuse(vec3(0.5f)));
    builder.camera("view", vec3(0.0f, 2.0f, 0.01f), vec3(0.0f), 40.0f);
    const ecs::Entity sky = world.renderer->registry().create();
    world.renderer->registry().emplace<scene::Environment>(sky, {vec3(1.0f)});
    world.renderer->registry().emplace<scene::EnvironmentMap>(sky, {"", 0.0f, image});
    world.finish("view");
    gi::Settings settings = plain_light();
    settings.lights = 4096;
    settings.direct_share = 1.0f;
    settings.shadow_map_resolution = 16;
    world.set(settings);
    const io::Picture picture = world.picture();
    const vec4 middle = picture.pixels[picture.pixels.size() / 2 + world.request.width / 2];
    const Bounds bounds = viewer::scene_bounds(world.renderer->registry(), world.renderer->meshes());
    EXPECT_TRUE(world.renderer->rays().update(world.renderer->registry(), world.renderer->meshes()));
    const gi::reference::PathTracer tracer(
        world.renderer->rays(), gi::collect_emitters(world.renderer->registry(), world.renderer->meshes(), bounds));
    const vec3 truth = tracer.irradiance_by_bounce(vec3(0.0f), vec3(0, 1, 0), 0, 4096, 3)[0];
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(double(middle[c]), expected[c], 0.02 * expected[c]);
        EXPECT_NEAR(double(truth[c]), expected[c], 0.02 * expected[c]);
    }
}

// The eye and rays see one sky, that which is made by code: as a texture between whose texels is interpolated, and
// texel by texel. It has hills below and clouds above, and nothing brighter than a cloud.
TEST_F(Imported, ASkyMadeByCodeIsTheSameInPictureAndReference) {
    GpuWorld world;
    assets::SceneBuilder builder(world.renderer->registry(), world.renderer->meshes());
    builder.quad("floor", vec3(-1, 0, 1), vec3(2, 0, 0), vec3(0, 0, -2), assets::diffuse(vec3(0.5f)));
    builder.camera("view", vec3(0.0f, 1.0f, 0.0f), vec3(0.4f, 1.15f, -1.0f), 60.0f);
    builder.point_light("lamp", vec3(0.0f, 2.0f, 0.0f), vec3(1.0f));
    const ecs::Entity sky = world.renderer->registry().create();
    const vec3 radiance(2.0f, 3.0f, 4.0f);
    world.renderer->registry().emplace<scene::Environment>(sky, {radiance, false});
    world.renderer->registry().emplace<scene::EnvironmentMap>(
        sky, {std::string(scene::summer_sky_name), 0.0f, scene::summer_sky()});
    world.finish("view");
    world.request.view = shared::view_final;
    world.set(plain_light());
    const io::Picture picture = world.picture();
    EXPECT_TRUE(world.renderer->rays().update(world.renderer->registry(), world.renderer->meshes()));
    const gi::reference::PathTracer tracer(world.renderer->rays(), {},
                                           gi::collect_backgrounds(world.renderer->registry()));
    gi::reference::Accumulation traced;
    gi::reference::ReferenceSettings settings;
    settings.width = picture.width;
    settings.height = picture.height;
    tracer.accumulate(traced, world.request.camera, settings, 1);
    double difference = 0.0, sum = 0.0, least = 1e30, most = 0.0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const double value = double(picture.pixels[i].y);
        difference += std::abs(value - traced.sums[3 * i + 1]);
        sum += value;
        least = std::min(least, value);
        most = std::max(most, value);
    }
    EXPECT_LT(difference, 0.03 * sum); // texels at the edges of hills and clouds
    EXPECT_LT(least, 0.15 * double(radiance.y));
    EXPECT_GT(most, 0.45 * double(radiance.y));
    EXPECT_LT(most, 0.7 * double(radiance.y));
}

} // namespace
} // namespace sunfleck::tests
