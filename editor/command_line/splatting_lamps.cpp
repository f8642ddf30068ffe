// Splatted light of many lamps on one budget.
#include "editor/command_line/splatting_experiments.h"
#include "engine/scene/components.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::command_line {
namespace {

// Lamps beside that of `arena`: every eighth in the hall, the others shut up in the boxes of its gallery.
void add_lamps(ecs::Registry& registry, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
        scene::Transform transform;
        transform.position =
            i % 8 == 0 ? vec3(-3.5f + 0.125f * float(i), 3.0f, 4.0f) : vec3(-7.4f + 0.23f * float(i), 0.8f, -6.7f);
        const ecs::Entity lamp = registry.create();
        registry.emplace<scene::Name>(lamp, {"one of many"});
        registry.emplace<scene::Transform>(lamp, transform);
        registry.emplace<scene::PointLight>(lamp, {vec3(5.0f)});
        scene::Mover mover;
        mover.path = scene::MoverPath::line;
        mover.travel = vec3(0.0f, 0.3f, 0.3f);
        mover.period = 4.0f;
        registry.emplace<scene::Mover>(lamp, mover);
    }
}

// The passes and the stage of splatted light, median of some frames, ms.
Result<std::pair<double, double>> splat_times(Bench& bench, const gi::Settings& settings, std::uint32_t frames) {
    SUNFLECK_ASSIGN(const Measurement m, bench.measure(settings, 3, frames, true));
    std::vector<double> passes, stages;
    for (std::size_t i = 0; i < m.gpu_ms.size(); ++i) {
        double sum = 0.0;
        for (const auto& [pass, time] : m.gpu_ms[i])
            sum += pass.starts_with("splat") || pass.starts_with("repair splat") ? time : 0.0;
        passes.push_back(sum);
        const auto stage = m.cpu_ms[i].find("pixel lights");
        stages.push_back(stage != m.cpu_ms[i].end() ? stage->second : 0.0);
    }
    return std::pair{median(passes), median(stages)};
}

} // namespace

Status splat_lamps(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto one, open_splat_scene(experiment.options, "arena", splat_time_size));
    SUNFLECK_ASSIGN(const auto many, open_splat_scene(experiment.options, "arena", splat_time_size));
    add_lamps(many->renderer->registry(), 63);
    gi::Settings settings =
        splats_alone(512, "maps").with("splat_importance", "contribution").with("splat_rays", "16384");
    settings.low_resolution = 4;
    settings.lights = 256;
    std::vector<double> pass_ratios, stage_ratios, stage_ms;
    for (std::uint32_t turn = 0; turn < experiment.options.repeat; ++turn) {
        // A B B A
        SUNFLECK_ASSIGN(const auto a, splat_times(*one, settings, 5));
        SUNFLECK_ASSIGN(const auto b, splat_times(*many, settings, 5));
        SUNFLECK_ASSIGN(const auto c, splat_times(*many, settings, 5));
        SUNFLECK_ASSIGN(const auto d, splat_times(*one, settings, 5));
        pass_ratios.push_back((b.first + c.first) / (a.first + d.first));
        stage_ratios.push_back((b.second + c.second) / (a.second + d.second));
        stage_ms.push_back(0.5 * (b.second + c.second));
    }
    experiment.row("arena", "64 moving lamps, 512 lights", "GPU passes over those of one lamp", median(pass_ratios),
                   "target: at most 2");
    experiment.row("arena", "64 moving lamps, 512 lights", "CPU stage over that of one lamp", median(stage_ratios));
    experiment.row("arena", "64 moving lamps, 512 lights", "CPU stage, ms", median(stage_ms));
    experiment.row("arena", "64 moving lamps, 512 lights", "splats", many->renderer->statistics().counters["splats"]);
    return {};
}

} // namespace sunfleck::command_line
