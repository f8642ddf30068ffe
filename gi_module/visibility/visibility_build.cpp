// The static half of the database: patches, their subdivision, and what static geometry does to each pair.
#include "engine/core/divide_up.h"
#include "gi_module/visibility/build_progress.h"
#include "gi_module/visibility/visibility_database.h"

#include "engine/core/jobs.h"
#include "engine/core/memory_limit.h"
#include "engine/core/progress_part.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

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

// Of polygons, their tree, and what is known of faces while they are found: 290 bytes were measured where each triangle
// is a face of its own (MemoryBounds.VisibilityOfManyTriangles).
Status check_size_of_blockers(ecs::Registry& registry, const scene::MeshStore& meshes) {
    constexpr std::uint64_t bytes_per_triangle = 300;
    std::uint64_t triangles = 0;
    registry.view<scene::MeshInstance>().each([&](ecs::Entity entity, const scene::MeshInstance& instance) {
        if (instance.mesh < meshes.size() && scene::is_static(registry, entity))
            triangles += meshes[instance.mesh].triangle_count();
    });
    return check_memory(triangles * bytes_per_triangle, "visibility among " + std::to_string(triangles) + " triangles",
                        "the level's detail");
}

} // namespace

bool VisibilityDatabase::build(ecs::Registry& registry, const scene::MeshStore& meshes,
                               std::span<const LightSample> samples, const VisibilityOptions& options,
                               const std::function<bool(float)>& progress) {
    constexpr float until_patches = 0.1f; // of the work
    options_ = options;
    samples_ = samples;
    static_blockers_ = {};
    Status status = check_size_of_blockers(registry, meshes);
    bool stopped = status && !patches_.build(registry, meshes, options.patches, static_blockers_,
                                             progress_part(progress, 0.0f, until_patches));
    movers_.clear();
    mover_slots_.clear();
    unlit_slots_.clear();
    changes_.clear();
    affected_.assign(samples_.size(), 0);
    static_states_.clear();
    if (status && !stopped) {
        make_groups();
        choose_exact_roots();
        constexpr std::uint64_t state = 1, counts = 4; // bytes
        status = check_size(state + counts);
        stopped = status && !split_and_decide(progress_part(progress, until_patches, 1.0f));
        if (status && !stopped)
            status = check_size(counts); // of what was split, too
    }
    if (stopped)
        status = Error{"preparing the lighting was stopped", ErrorCode::stopped};
    if (!status) {
        const std::uint64_t generation = generation_;
        *this = {};
        generation_ = generation + 1;
        problem_ = status.error();
        return false;
    }
    patches_.finish();
    make_outlines();
    full_counts_.assign(static_states_.size(), 0);
    partial_counts_.assign(static_states_.size(), 0);
    make_clusters();
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

// Level by level: decide all pairs of the level's nodes, then split those with enough partial pairs.
bool VisibilityDatabase::split_and_decide(const std::function<bool(float)>& progress) {
    const bool coarse_roots = !is_exact_.empty() && !groups_.empty();
    BuildProgress reporter(progress, options_.patches.levels + 1 + (coarse_roots ? 1 : 0));
    std::uint32_t first = 0;
    while (first < patches_.nodes().size()) {
        const std::uint32_t end = std::uint32_t(patches_.nodes().size());
        static_states_.resize(at(end, 0));
        if (first == 0 && coarse_roots)
            decide_coarse_roots(reporter);
        reporter.begin_level(end - first);
        parallel_for_chunks(end - first, 4, [&](std::size_t begin, std::size_t stop) {
            if (reporter.stopped())
                return;
            for (std::uint32_t node = first + std::uint32_t(begin); node < first + stop; ++node) {
                LikelyBlockers likely;
                for (std::uint32_t sample = 0; sample < samples_.size() && is_exact(node); ++sample)
                    static_states_[at(node, sample)] = std::uint8_t(decide_static(node, sample, &likely));
            }
            reporter.add(stop - begin);
        });
        if (reporter.stopped())
            return false;
        reporter.end_level();
        for (std::uint32_t node = first; node < end; ++node) {
            if (!patches_.can_split(node) || !is_exact(node) || !may_split_more())
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

PairState VisibilityDatabase::decide_static(std::uint32_t node, std::uint32_t sample, LikelyBlockers* likely) const {
    if (samples_[sample].dynamic)
        return PairState::partial; // until all nodes are known: see decide_all_static
    const SurfacePatch& patch = patches_.nodes()[node];
    PairState parent = PairState::partial;
    if (patch.parent != shared::no_node)
        parent = PairState(static_states_[at(patch.parent, sample)]);
    if (parent == PairState::full || parent == PairState::unlit)
        return parent;
    if (!patch.planar)
        return decide_box(patch, samples_[sample], likely);
    const auto pyramid = pyramid_of_patch(samples_[sample], patch.corners, patch.normal);
    if (!pyramid)
        return PairState::unlit;
    return parent == PairState::none ? PairState::none
                                     : state_of(static_blockers_.test(*pyramid, StaticBlockers::no_body, likely));
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
    if ((light.dynamic || !is_exact_.empty()) && !groups_.empty())
        decide_group(0, light, result);
    for (std::uint32_t node = 0; node < result.size(); ++node) {
        const SurfacePatch& patch = patches_.nodes()[node];
        if (patch.parent == shared::no_node) {
            if (!light.dynamic && is_exact(node))
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

PairState VisibilityDatabase::decide_box(const SurfacePatch& patch, const LightSample& sample,
                                         LikelyBlockers* likely) const {
    const auto pyramid = pyramid_of_box(sample, patch.box);
    return pyramid ? state_of(static_blockers_.test(*pyramid, patch.body, likely)) : PairState::unlit;
}

// Movers shadow themselves, so all that static geometry can add is to hide them: if their middle is in sight, it does
// not.
PairState VisibilityDatabase::decide_mover(const MovingBlocker& mover, const LightSample& sample) const {
    const auto gate = gate_of_box(sample, mover.box());
    if (!gate)
        return PairState::unlit;
    const dvec3 middle = mover.box().centre;
    const bool parallel = sample.kind == SampleKind::directional;
    const dvec3 to_light = parallel ? -1e4 * dvec3(sample.normal) : dvec3(sample.position) - middle;
    if (!static_blockers_.crosses_segment(middle, to_light))
        return PairState::partial;
    return static_blockers_.covers(*gate) ? PairState::full : PairState::partial;
}

void VisibilityDatabase::change_samples(std::span<const LightSample> samples, std::span<const std::uint32_t> changed,
                                        std::span<const MoverPlace> placed_next) {
    samples_ = samples;
    if (changed.empty())
        return;
    bool all_dynamic = true;
    for (const std::uint32_t sample : changed) {
        affected_[sample] = 1;
        all_dynamic = all_dynamic && samples[sample].dynamic;
    }
    if (all_dynamic) {
        for (const std::uint32_t sample : changed) {
            clusters_[cluster_of_[sample]].bounds = {};
            clusters_[cluster_of_[sample]].bounds.add(samples_[sample].position);
        }
    } else {
        make_clusters();
    }
    change_static_states(changed);
    for (const MoverPlace& place : placed_next)
        if (const auto found = movers_.find(place.entity.bits()); found != movers_.end())
            found->second.outdated = true;
    std::vector<Mover*> movers;
    movers.reserve(movers_.size());
    for (auto& [bits, mover] : movers_)
        if (!mover.outdated)
            movers.push_back(&mover);
    std::vector<ClusterPart> parts;
    parts.reserve(changed.size());
    for (const std::uint32_t& sample : changed)
        parts.push_back({&clusters_[cluster_of_[sample]], {&sample, 1}});
    set_mover_pairs(movers, changed);
    replace_footprints(movers, parts);
}

// What static geometry does to samples that changed: mostly what it did before.
void VisibilityDatabase::change_static_states(std::span<const std::uint32_t> changed) {
    struct NodeState {
        std::uint32_t node;
        PairState state;
    };
    std::vector<std::vector<NodeState>> changes(changed.size());
    parallel_for_chunks(changed.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::vector<PairState> states = decide_all_static(changed[i]);
            for (std::uint32_t node = 0; node < states.size(); ++node)
                if (states[node] != static_state(node, changed[i]))
                    changes[i].push_back({node, states[node]});
        }
    });
    for (std::size_t i = 0; i < changed.size(); ++i)
        for (const NodeState& change : changes[i]) {
            const PairState before = state(change.node, changed[i]);
            static_states_[at(change.node, changed[i])] = std::uint8_t(change.state);
            record(change.node, changed[i], before, state(change.node, changed[i]));
        }
}

// Each node has words of its own in the rows.
void VisibilityDatabase::recount() {
    constexpr std::size_t nodes_at_once = 256;
    std::vector<VisibilityCounters> parts(divide_up(node_count(), nodes_at_once));
    parallel_for_chunks(node_count(), nodes_at_once, [&](std::size_t begin, std::size_t end) {
        VisibilityCounters& part = parts[begin / nodes_at_once];
        for (std::uint32_t node = std::uint32_t(begin); node < end; ++node)
            for (std::uint32_t sample = 0; sample < samples_.size(); ++sample) {
                const PairState now = state(node, sample);
                write_pair(node, sample, now);
                write_flags(node, sample);
                if (counts(node))
                    ++part.of(now);
            }
    });
    const std::uint64_t tests = counters_.tests;
    counters_ = {};
    counters_.tests = tests;
    for (VisibilityCounters& part : parts)
        for (const PairState state : {PairState::full, PairState::partial, PairState::none, PairState::unlit})
            counters_.of(state) += part.of(state);
    std::fill(dirty_.begin(), dirty_.end(), std::uint8_t(1));
}

std::uint64_t VisibilityDatabase::memory_bytes() const {
    std::uint64_t bytes = static_states_.size() * 5 + rows_.size() * 4 +
                          patches_.nodes().size() * (sizeof(SurfacePatch) + sizeof(Outline)) +
                          changes_.capacity() * sizeof(PairChange);
    for (const auto& [bits, mover] : movers_)
        for (const Footprint& list : mover.footprint)
            bytes += sizeof list + list.capacity() * 4;
    return bytes;
}

} // namespace sunfleck::gi
