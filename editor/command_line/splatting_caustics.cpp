// Caustics by glossy pixel lights: how their places and their shapes change the error; metal and glass beside light
// tracing.
#include "editor/command_line/metrics.h"
#include "editor/command_line/splatting_experiments.h"
#include "gi_module/light_sampling/refracted_light.h"
#include "gi_module/reference/light_tracer.h"

#include <string>
#include <utility>
#include <vector>

namespace sunfleck::command_line {
namespace {

struct CausticWay {
    const char* name;
    const char* importance;
    const char* footprints;
};
constexpr CausticWay caustic_ways[] = {{"uniform, eq. 3", "none", "off"},
                                       {"flux x exponent, eq. 3", "flux", "off"},
                                       {"flux x exponent, beams", "flux", "on"}};

// Of the reference, for each pixel; where a caustic is, more arrive.
constexpr std::uint32_t traced_particles = 2048;

gi::Settings lobes(const CausticWay& way, const char* count) {
    gi::Settings settings = splats_alone(0, "maps").with("splat_rays", "65536").with("glossy_splats", count);
    return settings.with("splat_importance", way.importance).with("splat_footprints", way.footprints);
}

// Only where there is more light than in the mean: the caustic.
void leave_caustic(io::Picture& picture) {
    double mean = 0.0, lit = 0.0;
    for (const vec4& pixel : picture.pixels) {
        mean += pixel.w > 0.0f ? double(luminance(vec3(pixel))) : 0.0;
        lit += pixel.w > 0.0f ? 1.0 : 0.0;
    }
    for (vec4& pixel : picture.pixels)
        if (double(luminance(vec3(pixel))) * lit <= mean)
            pixel.w = 0.0f;
}

double energy(const io::Picture& picture, const io::Picture& where) {
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        sum += where.pixels[i].w > 0.0f ? double(luminance(vec3(picture.pixels[i]))) : 0.0;
    return sum;
}

// All but metal and glass, in black: what then arrives anywhere by way of a surface is their caustic.
void blacken_others(ecs::Registry& registry) {
    std::vector<ecs::Entity> others;
    registry.view<scene::Material>().each([&](ecs::Entity entity, const scene::Material& material) {
        if (material.metallic <= 0.0f && material.transmission <= 0.0f)
            others.push_back(entity);
    });
    for (const ecs::Entity entity : others) {
        registry.patch<scene::Material>(entity, [](scene::Material& material) {
            material.base_colour = vec3(0.0f);
            material.specular = false;
        });
        if (registry.has<scene::SurfacePattern>(entity))
            registry.remove<scene::SurfacePattern>(entity);
    }
}

// By light tracing, in a copy of the scene. `bounces`: surfaces of metal or glass on the way at most.
Result<io::Picture> traced_caustic(const SplatExperiment& experiment, const std::string& scene, std::uint32_t bounces) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, scene, splat_picture_size));
    viewer::SceneRenderer& renderer = *bench->renderer;
    blacken_others(renderer.registry());
    SUNFLECK_TRY(renderer.rays().update(renderer.registry(), renderer.meshes()));
    const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
    const gi::reference::LightTracer tracer(renderer.rays(),
                                            gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds));
    gi::reference::ReferenceSettings settings;
    settings.width = bench->request.width;
    settings.height = bench->request.height;
    settings.view = gi::reference::ReferenceView::indirect;
    settings.bounces = bounces;
    gi::reference::Accumulation sums;
    tracer.accumulate(sums, bench->start, settings, traced_particles);
    io::Picture picture{settings.width, settings.height, {}};
    for (std::size_t i = 0; i < sums.covered.size(); ++i)
        picture.pixels.emplace_back(
            vec3(float(sums.sums[i * 3]), float(sums.sums[i * 3 + 1]), float(sums.sums[i * 3 + 2])) /
                float(traced_particles),
            sums.covered[i] ? 1.0f : 0.0f);
    return picture;
}

struct Aim {
    std::string energy, error;
};

// The reference has means over pixels, and caustics have edges and lines thinner than those: pixel lights are evaluated
// at 3x3 places in each.
constexpr std::uint32_t places_across = 3;
constexpr Size fine_size{splat_picture_size.width * places_across, splat_picture_size.height* places_across};

Result<io::Picture> mean_picture(Bench& bench, const gi::Settings& settings) {
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(settings));
    SUNFLECK_ASSIGN(const io::Picture fine, splat_picture(bench, 0));
    io::Picture mean{splat_picture_size.width, splat_picture_size.height, {}};
    mean.pixels.resize(std::size_t(mean.width) * mean.height, vec4(0.0f));
    for (std::size_t i = 0; i < fine.pixels.size(); ++i) {
        const std::size_t x = i % fine.width, y = i / fine.width;
        vec4& pixel = mean.pixels[y / places_across * mean.width + x / places_across];
        const float share = fine.pixels[i].w > 0.0f ? 1.0f / float(places_across * places_across) : 0.0f;
        pixel += vec4(share * vec3(fine.pixels[i]), share);
    }
    return mean;
}

// Rows of one way to light, where the traced picture has its caustic.
struct TruthRows {
    SplatExperiment& experiment;
    std::string scene;
    Bench& bench; // of fine pictures
    Aim aim;

    Status add(const std::string& what, const gi::Settings& settings,
               std::initializer_list<std::pair<const char*, const io::Picture*>> truths) const {
        SUNFLECK_ASSIGN(const io::Picture picture, mean_picture(bench, settings));
        for (const auto& [name, truth] : truths) {
            experiment.row(scene, what + name, "energy to the reference, relative",
                           energy(picture, *truth) / energy(*truth, *truth) - 1.0, aim.energy);
            experiment.row(scene, what + name, "truth error",
                           compare_pictures(picture, *truth, true).relative_mean_square_error, aim.error);
        }
        return {};
    }
};

// Light that glass refracts: beside what passes four surfaces at most, and what passes as many as are followed.
Status splat_glass(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(io::Picture four, traced_caustic(experiment, "glass", 4));
    SUNFLECK_ASSIGN(io::Picture all, traced_caustic(experiment, "glass", gi::most_glass_surfaces));
    leave_caustic(four);
    leave_caustic(all);
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "glass", fine_size));
    const TruthRows rows{experiment, "glass", *bench, {"target: within 0.1", "target: at most 0.3"}};
    const std::pair<const char*, const char*> cases[] = {
        {"off", "4096"}, {"single", "4096"}, {"traced", "1024"}, {"traced", "4096"}, {"traced", "16384"}};
    for (const auto& [refraction, count] : cases)
        SUNFLECK_TRY(rows.add(std::string(refraction) + ", " + count + " lights",
                              lobes(caustic_ways[2], count).with("splat_refraction", refraction),
                              {{", 4 bounces", &four}, {", 16 bounces", &all}}));
    return {};
}

Status splat_ring(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(io::Picture truth, traced_caustic(experiment, "ring", 1));
    leave_caustic(truth);
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "ring", fine_size));
    const TruthRows rows{experiment, "ring", *bench, {"target: within 0.05", "target: at most 0.15"}};
    const std::pair<const CausticWay&, const char*> cases[] = {
        {caustic_ways[1], "4096"}, {caustic_ways[2], "1024"}, {caustic_ways[2], "4096"}, {caustic_ways[2], "16384"}};
    for (const auto& [way, count] : cases)
        SUNFLECK_TRY(rows.add(std::string(way.name) + ", " + count + " lights", lobes(way, count), {{"", &truth}}));
    return {};
}

} // namespace

Status splat_caustics(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "ring", splat_picture_size));
    const auto picture_of = [&](const gi::Settings& settings) -> Result<io::Picture> {
        SUNFLECK_TRY(bench->renderer->lighting().set_settings(settings));
        return splat_picture(*bench, 0);
    };
    SUNFLECK_ASSIGN(io::Picture limit, picture_of(lobes({"", "none", "off"}, "65536")));
    SUNFLECK_ASSIGN(io::Picture beams, picture_of(lobes({"", "none", "on"}, "65536")));
    leave_caustic(limit);
    experiment.row("ring", "65,536 beams against 65,536 lobes of eq. 3", "relative MSE",
                   compare_pictures(beams, limit, true).relative_mean_square_error);
    for (const CausticWay& way : caustic_ways)
        for (const char* count : {"1024", "4096"}) {
            SUNFLECK_ASSIGN(const io::Picture picture, picture_of(lobes(way, count)));
            const std::string what = std::string(way.name) + ", " + count + " lights";
            const io::Picture& own = std::string_view(way.footprints) == "on" ? beams : limit;
            io::Picture expected = own;
            for (std::size_t i = 0; i < expected.pixels.size(); ++i)
                expected.pixels[i].w = limit.pixels[i].w;
            experiment.row("ring", what, "E to the limit of its shape",
                           compare_pictures(picture, expected, true).relative_mean_square_error,
                           "target: an eighth by each of importance and shape");
            experiment.row("ring", what, "E to 65,536 lobes of eq. 3",
                           compare_pictures(picture, limit, true).relative_mean_square_error);
            experiment.row("ring", what, "energy, relative", energy(picture, limit) / energy(limit, limit) - 1.0,
                           "target: within 0.05");
        }
    SUNFLECK_TRY(splat_ring(experiment));
    return splat_glass(experiment);
}

} // namespace sunfleck::command_line
