// Glossy light: its scattering function against the path tracer's, and pictures of a ball on a floor against the path
// tracer's pictures.
#include "editor/command_line/metrics.h"
#include "gi_module/reference/path_tracer.h"
#include "gi_module/transport/facets_shared.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

namespace sunfleck::tests {
namespace {

using namespace gi::reference;

vec3 at_angle(float cosine, float azimuth = 0.0f) {
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

scene::Material glossy_material(float metallic, float roughness, vec3 colour = vec3(1.0f)) {
    scene::Material material;
    material.base_colour = colour;
    material.metallic = metallic;
    material.roughness = roughness;
    material.specular = true;
    return material;
}

vec2 mix_of(std::size_t low, std::size_t high, float rest) {
    return glm::mix(gi::facet_table()[low], gi::facet_table()[high], rest);
}

// As the shader reads the table.
shared::Facets facets_from_table(const scene::Material& material, float cosine) {
    const float row = material.roughness * float(shared::facet_roughnesses - 1);
    const float column = std::sqrt(cosine) * float(shared::facet_cosines - 1);
    const std::size_t r = std::min(std::size_t(row), std::size_t(shared::facet_roughnesses - 2));
    const std::size_t c = std::min(std::size_t(column), std::size_t(shared::facet_cosines - 2));
    const std::size_t first = r * shared::facet_columns, next = first + shared::facet_columns;
    const vec2 seen = glm::mix(mix_of(first + c, first + c + 1, column - float(c)),
                               mix_of(next + c, next + c + 1, column - float(c)), row - float(r));
    const vec2 mean = mix_of(first + shared::facet_cosines, next + shared::facet_cosines, row - float(r));
    return shared::make_facets(material.base_colour, material.metallic,
                               gi::dielectric_reflectance(material.index_of_refraction), seen, mean);
}

// A white surface in a white surrounding, seen from any side, is as bright as that: lobe, repeated reflections and base
// together, by midpoints of a grid of equal solid angles, over half of the directions, which are symmetrical. (Where
// light grazes, lobes are a degree wide.)
TEST(Gloss, WhiteSurfacesReflectAllLight) {
    constexpr int rings = 192, sectors = 768;
    for (const float metallic : {0.0f, 0.4f, 1.0f})
        for (const float roughness : {0.3f, 0.5f, 0.75f, 1.0f})
            for (const float cosine : {0.1f, 0.3f, 0.6f, 1.0f}) {
                const scene::Material material = glossy_material(metallic, roughness);
                const shared::Facets facets = facets_from_table(material, cosine);
                const float alpha_squared = std::pow(roughness, 4.0f);
                double lobe = 0.0;
                for (int i = 0; i < rings; ++i)
                    for (int k = 0; k < sectors; ++k) {
                        const float m = (float(i) + 0.5f) / rings;
                        const vec3 to_light = at_angle(m, pi * (float(k) + 0.5f) / sectors);
                        lobe += double(
                            m * shared::facet_lobe(facets, alpha_squared, vec3(0, 0, 1), at_angle(cosine), to_light).x);
                    }
                lobe *= 2.0 * 3.14159265358979 / (double(rings) * sectors);
                EXPECT_NEAR(lobe + double(facets.repeated.x + facets.base), 1.0, 0.02)
                    << "metallic " << metallic << ", roughness " << roughness << ", cosine " << cosine;
            }
}

// Single reflections are those of the path tracer, whose function is what is left of the whole.
TEST(Gloss, LobesAreThePathTracers) {
    for (const float metallic : {0.0f, 0.5f, 1.0f})
        for (const float roughness : {0.15f, 0.4f, 1.0f})
            for (const float outgoing : {0.2f, 0.9f})
                for (const float azimuth : {0.3f, 2.0f, 3.1f}) {
                    const scene::Material material = glossy_material(metallic, roughness, vec3(0.9f, 0.6f, 0.3f));
                    const vec3 eye = at_angle(outgoing), light = at_angle(0.7f, azimuth);
                    const Bsdf bsdf(material);
                    vec3 expected = bsdf.evaluate(eye, light) - bsdf.evaluate_diffuse(eye, light);
                    const gi::GgxLayer coat(vec3(0.04f), roughness), metal(material.base_colour, roughness);
                    expected -=
                        (1.0f - metallic) * coat.multiple(eye.z, light.z) + metallic * metal.multiple(eye.z, light.z);
                    const vec3 lobe = shared::facet_lobe(facets_from_table(material, outgoing),
                                                         std::pow(roughness, 4.0f), vec3(0, 0, 1), eye, light);
                    for (int c = 0; c < 3; ++c)
                        EXPECT_NEAR(lobe[c], expected[c], 1e-3f * expected[c] + 1e-5f);
                }
}

// A ball on a floor in a room without a ceiling, by one kind of light. The floor of a metal ball is matt: light that
// metals reflect at one another is left to ray-traced mirrors.
enum class Light { point, sun, area, sky };

void make_ball(assets::SceneBuilder& scene, Light light, const scene::Material& material) {
    const vec3 grey(0.6f);
    ecs::Registry& registry = scene.registry();
    scene.quad("floor", vec3(-2, 0, -2), vec3(0, 0, 4), vec3(4, 0, 0),
               material.metallic > 0.0f ? assets::diffuse(grey) : material);
    scene.quad("wall", vec3(-2, 0, -2), vec3(4, 0, 0), vec3(0, 2.5f, 0), assets::diffuse(vec3(0.6f, 0.3f, 0.2f)));
    scene.quad("side", vec3(-2, 0, 2), vec3(0, 0, -4), vec3(0, 2.5f, 0), assets::diffuse(grey));
    scene::Transform place;
    place.position = vec3(-0.1f, 0.6f, 0.0f);
    scene.add("ball", scene::make_sphere(0.6f, 96, 48), material, place);
    if (light == Light::point)
        scene.point_light("lamp", vec3(1.2f, 2.2f, 1.0f), vec3(6.0f));
    scene::Transform lamp;
    lamp.position = vec3(0.9f, 2.3f, 0.4f);
    lamp.rotation = assets::facing(vec3(-0.3f, -1.0f, -0.2f));
    if (light == Light::area) {
        scene::AreaLight area;
        area.width = area.height = 0.8f;
        area.radiance = vec3(9.0f);
        scene.area_light("lamp", area, lamp);
    }
    const ecs::Entity far = registry.create();
    if (light == Light::sky)
        registry.emplace<scene::Environment>(far, {vec3(1.0f)});
    if (light == Light::sun) {
        scene::Transform transform;
        transform.rotation = assets::facing(vec3(0.5f, 1.0f, 0.4f));
        registry.emplace<scene::Transform>(far, transform);
        registry.emplace<scene::DirectionalLight>(far, {vec3(3.0f)});
    }
    scene.camera("view", vec3(1.6f, 1.5f, 2.6f), vec3(-0.2f, 0.5f, -0.1f), 50.0f);
    scene.camera("beside", vec3(1.9f, 2.4f, 1.9f), vec3(-1.9f, 2.4f, 4.0f), 30.0f);
}

class GlossTruth : public GpuTest {
protected:
    void open(Light light, const scene::Material& material, const char* camera = "view") {
        world = std::make_unique<GpuWorld>();
        assets::SceneBuilder scene(world->renderer->registry(), world->renderer->meshes());
        make_ball(scene, light, material);
        world->finish(camera);
        world->request.width = 72;
        world->request.height = 54;
        gi::Settings settings = gi::Settings().all_light_by("brute_force");
        settings.lights = 400;
        settings.bounces = 3;
        settings.shadow_filter = true;
        settings.with("specular", "gloss");
        world->set(settings);
    }
    io::Picture truth(ReferenceView view, std::uint32_t samples) {
        viewer::SceneRenderer& renderer = *world->renderer;
        EXPECT_TRUE(renderer.rays().update(renderer.registry(), renderer.meshes()));
        const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
        const PathTracer tracer(renderer.rays(), gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds));
        ReferenceSettings settings;
        settings.width = world->request.width;
        settings.height = world->request.height;
        settings.bounces = 3;
        settings.view = view;
        Accumulation sums;
        tracer.accumulate(sums, world->request.camera, settings, samples);
        io::Picture result{settings.width, settings.height, {}};
        for (std::size_t i = 0; i < sums.covered.size(); ++i)
            result.pixels.emplace_back(
                vec3(float(sums.sums[i * 3]), float(sums.sums[i * 3 + 1]), float(sums.sums[i * 3 + 2])) /
                    float(samples),
                sums.covered[i] ? 1.0f : 0.0f);
        return result;
    }
    // Of what the light samples show against the path tracer: relative MSE, and share of the mean that is missing.
    command_line::Metrics error(ReferenceView view, std::uint32_t samples) {
        world->request.view = view == ReferenceView::radiance ? shared::view_final : shared::view_irradiance;
        return command_line::compare_pictures(world->picture(), truth(view, samples), true);
    }
    std::unique_ptr<GpuWorld> world;
};

// Where the roughness is 0.3 or more, the final picture's error is at most twice that of the irradiance alone, which
// comes from the same samples. What is added to the bound is noise of the reference.
void expect_gloss_is_true(const char* what, const command_line::Metrics& matt, const command_line::Metrics& glossy) {
    std::printf("%s: relative MSE %.4f, of the irradiance %.4f; mean %+.1f %%, of the irradiance %+.1f %%\n", what,
                glossy.relative_mean_square_error, matt.relative_mean_square_error,
                100.0 * (glossy.mean_a / glossy.mean_b - 1.0), 100.0 * (matt.mean_a / matt.mean_b - 1.0));
    EXPECT_LE(glossy.relative_mean_square_error, 2.0 * matt.relative_mean_square_error + 0.004) << what;
    EXPECT_NEAR(glossy.mean_a / glossy.mean_b, matt.mean_a / matt.mean_b, 0.04) << what;
}

TEST_F(GlossTruth, BallsAreThePathTracers) {
    const struct {
        const char* name;
        Light light;
    } lights[] = {{"point", Light::point}, {"sun", Light::sun}, {"area", Light::area}, {"sky", Light::sky}};
    const float roughnesses[] = {0.3f, 0.7f, 1.0f};
    const std::uint32_t samples = by_size(64u, 512u);
    for (const auto& [name, light] : lights) {
        for (const float metallic : {0.0f, 1.0f})
            for (const float roughness : std::span(roughnesses).first(by_size(2u, 3u))) {
                open(light, glossy_material(metallic, roughness, vec3(0.8f, 0.6f, 0.4f)));
                const command_line::Metrics matt = error(ReferenceView::irradiance, samples);
                const std::string what = std::string(name) + ", metallic " + std::to_string(metallic) + ", roughness " +
                                         std::to_string(roughness);
                expect_gloss_is_true(what.c_str(), matt, error(ReferenceView::radiance, samples));
            }
    }
}

// Glossy surfaces that lie beside the picture leave it as it is without gloss.
TEST_F(GlossTruth, GlossThatNobodySeesIsNoError) {
    open(Light::point, glossy_material(1.0f, 0.3f), "beside");
    world->request.view = shared::view_final;
    const io::Picture with = world->picture();
    gi::Settings without = world->renderer->lighting().settings();
    world->set(without.with("specular", "none"));
    EXPECT_EQ(with.pixels, world->picture().pixels);
}

} // namespace
} // namespace sunfleck::tests
