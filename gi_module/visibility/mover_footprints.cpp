// Footprints of movers in the database: which nodes a mover shadows from each sample. Found for clusters of samples at
// once, from the roots of the patches' trees downwards: what has nothing to do with a whole cluster is not looked at
// sample by sample.
#include "engine/core/jobs.h"
#include "gi_module/visibility/shadow_cone_shared.h"
#include "gi_module/visibility/visibility_database.h"

#include <algorithm>
#include <atomic>
#include <bit>

namespace sunfleck::gi {
namespace {

Bounds joined(Bounds a, const Bounds& b) {
    a.add(b);
    return a;
}

bool overlap(const Bounds& a, const Bounds& b) {
    return glm::all(glm::lessThanEqual(a.minimum, b.maximum)) && glm::all(glm::lessThanEqual(b.minimum, a.maximum));
}

} // namespace

// Whether a mover may meet the hull of a cluster and a box, given with the radius of the ball around it: the hull lies
// in a capsule around both. Its slack is wider than may_shadow's, so that groups never leave out a pair that would be
// accepted by itself.
bool VisibilityDatabase::may_meet_hull(const Cluster& cluster, const Bounds& bounds, float radius,
                                       const MovingBlocker& mover) {
    if (!overlap(joined(cluster.bounds, bounds), mover.bounds()))
        return false;
    const dvec3 start(cluster.bounds.centre()), along = dvec3(bounds.centre()) - start, point(mover.bounds().centre());
    const double square = glm::dot(along, along);
    const double t = square > 0.0 ? std::clamp(glm::dot(point - start, along) / square, 0.0, 1.0) : 0.0;
    const double reach = double(mover.radius()) + double(std::max(cluster.radius, radius));
    const double limit = reach * 1.002 + 1e-3;
    const dvec3 apart = start + t * along - point;
    return glm::dot(apart, apart) <= limit * limit;
}

// Whether a mover is all behind the patch, where it shadows it from no sample.
bool VisibilityDatabase::behind(const Outline& patch, const MovingBlocker& mover) {
    const float radius = mover.radius() * 1.0001f + 1e-5f;
    return patch.planar && glm::dot(patch.normal, mover.bounds().centre() - patch.corner) < -radius;
}

// Whether anything in the ball around `mover` may stand between the light and the patch: cheap, and errs on the side
// of yes.
bool VisibilityDatabase::may_shadow(const LightSample& light, const Outline& patch, const MovingBlocker& mover) {
    if (behind(patch, mover))
        return false;
    if (light.kind == SampleKind::directional)
        return true;
    Bounds hull = patch.bounds;
    hull.add(light.position);
    if (!overlap(hull, mover.bounds()))
        return false;
    const vec3 middle = mover.bounds().centre();
    const float radius = mover.radius() * 1.0001f + 1e-5f;
    const vec3 to_middle = middle - light.position;
    if (light.kind == SampleKind::surface && glm::dot(light.normal, to_middle) < -radius)
        return false;
    const float patch_radius = patch.radius * 1.0001f + 1e-5f;
    const float gap = shared::shadow_cone_distance(light.position, patch.bounds.centre(), patch_radius, middle);
    return gap <= radius + 1e-4f;
}

// What the mover takes of the sample's light to a patch.
Blocking VisibilityDatabase::shadow_on(std::uint32_t node, const LightSample& light,
                                       const MovingBlocker& blocker) const {
    if (!may_shadow(light, outlines_[node], blocker))
        return Blocking::none;
    const SurfacePatch& patch = patches_.nodes()[node];
    if (!patch.planar) {
        const auto pyramid = pyramid_of_box(light, patch.box);
        return pyramid ? blocker.test(*pyramid) : Blocking::none;
    }
    if (!may_enter_patch(light, patch.corners, patch.normal, blocker.box()))
        return Blocking::none;
    if (blocker.complex() || (blocker.is_box() && !blocker.may_cover(light, patch.corners)))
        return Blocking::partial;
    const auto pyramid = pyramid_of_patch(light, patch.corners, patch.normal);
    return pyramid ? blocker.test(*pyramid) : Blocking::none;
}

void VisibilityDatabase::candidate_roots(const Cluster& cluster, const MovingBlocker& mover, std::uint32_t group,
                                         Footprint& roots, std::uint64_t& tests) const {
    const Group& node = groups_[group];
    ++tests;
    if (!cluster.unbounded && !may_meet_hull(cluster, node.bounds, node.radius, mover))
        return;
    if (node.roots.empty()) {
        candidate_roots(cluster, mover, node.left, roots, tests);
        candidate_roots(cluster, mover, node.right, roots, tests);
    }
    roots.insert(roots.end(), node.roots.begin(), node.roots.end());
}

VisibilityDatabase::Footprint VisibilityDatabase::roots_for(const Cluster& cluster, const Mover& mover,
                                                            std::uint64_t& tests) const {
    Footprint roots;
    if (options_.tests == TestGrouping::clusters && !groups_.empty())
        candidate_roots(cluster, mover.blocker, 0, roots, tests);
    else
        for (std::uint32_t root = 0; root < patches_.roots(); ++root)
            roots.push_back(root);
    return roots;
}

// Top-down: what is settled for a node is settled for its children. Bit i of `active` stands for the walk's sample i:
// tested are the active ones, and what is found holds for those that count, whose parents are shadowed in part.
void VisibilityDatabase::descend(FootprintWalk& walk, std::uint32_t node, std::uint32_t active,
                                 std::uint32_t counting) const {
    const Outline& patch = outlines_[node];
    const MovingBlocker& blocker = *walk.blocker;
    const Cluster& cluster = *walk.part.cluster;
    const bool clusters = options_.tests == TestGrouping::clusters;
    if (clusters) {
        ++walk.tests;
        const bool several = (active & (active - 1)) != 0;
        if (behind(patch, blocker) ||
            (several && !cluster.unbounded && !may_meet_hull(cluster, patch.bounds, patch.radius, blocker)))
            return;
    }
    std::uint32_t below = 0;
    for (std::uint32_t rest = active; rest != 0; rest &= rest - 1) {
        const std::uint32_t i = std::uint32_t(std::countr_zero(rest));
        const std::uint32_t sample = walk.part.samples[i];
        const PairState fixed = static_state(node, sample);
        if (fixed == PairState::unlit || fixed == PairState::full)
            continue;
        ++walk.tests;
        const Blocking blocking = shadow_on(node, samples_[sample], blocker);
        if ((counting & (1u << i)) == 0)
            continue;
        if (blocking == Blocking::full)
            add_all(node, sample, walk.footprints[i]);
        if (blocking != Blocking::partial)
            continue;
        walk.footprints[i].push_back(node * 2);
        below |= 1u << i;
    }
    const std::uint32_t next = options_.tests == TestGrouping::pairs ? active : below;
    if (next == 0 || patch.first_child == shared::no_node)
        return;
    for (std::uint32_t child = 0; child < 4; ++child)
        descend(walk, patch.first_child + child, next, below);
}

void VisibilityDatabase::add_all(std::uint32_t node, std::uint32_t sample, Footprint& out) const {
    const PairState fixed = static_state(node, sample);
    if (fixed == PairState::unlit || fixed == PairState::full)
        return;
    out.push_back(node * 2 + 1);
    const SurfacePatch& patch = patches_.nodes()[node];
    if (!patch.is_leaf())
        for (std::uint32_t child = 0; child < 4; ++child)
            add_all(patch.first_child + child, sample, out);
}

// Of samples of one cluster, at most as many as it may have; those that do not reach the mover have none.
void VisibilityDatabase::find_footprints(FootprintWalk& walk, const Mover& mover) const {
    const std::span<const std::uint32_t> samples = walk.part.samples;
    std::uint32_t active = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        walk.footprints[i].clear();
        const LightSample& sample = samples_[samples[i]];
        const bool own = sample.on_mover && sample.emitter == mover.entity;
        if (mover.blocks && !own && reaches(mover, samples[i]))
            active |= 1u << i;
    }
    if (active == 0)
        return;
    walk.blocker = &mover.blocker;
    for (const std::uint32_t root : roots_for(*walk.part.cluster, mover, walk.tests))
        descend(walk, root, active, active);
    for (std::size_t i = 0; i < samples.size(); ++i)
        std::sort(walk.footprints[i].begin(), walk.footprints[i].end());
}

// Whether light of the sample comes to the mover at all. Where static geometry takes all of it, what lies behind the
// mover is dark without it.
bool VisibilityDatabase::reaches(const Mover& mover, std::uint32_t sample) const {
    const PairState fixed = static_state(std::uint32_t(patches_.nodes().size()) + mover.slot, sample);
    return fixed != PairState::full && fixed != PairState::unlit;
}

std::vector<VisibilityDatabase::ClusterPart> VisibilityDatabase::all_clusters() const {
    std::vector<ClusterPart> parts;
    parts.reserve(clusters_.size());
    for (const Cluster& cluster : clusters_)
        parts.push_back({&cluster, cluster.samples});
    return parts;
}

// No sample is in two of the parts, so each thread has pairs of its own.
void VisibilityDatabase::replace_footprints(std::span<Mover* const> movers, std::span<const ClusterPart> parts) {
    std::vector<std::vector<PairChange>> changes(parts.size());
    std::atomic<std::uint64_t> all_tests{0};
    parallel_for_chunks(movers.empty() ? 0 : parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        FootprintWalk walk;
        for (std::size_t p = begin; p < end; ++p)
            for (Mover* const mover : movers) {
                walk.part = parts[p];
                find_footprints(walk, *mover);
                for (std::size_t i = 0; i < walk.part.samples.size(); ++i) {
                    Footprint& known = mover->footprint[walk.part.samples[i]];
                    if (walk.footprints[i] == known)
                        continue;
                    apply(walk.part.samples[i], known, walk.footprints[i], changes[p]);
                    // As long as it is, not as the longest that it ever was: memory is of the scene, not of its past.
                    known = Footprint(walk.footprints[i]);
                }
            }
        all_tests += walk.tests;
    });
    counters_.tests += all_tests;
    for (const auto& list : changes)
        for (const PairChange& change : list)
            record(change.node, change.sample, change.before, change.after);
}

// Both lists are sorted. An entry that is in one only, or with another degree, changes its pair.
void VisibilityDatabase::apply(std::uint32_t sample, const Footprint& before, const Footprint& after,
                               std::vector<PairChange>& changes) {
    const auto count = [&](std::uint32_t entry, int by) {
        auto& counts = entry & 1u ? full_counts_ : partial_counts_;
        counts[at(entry / 2, sample)] = std::uint16_t(counts[at(entry / 2, sample)] + by);
    };
    std::size_t i = 0, k = 0;
    while (i < before.size() || k < after.size()) {
        const std::uint32_t old_node = i < before.size() ? before[i] / 2 : shared::no_node;
        const std::uint32_t new_node = k < after.size() ? after[k] / 2 : shared::no_node;
        const std::uint32_t node = std::min(old_node, new_node);
        if (old_node == new_node && before[i] == after[k]) {
            ++i;
            ++k;
            continue;
        }
        const PairState was = state(node, sample);
        if (old_node == node)
            count(before[i++], -1);
        if (new_node == node)
            count(after[k++], 1);
        // Also where the state stays: whether any mover is in the way is part of a row.
        changes.push_back({node, sample, was, state(node, sample)});
    }
}

} // namespace sunfleck::gi
