#include "gi_module/visibility/scene_visibility.h"

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
    options.patches.space = input.changes.space;
    options.max_row_bytes = input.max_buffer_bytes;
    const bool same_options =
        options_ && options.patches.levels == options_->patches.levels && options.tests == options_->tests;
    std::span<const std::uint32_t> moved = input.moved_samples;
    const bool build = sample_generation_ != input.sample_generation || input.static_changed || !same_options;
    if (build) {
        sample_generation_ = 0; // in case it is stopped
        if (!database_.build(input.registry, input.meshes, input.samples, options, input.progress))
            return database_.problem();
        options_ = options;
        sample_generation_ = input.sample_generation;
        moved = {};
    }
    database_.begin_frame();
    const bool all = find_movers(input, build);
    {
        const StageTimer timer(input.cpu_times, "visibility of samples");
        database_.change_samples(input.samples, moved, movers_);
    }
    if (all)
        database_.update_movers(movers_, input.meshes);
    else
        database_.change_movers(movers_, gone_, input.meshes);
    return {};
}

// Those that may have changed, and whether they are all that there are. `all`: the database knows none of them.
bool SceneVisibility::find_movers(const VisibilityInput& input, bool all) {
    all = all || !mover_cursor_.follows(input.changes) || lighting_generation_ != input.lighting_generation;
    mover_cursor_.saw(input.changes);
    lighting_generation_ = input.lighting_generation;
    movers_.clear();
    gone_.clear();
    const auto add = [&](const scene::Drawable& drawable) {
        const scene::DrawItem* item = input.gpu_scene.find(drawable.entity);
        if (item == nullptr) // its mesh is not on the GPU yet: looked for again in the next frame
            mover_cursor_ = {};
        if (item == nullptr || drawable.is_static)
            return gone_.push_back(drawable.entity);
        movers_.push_back(MoverPlace::of(drawable));
        movers_.back().lit = !input.lit_elsewhere || !input.lit_elsewhere(*item);
    };
    if (all) {
        for (const scene::Drawable* drawable : input.changes.all)
            add(*drawable);
        return true;
    }
    for (const scene::DrawableChange& change : input.changes.drawables)
        if (change.removed())
            gone_.push_back(change.entity);
        else if (change.is_mover())
            add(*change.now);
    return false;
}

} // namespace sunfleck::gi
