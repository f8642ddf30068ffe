// sunfleck bench splatting: the list of its experiments, and what they have in common.
#include "editor/command_line/splatting_experiments.h"

namespace sunfleck::command_line {
namespace {

struct SplatPart {
    const char* name;
    Status (*run)(SplatExperiment& experiment);
};

constexpr SplatPart splat_parts[] = {
    {"warp", splat_errors},   {"flicker", splat_flicker}, {"occlusion", splat_occlusion}, {"cutoff", splat_cutoff},
    {"lamps", splat_lamps},   {"system", splat_system},   {"caustics", splat_caustics},   {"table1", splat_table1},
    {"table2", splat_table2}, {"table3", splat_table3},   {"gather", splat_gather},       {"bounds", splat_bounds},
};

} // namespace

std::vector<std::string> splatting_parts() {
    std::vector<std::string> names;
    for (const SplatPart& part : splat_parts)
        names.emplace_back(part.name);
    return names;
}

Result<std::unique_ptr<Bench>> open_splat_scene(const BenchOptions& options, const std::string& scene, Size size) {
    SUNFLECK_ASSIGN(auto bench, Bench::create(options, scene, "bench_1", size));
    ecs::Registry& registry = bench->renderer->registry();
    if (scene == "arena")
        for (const char* lamp : {"ceiling lamp 0", "ceiling lamp 1"})
            if (const ecs::Entity entity = scene::find_by_name(registry, lamp);
                registry.has<scene::AreaLight>(entity)) {
                registry.patch<scene::AreaLight>(entity, [](scene::AreaLight& light) { light.radiance = vec3(0.0f); });
                // What the path tracer's scattered rays find of a lamp is its surface.
                registry.patch<scene::Material>(entity,
                                                [](scene::Material& surface) { surface.emission = vec3(0.0f); });
            }
    bench->request.view = shared::view_irradiance;
    bench->request.tone_map = false;
    return bench;
}

gi::Settings splats_alone(std::uint32_t count, const char* occlusion) {
    gi::Settings settings;
    settings.lights = 4;
    settings.low_resolution = 1;
    settings.bounces = 1;
    settings.with("direct", "none").with("punctual", "none").with("splat_lights", "all");
    return settings.with("splats", std::to_string(count)).with("splat_occlusion", occlusion);
}

gi::Settings splat_limit(const char* occlusion) {
    gi::Settings settings = splats_alone(65536, occlusion);
    return settings.with("splat_rays", "65536").with("splat_importance", "none").with("splat_pattern", "fixed");
}

Result<io::Picture> splat_picture(Bench& bench, std::uint64_t step, float orbit) {
    bench.request.step = step;
    bench.request.camera = bench.start.orbited(glm::radians(orbit));
    SUNFLECK_TRY(bench.renderer->render_and_wait(bench.request));
    return bench.renderer->read_back();
}

double passes_ms(const Measurement& measurement, std::initializer_list<std::string_view> names) {
    std::vector<double> values;
    for (const auto& frame : measurement.gpu_ms) {
        double sum = 0.0;
        for (const auto& [pass, time] : frame)
            for (const std::string_view name : names)
                sum += pass.starts_with(name) ? time : 0.0;
        values.push_back(sum);
    }
    return median(values);
}

double stage_ms(const Measurement& measurement, const std::string& stage) {
    std::vector<double> values;
    for (const auto& frame : measurement.cpu_ms)
        if (const auto found = frame.find(stage); found != frame.end())
            values.push_back(found->second);
    return values.empty() ? 0.0 : median(values);
}

Result<BenchTable> bench_splatting(const BenchOptions& options) {
    BenchTable table{"splatting", {}, {}};
    SplatExperiment experiment{options, table};
    Progress progress("bench splatting");
    double done = 0.0;
    for (const SplatPart& part : splat_parts) {
        if (!options.part.empty() && options.part != part.name)
            continue;
        experiment.part = part.name;
        SUNFLECK_TRY(part.run(experiment));
        done += 1.0 / double(std::size(splat_parts));
        progress.show(options.part.empty() ? done : 1.0, "");
        if (interrupted())
            return Error{"interrupted"};
    }
    return table;
}

} // namespace sunfleck::command_line
