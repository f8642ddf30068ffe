// Frame times of brute force over those of the many-light system, and what the first frames cost.
#include "editor/command_line/thesis_experiments.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::command_line {
namespace {

// Brute force spreads nothing over frames: a few tell as much.
constexpr std::uint32_t first_frame_count = 60, first_frame_count_of_brute_force = 10;

// A system that takes turns with others: each has a renderer of its own, so that nothing is built again for a turn.
struct Contender {
    const char* name;
    gi::Settings settings;
    std::uint32_t frames; // measured in a turn
    std::unique_ptr<Bench> bench = nullptr;
    Measurement all = {};
    double frame_ms = 0, lighting = 0; // medians of the last turn
};

void append(Measurement& all, const Measurement& part) {
    all.frame_ms.insert(all.frame_ms.end(), part.frame_ms.begin(), part.frame_ms.end());
    all.gpu_ms.insert(all.gpu_ms.end(), part.gpu_ms.begin(), part.gpu_ms.end());
    all.cpu_ms.insert(all.cpu_ms.end(), part.cpu_ms.begin(), part.cpu_ms.end());
    all.counters = part.counters;
}

// Maps as the full system has them: static geometry is drawn once, movers over it, in at most map_budget maps a frame.
gi::Settings brute_force_kept_maps(std::uint32_t lights) {
    gi::Settings settings = brute_force(lights);
    settings.kept_maps = true;
    return settings;
}

gi::Settings without_baked_light(std::uint32_t lights) {
    gi::Settings settings = many_light(lights);
    settings.with("baked_light", "off");
    return settings;
}

Status take_turn(Contender& contender) {
    SUNFLECK_ASSIGN(const Measurement m, contender.bench->measure(contender.settings, 1, contender.frames, true));
    contender.frame_ms = median(m.frame_ms);
    contender.lighting = lighting_ms(m);
    append(contender.all, m);
    return {};
}

// Ratios of a pair of contenders, turn by turn.
struct RatioRow {
    const char* name;
    const Contender& slow;
    const Contender& fast;
    bool lighting;
    const char* note;
    std::vector<double> ratios = {};
};

// The median, with minimum and maximum in the note.
void report(Experiment& experiment, const std::string& where, double x, const RatioRow& row) {
    char text[200];
    std::snprintf(text, sizeof text, "%.1f to %.1f in %zu turns; %s",
                  *std::min_element(row.ratios.begin(), row.ratios.end()),
                  *std::max_element(row.ratios.begin(), row.ratios.end()), row.ratios.size(), row.note);
    experiment.value("ratio", where, row.name, x, median(row.ratios), text);
}

// All take turns, because shared machines change speed within seconds: each ratio is of two measurements of one turn,
// and the median of the ratios is reported.
Status ratios(Experiment& experiment, const std::string& scene, const std::string& camera, std::uint32_t lights) {
    Contender contenders[] = {{"brute force", brute_force(lights), 2},
                              {"brute force, kept maps", brute_force_kept_maps(lights), 2},
                              {"full system", many_light(lights), experiment.options.repeat},
                              {"without baked light", without_baked_light(lights), experiment.options.repeat}};
    for (Contender& contender : contenders) {
        SUNFLECK_ASSIGN(contender.bench, Bench::create(experiment.options, scene, camera, thesis_size));
        SUNFLECK_TRY(contender.bench->measure(contender.settings, warm_up(contender.settings), 1, true));
    }
    const auto& [brute, kept, full, rough] = contenders;
    RatioRow rows[] = {
        {"whole frame", brute, full, false,
         "brute force, which redraws every affected map whole, over the full system"},
        {"whole frame, kept maps", kept, full, false,
         "brute force with the same maps over the full system; target 15 at 300, 25 at 1024"},
        {"whole frame, kept maps, no baked light", kept, rough, false,
         "the same over the system without baked light, which the thesis has not; target 12 at 300"},
        {"lighting", brute, full, true, "brute force over the full system, without g-buffer and composition"}};
    for (std::uint32_t turn = 0; turn < experiment.options.turns; ++turn) {
        for (Contender& contender : contenders)
            SUNFLECK_TRY(take_turn(contender));
        for (RatioRow& row : rows)
            row.ratios.push_back(row.lighting ? row.slow.lighting / row.fast.lighting
                                              : row.slow.frame_ms / row.fast.frame_ms);
        if (interrupted())
            return Error{"interrupted"};
    }
    const std::string where = scene + " " + camera;
    for (const Contender& contender : contenders)
        experiment.row("ratio", where, contender.name, lights, contender.all);
    for (const RatioRow& row : rows)
        report(experiment, where, lights, row);
    return {};
}

// The first lamp gets a fifth darker, and looks so.
void change_a_light(ecs::Registry& registry) {
    ecs::Entity lamp = ecs::null_entity;
    registry.view<scene::AreaLight>().each([&](ecs::Entity entity, const scene::AreaLight&) {
        if (lamp.is_null())
            lamp = entity;
    });
    if (lamp.is_null())
        return;
    registry.patch<scene::AreaLight>(lamp, [](scene::AreaLight& light) { light.radiance *= 0.8f; });
    if (registry.has<scene::Material>(lamp))
        registry.patch<scene::Material>(lamp, [](scene::Material& material) { material.emission *= 0.8f; });
}

void report_first_frames(Experiment& experiment, const std::string& where, const std::string& since,
                         const Measurement& m) {
    double total = 0;
    for (const double ms : m.frame_ms)
        total += ms;
    const std::vector<double> later(m.frame_ms.begin() + 1, m.frame_ms.end());
    experiment.value("first frames", where, "ms of the first frame from " + since, 300, m.frame_ms.front(),
                     "walks, visibility, all maps, baked light");
    const std::string count = std::to_string(m.frame_ms.size());
    experiment.value("first frames", where, "ms of frames 2 to " + count + " from " + since, 300, median(later),
                     "median");
    experiment.value("first frames", where, "ms of all " + count + " from " + since, 300, total, "");
}

// What the ratios' warm-up leaves out.
Status first_frames(Experiment& experiment, const std::string& scene) {
    for (const bool full : {false, true}) {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(experiment.options, scene, "bench_1", thesis_size));
        const gi::Settings settings = full ? many_light(300) : brute_force(300);
        const std::uint32_t count = full ? first_frame_count : first_frame_count_of_brute_force;
        const std::string where = scene + (full ? ", full system" : ", brute force");
        SUNFLECK_ASSIGN(const Measurement load, bench->measure(settings, 0, count, true));
        report_first_frames(experiment, where, "load", load);
        const gi::System& lighting = bench->renderer->lighting();
        const std::uint64_t samples = lighting.sample_set().generation();
        change_a_light(bench->renderer->registry());
        SUNFLECK_ASSIGN(const Measurement change, bench->measure(settings, 0, count, true));
        if (lighting.sample_set().generation() == samples)
            return Error{"bench thesis: in '" + scene + "' no light has changed, so that its cost cannot be measured"};
        report_first_frames(experiment, where, "a light's first change", change);
    }
    return {};
}

bool is_chosen(const Experiment& experiment, const std::string& scene) {
    return experiment.options.scene.empty() || experiment.options.scene == scene;
}

} // namespace

Status time_ratios(Experiment& experiment) {
    for (const std::string& scene : thesis_scenes)
        for (const std::string& camera : thesis_cameras.at(scene))
            if (is_chosen(experiment, scene))
                SUNFLECK_TRY(ratios(experiment, scene, camera, 300));
    return is_chosen(experiment, "four_pillars") ? ratios(experiment, "four_pillars", "bench_1", 1024) : Status{};
}

Status time_first_frames(Experiment& experiment) {
    for (const std::string& scene : thesis_scenes)
        if (is_chosen(experiment, scene))
            SUNFLECK_TRY(first_frames(experiment, scene));
    return {};
}

} // namespace sunfleck::command_line
