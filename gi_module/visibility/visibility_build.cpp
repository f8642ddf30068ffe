// The static half of the database: patches, their subdivision, and what static geometry does to each pair.
#include "gi_module/visibility/visibility_database.h"

#include "engine/core/jobs.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <tuple>

namespace sunfleck::gi {
namespace {

constexpr std::size_t roots_per_group = 4;

// Place of a point on a curve that keeps neighbours together (Morton order of ten bits an axis).
std::uint32_t morton(vec3 point, const Bounds& bounds) {
    const vec3 unit = (point - bounds.minimum) / glm::max(bounds.extent(), vec3(1e-6f));
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::uint32_t place = std::uint32_t(std::clamp(unit[axis], 0.0f, 1.0f) * 1023.0f);
        for (std::uint32_t bit = 0; bit < 10; ++bit)
            code |= ((place >> bit) & 1u) << (3 * bit + std::uint32_t(axis));
    }
    return code;
}

PairState state_of(Blocking blocking) {
    switch (blocking) {
    case Blocking::none:
        return PairState::none;
    case Blocking::partial:
        return PairState::partial;
    case Blocking::full:
        return PairState::full;
    }
    return PairState::partial;
}

} // namespace

bool VisibilityDatabase::build(ecs::Registry& registry, const scene::MeshStore& meshes,
                               std::span<const LightSample> samples, const VisibilityOptions& options,
                               const std::function<bool(float)>& progress) {
    options_ = options;
    samples_ = samples;
    static_blockers_ = {};
    patches_.build(registry, meshes, options.patches, static_blockers_);
    movers_.clear();
    mover_slots_.clear();
    unlit_slots_.clear();
    changes_.clear();
    affected_.assign(samples_.size(), 0);
    static_states_.clear();
    if (!split_and_decide(progress)) {
        const std::uint64_t generation = generation_;
        *this = {};
        generation_ = generation + 1;
        return false;
    }
    patches_.finish();
    full_counts_.assign(static_states_.size(), 0);
    partial_counts_.assign(static_states_.size(), 0);
    make_clusters();
    groups_.clear();
    std::vector<std::uint32_t> roots(patches_.roots());
    std::iota(roots.begin(), roots.end(), 0u);
    if (!roots.empty())
        make_group(std::move(roots));
    for (std::uint32_t sample = 0; sample < samples_.size(); ++sample)
        if (samples_[sample].dynamic) {
            const std::vector<PairState> states = decide_all_static(sample);
            for (std::uint32_t node = 0; node < states.size(); ++node)
                static_states_[at(node, sample)] = std::uint8_t(states[node]);
        }
    rows_.clear();
    dirty_.clear();
    grow_rows();
    recount();
    ++generation_;
    return true;
}

namespace {

// Calls the host's function with the share of all work, from whichever thread gets there, and keeps its answer.
class Reporter {
public:
    Reporter(const std::function<bool(float)>& progress, std::uint32_t levels) : progress_(progress), levels_(levels) {}
    void begin_level(std::size_t nodes) {
        nodes_ = nodes;
        done_ = 0;
    }
    void end_level() { ++level_; }
    void add(std::size_t nodes) {
        done_ += nodes;
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!progress_ || !lock.owns_lock() || stopped_)
            return;
        const float share = float(done_) / float(std::max<std::size_t>(nodes_, 1));
        stopped_ = !progress_((float(level_) + share) / float(levels_ + 1));
    }
    bool stopped() const { return stopped_; }

private:
    const std::function<bool(float)>& progress_;
    std::uint32_t levels_, level_ = 0;
    std::size_t nodes_ = 0;
    std::atomic<std::size_t> done_{0};
    std::atomic<bool> stopped_{false};
    std::mutex mutex_;
};

} // namespace

// Level by level: decide all pairs of the level's nodes, then split those with enough partial pairs.
bool VisibilityDatabase::split_and_decide(const std::function<bool(float)>& progress) {
    Reporter reporter(progress, options_.patches.levels);
    std::uint32_t first = 0;
    while (first < patches_.nodes().size()) {
        const std::uint32_t end = std::uint32_t(patches_.nodes().size());
        static_states_.resize(at(end, 0));
        reporter.begin_level(end - first);
        parallel_for_chunks(end - first, 4, [&](std::size_t begin, std::size_t stop) {
            if (reporter.stopped())
                return;
            for (std::uint32_t node = first + std::uint32_t(begin); node < first + stop; ++node)
                for (std::uint32_t sample = 0; sample < samples_.size(); ++sample)
                    static_states_[at(node, sample)] = std::uint8_t(decide_static(node, sample));
            reporter.add(stop - begin);
        });
        if (reporter.stopped())
            return false;
        reporter.end_level();
        for (std::uint32_t node = first; node < end; ++node) {
            if (!patches_.can_split(node) ||
                (patches_.nodes().size() + 4) * std::uint64_t(samples_.size()) > options_.max_pairs)
                continue;
            std::size_t partial = 0, reached = 0;
            for (std::uint32_t sample = 0; sample < samples_.size(); ++sample) {
                if (samples_[sample].dynamic) // the tree does not follow what moves
                    continue;
                const PairState state = static_state(node, sample);
                partial += state == PairState::partial;
                reached += state == PairState::partial || state == PairState::none;
            }
            if (partial > 0 && double(partial) >= double(options_.split_share) * double(reached))
                patches_.split(node);
        }
        first = end;
    }
    return true;
}

PairState VisibilityDatabase::decide_static(std::uint32_t node, std::uint32_t sample) const {
    if (samples_[sample].dynamic)
        return PairState::partial; // until all nodes are known: see decide_all_static
    const SurfacePatch& patch = patches_.nodes()[node];
    PairState parent = PairState::partial;
    if (patch.parent != shared::no_node)
        parent = PairState(static_states_[at(patch.parent, sample)]);
    if (parent == PairState::full || parent == PairState::unlit)
        return parent;
    if (!patch.planar)
        return decide_box(patch, samples_[sample]);
    const auto pyramid = pyramid_of_patch(samples_[sample], patch.corners, patch.normal);
    if (!pyramid)
        return PairState::unlit;
    return parent == PairState::none ? PairState::none : state_of(static_blockers_.test(*pyramid));
}

// Of a part of a chart: only whether the sample's tangent plane hides it is looked at.
PairState VisibilityDatabase::inherit(const SurfacePatch& patch, PairState parent, const LightSample& sample) const {
    if (sample.kind != SampleKind::surface)
        return parent;
    for (const dvec3& corner : patch.corners)
        if (glm::dot(dvec3(sample.normal), corner - dvec3(sample.position)) > 0.0)
            return parent;
    return PairState::unlit;
}

// Parts come after their parents.
std::vector<PairState> VisibilityDatabase::decide_all_static(std::uint32_t sample) const {
    std::vector<PairState> result(patches_.nodes().size());
    const LightSample& light = samples_[sample];
    if (light.dynamic && !groups_.empty())
        decide_group(0, light, result);
    for (std::uint32_t node = 0; node < result.size(); ++node) {
        const SurfacePatch& patch = patches_.nodes()[node];
        if (patch.parent == shared::no_node) {
            if (!light.dynamic)
                result[node] = decide_static(node, sample);
            continue;
        }
        const PairState parent = result[patch.parent];
        if (parent == PairState::full || parent == PairState::unlit)
            result[node] = parent;
        else if (light.dynamic)
            result[node] = inherit(patch, parent, light);
        else if (const auto pyramid = pyramid_of_patch(light, patch.corners, patch.normal); !pyramid)
            result[node] = PairState::unlit;
        else
            result[node] = parent == PairState::none ? PairState::none : state_of(static_blockers_.test(*pyramid));
    }
    return result;
}

// All charts that one blocker hides, or the sample's tangent plane, at once.
void VisibilityDatabase::decide_group(std::uint32_t group, const LightSample& sample,
                                      std::vector<PairState>& states) const {
    const Group& node = groups_[group];
    const Bounds roomy{node.bounds.minimum - 1e-5f, node.bounds.maximum + 1e-5f};
    const auto pyramid = pyramid_of_box(sample, OrientedBox::of(roomy));
    if (!pyramid)
        return decide_roots(group, PairState::unlit, states);
    if (static_blockers_.covers(*pyramid))
        return decide_roots(group, PairState::full, states);
    for (const std::uint32_t root : node.roots) {
        const SurfacePatch& patch = patches_.nodes()[root];
        const bool behind = patch.planar && sample.kind != SampleKind::directional &&
                            glm::dot(patch.normal, dvec3(sample.position) - patch.corners[0]) <= 0.0;
        states[root] = behind         ? PairState::unlit
                       : patch.planar ? inherit(patch, PairState::partial, sample)
                                      : PairState::partial;
    }
    if (node.roots.empty()) {
        decide_group(node.left, sample, states);
        decide_group(node.right, sample, states);
    }
}

void VisibilityDatabase::decide_roots(std::uint32_t group, PairState state, std::vector<PairState>& states) const {
    const Group& node = groups_[group];
    for (const std::uint32_t root : node.roots)
        states[root] = state;
    if (node.roots.empty()) {
        decide_roots(node.left, state, states);
        decide_roots(node.right, state, states);
    }
}

PairState VisibilityDatabase::decide_box(const SurfacePatch& patch, const LightSample& sample) const {
    const auto pyramid = pyramid_of_box(sample, patch.box);
    return pyramid ? state_of(static_blockers_.test(*pyramid, patch.body)) : PairState::unlit;
}

// Movers shadow themselves, so all that static geometry can add is to hide them: if their middle is in sight, it does
// not.
PairState VisibilityDatabase::decide_mover(const MovingBlocker& mover, const LightSample& sample) const {
    const auto pyramid = pyramid_of_box(sample, mover.box());
    if (!pyramid)
        return PairState::unlit;
    const dvec3 middle = mover.box().centre;
    const bool parallel = sample.kind == SampleKind::directional;
    const dvec3 to_light = parallel ? -1e4 * dvec3(sample.normal) : dvec3(sample.position) - middle;
    if (!static_blockers_.crosses_segment(middle, to_light))
        return PairState::partial;
    return static_blockers_.covers(*pyramid) ? PairState::full : PairState::partial;
}

// Samples that move stand alone: clusters keep their shape.
void VisibilityDatabase::make_clusters() {
    clusters_.clear();
    cluster_of_.assign(samples_.size(), 0);
    Bounds bounds;
    for (const LightSample& sample : samples_)
        bounds.add(sample.position);
    std::vector<std::uint32_t> order(samples_.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](std::uint32_t i) {
        const bool unbounded = samples_[i].kind == SampleKind::directional;
        return std::tuple(samples_[i].dynamic, unbounded ? 0xffffffffu : morton(samples_[i].position, bounds), i);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
        const LightSample& sample = samples_[order[i]];
        const bool unbounded = sample.kind == SampleKind::directional;
        if (clusters_.empty() || sample.dynamic || clusters_.back().samples.size() >= samples_per_cluster ||
            clusters_.back().unbounded != unbounded)
            clusters_.emplace_back();
        Cluster& cluster = clusters_.back();
        cluster.unbounded = unbounded;
        cluster.bounds.add(sample.position);
        cluster.samples.push_back(order[i]);
        cluster_of_[order[i]] = std::uint32_t(clusters_.size() - 1);
    }
}

std::uint32_t VisibilityDatabase::make_group(std::vector<std::uint32_t> roots) {
    const std::uint32_t index = std::uint32_t(groups_.size());
    groups_.emplace_back();
    Bounds bounds, centres;
    for (const std::uint32_t root : roots) {
        bounds.add(patches_.nodes()[root].bounds);
        centres.add(patches_.nodes()[root].bounds.centre());
    }
    groups_[index].bounds = bounds;
    if (roots.size() <= roots_per_group) {
        groups_[index].roots = std::move(roots);
        return index;
    }
    const vec3 extent = centres.extent();
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::stable_sort(roots.begin(), roots.end(), [&](std::uint32_t a, std::uint32_t b) {
        return patches_.nodes()[a].bounds.centre()[axis] < patches_.nodes()[b].bounds.centre()[axis];
    });
    const auto middle = roots.begin() + std::ptrdiff_t(roots.size() / 2);
    const std::uint32_t left = make_group({roots.begin(), middle});
    const std::uint32_t right = make_group({middle, roots.end()});
    groups_[index].left = left;
    groups_[index].right = right;
    return index;
}

void VisibilityDatabase::change_samples(std::span<const LightSample> samples, std::span<const std::uint32_t> changed) {
    samples_ = samples;
    if (changed.empty())
        return;
    // What movers did to these pairs is taken back before the pairs change.
    std::vector<PairChange> changes;
    bool all_dynamic = true;
    for (const std::uint32_t sample : changed) {
        affected_[sample] = 1;
        all_dynamic = all_dynamic && samples[sample].dynamic;
        for (auto& [bits, mover] : movers_) {
            apply(sample, mover.footprint[sample], {}, changes);
            mover.footprint[sample].clear();
        }
    }
    for (const PairChange& change : changes)
        record(change.node, change.sample, change.before, change.after);
    if (all_dynamic) {
        for (const std::uint32_t sample : changed) {
            clusters_[cluster_of_[sample]].bounds = {};
            clusters_[cluster_of_[sample]].bounds.add(samples_[sample].position);
        }
    } else {
        make_clusters();
    }
    std::vector<std::vector<PairState>> states(changed.size());
    parallel_for_chunks(changed.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            states[i] = decide_all_static(changed[i]);
    });
    for (std::size_t i = 0; i < changed.size(); ++i)
        for (std::uint32_t node = 0; node < states[i].size(); ++node) {
            const PairState before = state(node, changed[i]);
            static_states_[at(node, changed[i])] = std::uint8_t(states[i][node]);
            record(node, changed[i], before, state(node, changed[i]));
        }
    FootprintWalk walk;
    for (auto& [bits, mover] : movers_)
        for (const std::uint32_t& sample : changed) {
            set_mover_pair(mover.slot, sample, decide_mover(mover.blocker, samples_[sample]));
            walk.cluster = &clusters_[cluster_of_[sample]];
            walk.samples = {&sample, 1};
            find_footprints(walk, mover);
            changes.clear();
            apply(sample, {}, walk.footprints[0], changes);
            mover.footprint[sample] = walk.footprints[0];
            for (const PairChange& change : changes)
                record(change.node, change.sample, change.before, change.after);
        }
    counters_.tests += walk.tests;
}

void VisibilityDatabase::recount() {
    const std::uint64_t tests = counters_.tests;
    counters_ = {};
    counters_.tests = tests;
    for (std::uint32_t node = 0; node < node_count(); ++node)
        for (std::uint32_t sample = 0; sample < samples_.size(); ++sample) {
            const PairState now = state(node, sample);
            write_pair(node, sample, now);
            write_flags(node, sample);
            if (counts(node))
                ++count_of(now);
        }
    std::fill(dirty_.begin(), dirty_.end(), std::uint8_t(1));
}

std::uint64_t VisibilityDatabase::memory_bytes() const {
    std::uint64_t bytes = static_states_.size() * 5 + rows_.size() * 4 +
                          patches_.nodes().size() * sizeof(SurfacePatch) + changes_.capacity() * sizeof(PairChange);
    for (const auto& [bits, mover] : movers_)
        for (const Footprint& list : mover.footprint)
            bytes += sizeof list + list.capacity() * 4;
    return bytes;
}

} // namespace sunfleck::gi
