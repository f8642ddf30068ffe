#include "gi_module/visibility/scene_visibility.h"

#include <chrono>

namespace sunfleck::gi {
namespace {

constexpr Counter tests{"visibility_tests", "tests", "visibility",
                        "Tests of movers and blockers against occlusion pyramids, and of clusters"};
constexpr Counter pairs_full{"pairs_full", "pairs", "visibility",
                             "Pairs of surface patch and sample that one blocker separates"};
constexpr Counter pairs_partial{"pairs_partial", "pairs", "visibility",
                                "Pairs of surface patch and sample between which something may stand"};
constexpr Counter pairs_none{"pairs_none", "pairs", "visibility",
                             "Pairs of surface patch and sample that see each other freely"};
constexpr Counter pairs_unlit{"pairs_unlit", "pairs", "visibility",
                              "Pairs whose patch faces away from the sample, or lies behind it"};
constexpr Counter patches{"surface_patches", "patches", "visibility", "Leaves of the tree over static surfaces"};
constexpr Counter memory{"visibility_database", "B", memory_group, "The visibility database on the CPU"};

MoverPlace place_of(const VisibilityInput& input, const scene::DrawItem& item) {
    MoverPlace place;
    place.entity = item.entity;
    place.mesh = input.registry.get<scene::MeshInstance>(item.entity).mesh;
    place.matrix = input.registry.get<scene::WorldTransform>(item.entity).matrix;
    place.blocks = item.casts_shadow;
    place.revision = input.meshes.revision(place.mesh);
    place.solid = item.kind != scene::surface_kind_holes && place.revision == 0;
    place.lit = !input.lit_elsewhere || !input.lit_elsewhere(item);
    return place;
}

} // namespace

std::span<const Counter> SceneVisibility::counters() {
    static const Counter all[] = {tests, pairs_full, pairs_partial, pairs_none, pairs_unlit, patches, memory};
    return all;
}

void SceneVisibility::report(Report& report) const {
    const VisibilityCounters& counted = database_.counters();
    report.set(tests, double(counted.tests));
    report.set(pairs_full, double(counted.full));
    report.set(pairs_partial, double(counted.partial));
    report.set(pairs_none, double(counted.none));
    report.set(pairs_unlit, double(counted.unlit));
    report.set(patches, double(database_.patches().leaves()));
    report.set(memory, double(database_.memory_bytes()));
}

Status SceneVisibility::update(const VisibilitySettings& settings, const VisibilityInput& input) {
    VisibilityOptions options;
    options.patches.levels = settings.patch_levels;
    options.tests = settings.visibility_tests;
    const bool same_options =
        options_ && options.patches.levels == options_->patches.levels && options.tests == options_->tests;
    std::span<const std::uint32_t> moved = input.moved_samples;
    if (sample_generation_ != input.sample_generation || input.static_changed || !same_options) {
        sample_generation_ = 0; // in case it is stopped
        if (!database_.build(input.registry, input.meshes, input.samples, options, input.progress))
            return Error{"preparing the lighting was stopped"};
        options_ = options;
        sample_generation_ = input.sample_generation;
        moved = {};
    }
    database_.begin_frame();
    const auto start = std::chrono::steady_clock::now();
    database_.change_samples(input.samples, moved);
    sample_milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    follow_movers(input);
    return {};
}

void SceneVisibility::follow_movers(const VisibilityInput& input) {
    std::vector<MoverPlace> movers;
    for (const scene::DrawItem& item : input.gpu_scene.draws())
        if (!item.is_static)
            movers.push_back(place_of(input, item));
    database_.update_movers(movers, input.meshes);
}

} // namespace sunfleck::gi
