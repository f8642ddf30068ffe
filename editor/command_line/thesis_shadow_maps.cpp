// The thesis's experiments with shadow maps and visibility.
#include "editor/command_line/thesis_experiments.h"

#include "engine/scene/procedural.h"

#include <algorithm>

namespace sunfleck::command_line {
namespace {

struct MoverCase {
    const char *scene, *mover, *note;
};

// Leaves only one of the scene's movers.
void keep_mover(ecs::Registry& registry, const std::string& mover) {
    std::vector<ecs::Entity> others;
    registry.view<scene::Mover, scene::Name>().each(
        [&](ecs::Entity entity, const scene::Mover&, const scene::Name& name) {
            if (name.name != mover)
                others.push_back(entity);
        });
    for (const ecs::Entity entity : others)
        registry.destroy(entity);
}

constexpr std::uint32_t run_frames = 200; // as in the thesis

Status measure_budget(Experiment& experiment, Bench& bench, const MoverCase& c, std::uint32_t budget) {
    gi::Settings settings = many_light(300);
    settings.map_budget = budget;
    SUNFLECK_ASSIGN(const Measurement m, bench.measure(settings, 6, run_frames, budget > 0));
    const std::string mover = c.mover;
    experiment.row("5-4", c.scene, mover + ", maps per frame", budget, m, c.note);
    const double map_ms = Bench::gpu_median(m, "shadow maps") + Bench::gpu_median(m, "shadow map copies");
    experiment.value("5-6", c.scene, mover + ", fraction of maps and visibility", budget,
                     (map_ms + cpu_median(m, "visibility")) / median(m.frame_ms),
                     "thesis: maps dominate at high counts");
    if (budget == 100)
        experiment.value("5-5", c.scene, mover + ", vertices per map", budget,
                         double(m.counters["shadow_map_vertices"]) / double(m.counters["shadow_map_updates"]), c.note);
    return {};
}

Status one_mover_ratio(Experiment& experiment, Bench& bench) {
    SUNFLECK_ASSIGN(const Measurement brute, bench.measure(brute_force(300), 1, 3, true));
    gi::Settings settings = many_light(300);
    settings.map_budget = 100;
    SUNFLECK_ASSIGN(const Measurement full, bench.measure(settings, 6, experiment.options.repeat, true));
    experiment.value("ratio", "four_pillars", "one complex mover, 100 maps per frame", 300,
                     median(brute.frame_ms) / median(full.frame_ms), "target 6");
    return {};
}

} // namespace

Status map_updates(Experiment& experiment) {
    for (const MoverCase& c :
         {MoverCase{"four_pillars", "torus", "820 vertices"}, MoverCase{"four_pillars", "knot", "3,000 vertices"},
          MoverCase{"table_room", "knot", "3,000 vertices"}}) {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, c.scene, "bench_1", thesis_size));
        keep_mover(bench->renderer->registry(), c.mover);
        for (const std::uint32_t budget : {0u, 25u, 50u, 100u, 200u, 300u})
            SUNFLECK_TRY(measure_budget(experiment, *bench, c, budget));
        if (c.scene == std::string("four_pillars") && c.mover == std::string("knot"))
            SUNFLECK_TRY(one_mover_ratio(experiment, *bench));
    }
    return {};
}

namespace {

Status count_passes(Experiment& experiment, const std::string& scene, const std::string& camera, const char* figure) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, scene, camera, {64, 48}));
    gi::Settings settings = many_light(300);
    settings.with("count_passes", "on");
    settings.patch_levels = 3;
    const std::string where = scene + " " + camera;
    for (const bool extras : {false, true}) {
        settings.with("pass_extras", extras ? "on" : "off");
        SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 3, 1, true));
        const double before = double(m.counters["render_passes_unoptimised"]),
                     after = double(m.counters["render_passes"]);
        const std::string how = extras ? ", with harmless extra lights" : ", as in the thesis";
        if (!extras)
            experiment.value(figure, where, "passes before", 7, before, "thesis fig. 4-12: 1563");
        experiment.value(figure, where, "passes after" + how, 7, after, "thesis fig. 4-12: 447");
        experiment.value(figure, where, "removed" + how, 7, 1.0 - after / std::max(before, 1.0),
                         "target 0.7 in fig. 4-12's view");
        if (extras)
            experiment.value(figure, where, "pairs drawn over pairs needed", 7, m.counters["pass_fill"], "");
    }
    return {};
}

} // namespace

Status render_passes(Experiment& experiment) {
    for (const std::string& scene : thesis_scenes)
        for (const std::string& camera : thesis_cameras.at(scene))
            SUNFLECK_TRY(count_passes(experiment, scene, camera, "4-11"));
    return count_passes(experiment, "four_pillars", "pillar_close", "4-12");
}

namespace {

Status add_moving_boxes(viewer::SceneRenderer& renderer) {
    ecs::Registry& registry = renderer.registry();
    const std::uint32_t mesh = renderer.meshes().add(scene::make_box(vec3(0.25f)));
    SUNFLECK_TRY(renderer.upload_meshes());
    for (int i = 0; i < 100; ++i) {
        const ecs::Entity entity = registry.create();
        scene::Mover mover;
        mover.path = scene::MoverPath::circle;
        mover.centre =
            vec3(float(i % 10) * 0.7f - 3.15f, 0.3f + float(i / 50) * 1.5f, float(i / 10 % 10) * 0.7f - 3.15f);
        mover.period = 4.0f + float(i % 7);
        scene::Transform transform;
        transform.position = mover.centre + vec3(0.3f, 0.0f, 0.0f);
        registry.emplace<scene::Transform>(entity, transform);
        registry.emplace<scene::MeshInstance>(entity, {mesh});
        registry.emplace<scene::Material>(entity);
        registry.emplace<scene::Mover>(entity, mover);
    }
    return {};
}

} // namespace

// With 100 moving boxes: visibility tests and their time, by how samples and patches are grouped.
Status many_movers(Experiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, "four_pillars", "bench_1", {64, 48}));
    SUNFLECK_TRY(add_moving_boxes(*bench->renderer));
    const char* const names[] = {"clusters", "trees", "pairs"};
    double tests[3], times[3], pairs = 1;
    for (const gi::TestGrouping grouping :
         {gi::TestGrouping::clusters, gi::TestGrouping::trees, gi::TestGrouping::pairs}) {
        const std::size_t i = std::size_t(grouping);
        gi::Settings settings = many_light(300);
        settings.visibility_tests = grouping;
        settings.map_budget = 1;
        SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 2, experiment.options.repeat, true));
        tests[i] = double(m.counters["visibility_tests"]);
        times[i] = cpu_median(m, "visibility");
        pairs = 102.0 * 300.0 * double(m.counters["surface_patches"] + 102);
        experiment.row("movers", "four_pillars", std::string("102 movers, tests of ") + names[i], 300, m);
    }
    const auto report = [&](const char* what, double value, const char* note) {
        experiment.value("movers", "four_pillars", what, 300, value, note);
    };
    report("tests / (movers x nodes x samples)", tests[0] / pairs, "clusters; target: at most 0.1");
    report("tests / (movers x nodes x samples)", tests[1] / pairs, "trees");
    report("tests / (movers x nodes x samples)", tests[2] / pairs, "pairs");
    report("time relative to pairs", times[0] / times[2], "clusters; target: at most 0.2");
    report("time relative to trees", times[0] / times[1], "clusters");
    return {};
}

} // namespace sunfleck::command_line
