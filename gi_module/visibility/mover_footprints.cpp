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

double radius_of(const Bounds& bounds) {
    return 0.5 * double(glm::length(bounds.extent()));
}

// Whether a sphere may meet the hull of two boxes: the hull lies in a capsule around both. Its slack is wider than
// may_shadow's, so that groups never leave out a pair that would be accepted by itself.
bool may_meet_hull(const Bounds& a, const Bounds& b, const Bounds& sphere_of) {
    if (!overlap(joined(a, b), sphere_of))
        return false;
    const dvec3 start(a.centre()), along = dvec3(b.centre()) - start, point(sphere_of.centre());
    const double square = glm::dot(along, along);
    const double t = square > 0.0 ? std::clamp(glm::dot(point - start, along) / square, 0.0, 1.0) : 0.0;
    const double reach = radius_of(sphere_of) + std::max(radius_of(a), radius_of(b));
    return glm::length(start + t * along - point) <= reach * 1.002 + 1e-3;
}

// Whether a mover is all behind the patch, where it shadows it from no sample.
bool behind(const SurfacePatch& patch, const Bounds& mover) {
    const float radius = 0.5f * glm::length(mover.extent()) * 1.0001f + 1e-5f;
    return patch.planar && glm::dot(vec3(patch.normal), mover.centre() - vec3(patch.corners[0])) < -radius;
}

// Whether anything in the sphere around `mover` may stand between the light and the patch: cheap, and errs on the side
// of yes.
bool may_shadow(const LightSample& light, const SurfacePatch& patch, const Bounds& mover) {
    if (behind(patch, mover))
        return false;
    if (light.kind == SampleKind::directional)
        return true;
    Bounds hull = patch.bounds;
    hull.add(light.position);
    if (!overlap(hull, mover))
        return false;
    const vec3 middle = mover.centre();
    const float radius = 0.5f * glm::length(mover.extent()) * 1.0001f + 1e-5f;
    const vec3 to_middle = middle - light.position;
    if (light.kind == SampleKind::surface && glm::dot(light.normal, to_middle) < -radius)
        return false;
    const float patch_radius = 0.5f * glm::length(patch.bounds.extent()) * 1.0001f + 1e-5f;
    const float gap = shared::shadow_cone_distance(light.position, patch.bounds.centre(), patch_radius, middle);
    return gap <= radius + 1e-4f;
}

// What the mover takes of the sample's light to a patch.
Blocking shadow_on(const SurfacePatch& patch, const LightSample& light, const MovingBlocker& blocker) {
    if (!may_shadow(light, patch, blocker.bounds()))
        return Blocking::none;
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

} // namespace

void VisibilityDatabase::candidate_roots(const Cluster& cluster, const Bounds& mover, std::uint32_t group,
                                         Footprint& roots, std::uint64_t& tests) const {
    const Group& node = groups_[group];
    ++tests;
    if (!cluster.unbounded && !may_meet_hull(cluster.bounds, node.bounds, mover))
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
        candidate_roots(cluster, mover.blocker.bounds(), 0, roots, tests);
    else
        for (std::uint32_t root = 0; root < patches_.roots(); ++root)
            roots.push_back(root);
    return roots;
}

// Top-down: what is settled for a node is settled for its children. Bit i of `active` stands for the walk's sample i:
// tested are the active ones, and what is found holds for those that count, whose parents are shadowed in part.
void VisibilityDatabase::descend(FootprintWalk& walk, std::uint32_t node, std::uint32_t active,
                                 std::uint32_t counting) const {
    const SurfacePatch& patch = patches_.nodes()[node];
    const MovingBlocker& blocker = *walk.blocker;
    const Cluster& cluster = *walk.cluster;
    const bool clusters = options_.tests == TestGrouping::clusters;
    if (clusters) {
        ++walk.tests;
        const bool several = (active & (active - 1)) != 0;
        if (behind(patch, blocker.bounds()) ||
            (several && !cluster.unbounded && !may_meet_hull(cluster.bounds, patch.bounds, blocker.bounds())))
            return;
    }
    std::uint32_t below = 0;
    for (std::uint32_t rest = active; rest != 0; rest &= rest - 1) {
        const std::uint32_t i = std::uint32_t(std::countr_zero(rest));
        const std::uint32_t sample = walk.samples[i];
        const PairState fixed = static_state(node, sample);
        if (fixed == PairState::unlit || fixed == PairState::full)
            continue;
        ++walk.tests;
        const Blocking blocking = shadow_on(patch, samples_[sample], blocker);
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
    if (next == 0 || patch.is_leaf())
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
    std::uint32_t active = 0;
    for (std::size_t i = 0; i < walk.samples.size(); ++i) {
        walk.footprints[i].clear();
        if (mover.blocks && reaches(mover, walk.samples[i]))
            active |= 1u << i;
    }
    if (active == 0)
        return;
    walk.blocker = &mover.blocker;
    for (const std::uint32_t root : roots_for(*walk.cluster, mover, walk.tests))
        descend(walk, root, active, active);
    for (std::size_t i = 0; i < walk.samples.size(); ++i)
        std::sort(walk.footprints[i].begin(), walk.footprints[i].end());
}

// Whether light of the sample comes to the mover at all. Where static geometry takes all of it, what lies behind the
// mover is dark without it.
bool VisibilityDatabase::reaches(const Mover& mover, std::uint32_t sample) const {
    const PairState fixed = static_state(std::uint32_t(patches_.nodes().size()) + mover.slot, sample);
    return fixed != PairState::full && fixed != PairState::unlit;
}

void VisibilityDatabase::replace_footprints(Mover& mover) {
    std::vector<std::vector<PairChange>> changes(clusters_.size());
    std::atomic<std::uint64_t> all_tests{0};
    parallel_for_chunks(clusters_.size(), 1, [&](std::size_t begin, std::size_t end) {
        FootprintWalk walk;
        for (std::size_t c = begin; c < end; ++c) {
            walk.cluster = &clusters_[c];
            walk.samples = clusters_[c].samples;
            find_footprints(walk, mover);
            for (std::size_t i = 0; i < walk.samples.size(); ++i) {
                Footprint& known = mover.footprint[walk.samples[i]];
                if (walk.footprints[i] == known)
                    continue;
                apply(walk.samples[i], known, walk.footprints[i], changes[c]);
                known = walk.footprints[i];
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
