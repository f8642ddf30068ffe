// The moving half of the database: footprints of movers, and what their differences do to pairs.
#include "gi_module/visibility/visibility_database.h"

#include "engine/core/jobs.h"
#include "gi_module/visibility/shadow_cone_shared.h"

#include <algorithm>
#include <atomic>

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
    const dvec3 start(a.centre()), along = dvec3(b.centre()) - start, point(sphere_of.centre());
    const double square = glm::dot(along, along);
    const double t = square > 0.0 ? std::clamp(glm::dot(point - start, along) / square, 0.0, 1.0) : 0.0;
    const double reach = radius_of(sphere_of) + std::max(radius_of(a), radius_of(b));
    return glm::length(start + t * along - point) <= reach * 1.002 + 1e-3;
}

// Whether anything in the sphere around `mover` may stand between the light and the patch: cheap, and errs on the side
// of yes.
bool may_shadow(const LightSample& light, const SurfacePatch& patch, const Bounds& mover) {
    const vec3 middle = mover.centre();
    const float radius = 0.5f * glm::length(mover.extent()) * 1.0001f + 1e-5f;
    if (patch.planar && glm::dot(vec3(patch.normal), middle - vec3(patch.corners[0])) < -radius)
        return false;
    if (light.kind == SampleKind::directional)
        return true;
    Bounds hull = patch.bounds;
    hull.add(light.position);
    if (!overlap(hull, mover))
        return false;
    const vec3 to_middle = middle - light.position;
    if (light.kind == SampleKind::surface && glm::dot(light.normal, to_middle) < -radius)
        return false;
    const float patch_radius = 0.5f * glm::length(patch.bounds.extent()) * 1.0001f + 1e-5f;
    const float gap = shared::shadow_cone_distance(light.position, patch.bounds.centre(), patch_radius, middle);
    return gap <= radius + 1e-4f;
}

} // namespace

PairState VisibilityDatabase::state(std::uint32_t node, std::uint32_t sample) const {
    const PairState fixed = static_state(node, sample);
    if (fixed == PairState::unlit || fixed == PairState::full)
        return fixed;
    if (node >= patches_.nodes().size() && unlit_slots_[node - patches_.nodes().size()])
        return PairState::unlit;
    if (full_counts_[at(node, sample)] > 0)
        return PairState::full;
    const bool mover = node >= patches_.nodes().size();
    return fixed == PairState::partial || partial_counts_[at(node, sample)] > 0 || mover ? PairState::partial
                                                                                         : PairState::none;
}

std::vector<VisibilityDatabase::Blocker> VisibilityDatabase::blockers(std::uint32_t node, std::uint32_t sample) const {
    std::vector<Blocker> result;
    const PairState fixed = static_state(node, sample);
    if (fixed == PairState::unlit)
        return result;
    if (fixed != PairState::none)
        result.push_back({ecs::null_entity, fixed == PairState::full});
    for (const auto& [bits, mover] : movers_) {
        const Footprint& list = mover.footprint[sample];
        const auto found = std::lower_bound(list.begin(), list.end(), node * 2);
        if (found != list.end() && *found / 2 == node)
            result.push_back({mover.entity, (*found & 1u) != 0});
    }
    return result;
}

std::vector<std::uint8_t> VisibilityDatabase::hidden_entities(std::uint32_t sample) const {
    std::vector<std::uint8_t> hidden, known;
    const auto note = [&](ecs::Entity entity, std::uint32_t node) {
        if (entity.index >= hidden.size())
            hidden.resize(entity.index + 1, 1);
        if (entity.index >= known.size())
            known.resize(entity.index + 1, 0);
        known[entity.index] = 1;
        // A face that looks away may still be what stands in the light's way.
        hidden[entity.index] &= static_state(node, sample) == PairState::full;
    };
    for (std::uint32_t root = 0; root < patches_.roots(); ++root)
        note(patches_.nodes()[root].entity, root);
    for (const auto& [bits, mover] : movers_)
        note(mover.entity, mover_node(mover.entity));
    for (std::size_t i = 0; i < hidden.size(); ++i)
        hidden[i] &= known[i];
    return hidden;
}

std::uint32_t VisibilityDatabase::mover_node(ecs::Entity entity) const {
    const auto found = movers_.find(entity.bits());
    return found == movers_.end() ? shared::no_node : std::uint32_t(patches_.nodes().size()) + found->second.slot;
}

void VisibilityDatabase::candidate_roots(const Cluster& cluster, const Bounds& mover, std::uint32_t group,
                                         Footprint& roots, std::uint64_t& tests) const {
    const Group& node = groups_[group];
    ++tests;
    if (!cluster.unbounded &&
        (!overlap(joined(cluster.bounds, node.bounds), mover) || !may_meet_hull(cluster.bounds, node.bounds, mover)))
        return;
    if (node.roots.empty()) {
        candidate_roots(cluster, mover, node.left, roots, tests);
        candidate_roots(cluster, mover, node.right, roots, tests);
    }
    for (const std::uint32_t root : node.roots)
        if (cluster.unbounded || overlap(joined(cluster.bounds, patches_.nodes()[root].bounds), mover))
            roots.push_back(root);
}

// Top-down: what is settled for a node is settled for its children.
void VisibilityDatabase::descend(std::uint32_t node, std::uint32_t sample, const MovingBlocker& blocker, Footprint& out,
                                 std::uint64_t& tests) const {
    const PairState fixed = static_state(node, sample);
    if (fixed == PairState::unlit || fixed == PairState::full)
        return;
    const SurfacePatch& patch = patches_.nodes()[node];
    const LightSample& light = samples_[sample];
    ++tests;
    if (!may_shadow(light, patch, blocker.bounds()))
        return;
    Blocking blocking = Blocking::none;
    if (!patch.planar || may_enter_patch(light, patch.corners, patch.normal, blocker.box())) {
        blocking = Blocking::partial;
        const bool settled =
            patch.planar && (blocker.complex() || (blocker.is_box() && !blocker.may_cover(light, patch.corners)));
        if (!settled) {
            const auto pyramid =
                patch.planar ? pyramid_of_patch(light, patch.corners, patch.normal) : pyramid_of_box(light, patch.box);
            if (!pyramid)
                return;
            blocking = blocker.test(*pyramid);
        }
    }
    if (blocking == Blocking::none)
        return;
    if (blocking == Blocking::full) {
        add_all(node, sample, out);
        return;
    }
    out.push_back(node * 2);
    if (!patch.is_leaf())
        for (std::uint32_t child = 0; child < 4; ++child)
            descend(patch.first_child + child, sample, blocker, out, tests);
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

VisibilityDatabase::Footprint VisibilityDatabase::roots_for(const Cluster& cluster, const Mover& mover,
                                                            std::uint64_t& tests) const {
    Footprint roots;
    if (options_.clustered && !groups_.empty())
        candidate_roots(cluster, mover.blocker.bounds(), 0, roots, tests);
    else
        for (std::uint32_t root = 0; root < patches_.roots(); ++root)
            roots.push_back(root);
    return roots;
}

void VisibilityDatabase::find_footprint(const Mover& mover, std::uint32_t sample, const Footprint& roots,
                                        Footprint& out, std::uint64_t& tests) const {
    out.clear();
    for (const std::uint32_t root : roots)
        descend(root, sample, mover.blocker, out, tests);
    std::sort(out.begin(), out.end());
}

// Whether light of the sample comes to the mover at all. Where static geometry takes all of it, what lies behind the
// mover is dark without it.
bool VisibilityDatabase::reaches(const Mover& mover, std::uint32_t sample) const {
    const PairState fixed = static_state(std::uint32_t(patches_.nodes().size()) + mover.slot, sample);
    return fixed != PairState::full && fixed != PairState::unlit;
}

void VisibilityDatabase::replace_footprints(Mover& mover, bool present) {
    std::vector<std::vector<PairChange>> changes(clusters_.size());
    std::atomic<std::uint64_t> all_tests{0};
    const auto work = [&](std::size_t begin, std::size_t end) {
        std::uint64_t tests = 0;
        Footprint fresh;
        for (std::size_t c = begin; c < end; ++c) {
            const Cluster& cluster = clusters_[c];
            const bool seen = present && std::any_of(cluster.samples.begin(), cluster.samples.end(),
                                                     [&](std::uint32_t sample) { return reaches(mover, sample); });
            const Footprint roots = seen ? roots_for(cluster, mover, tests) : Footprint();
            for (const std::uint32_t sample : cluster.samples) {
                if (reaches(mover, sample))
                    find_footprint(mover, sample, roots, fresh, tests);
                else
                    fresh.clear();
                if (fresh == mover.footprint[sample])
                    continue;
                apply(sample, mover.footprint[sample], fresh, changes[c]);
                mover.footprint[sample] = fresh;
            }
        }
        all_tests += tests;
    };
    if (present)
        parallel_for_chunks(clusters_.size(), 1, work);
    else
        work(0, clusters_.size());
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

void VisibilityDatabase::begin_frame() {
    changes_.clear();
    std::fill(affected_.begin(), affected_.end(), std::uint8_t(0));
    counters_.tests = 0;
}

void VisibilityDatabase::update_movers(std::span<const MoverPlace> movers, const scene::MeshStore& meshes) {
    const auto mark_affected = [&](std::uint32_t node) {
        for (std::uint32_t sample = 0; sample < samples_.size(); ++sample) {
            const PairState fixed = static_state(node, sample);
            affected_[sample] |= fixed == PairState::none || fixed == PairState::partial;
        }
    };
    std::map<EntityBits, const MoverPlace*> present;
    for (const MoverPlace& place : movers)
        if (place.mesh < meshes.size())
            present[place.entity.bits()] = &place;
    for (auto it = movers_.begin(); it != movers_.end();) {
        const auto found = present.find(it->first);
        if (found != present.end() && found->second->mesh == it->second.mesh &&
            found->second->solid == it->second.solid) {
            ++it;
            continue;
        }
        const std::uint32_t slot = it->second.slot;
        if (it->second.blocks)
            mark_affected(mover_node(it->second.entity));
        replace_footprints(it->second, false);
        mover_slots_[slot] = ecs::null_entity;
        set_mover_row(slot);
        it = movers_.erase(it);
    }
    for (const auto& [bits, place] : present) {
        const auto found = movers_.find(bits);
        const bool added = found == movers_.end();
        Mover& mover = movers_[bits];
        if (!added && mover.matrix == place->matrix && mover.blocks == place->blocks &&
            unlit_slots_[mover.slot] == !place->lit && mover.revision == place->revision)
            continue;
        if (added) {
            mover.entity = place->entity;
            mover.mesh = place->mesh;
            mover.solid = place->solid;
            mover.revision = place->revision;
            mover.blocker = MovingBlocker(meshes[place->mesh], place->solid);
            mover.footprint.resize(samples_.size());
            auto free = std::find(mover_slots_.begin(), mover_slots_.end(), ecs::null_entity);
            if (free == mover_slots_.end())
                free = mover_slots_.insert(free, ecs::null_entity);
            *free = place->entity;
            mover.slot = std::uint32_t(free - mover_slots_.begin());
            unlit_slots_.resize(mover_slots_.size(), 0);
            grow_rows();
        } else if (mover.blocks) {
            mark_affected(mover_node(mover.entity));
        }
        if (mover.revision != place->revision)
            mover.blocker = MovingBlocker(meshes[place->mesh], place->solid);
        mover.revision = place->revision;
        mover.blocks = place->blocks;
        unlit_slots_[mover.slot] = !place->lit;
        mover.matrix = place->matrix;
        mover.blocker.place(place->matrix);
        const std::uint32_t node = mover_node(mover.entity);
        set_mover_row(mover.slot);
        if (mover.blocks)
            mark_affected(node);
        replace_footprints(mover, mover.blocks);
    }
}

// Of the mover in a slot against static geometry; of a free slot, everything is unlit.
void VisibilityDatabase::set_mover_row(std::uint32_t slot) {
    const auto mover = movers_.find(mover_slots_[slot].bits());
    std::vector<PairState> fixed(samples_.size(), PairState::unlit);
    if (mover != movers_.end() && !mover_slots_[slot].is_null()) {
        counters_.tests += samples_.size();
        parallel_for_chunks(samples_.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t sample = begin; sample < end; ++sample)
                fixed[sample] = decide_mover(mover->second.blocker, samples_[sample]);
        });
    }
    for (std::uint32_t sample = 0; sample < samples_.size(); ++sample)
        set_mover_pair(slot, sample, fixed[sample]);
}

void VisibilityDatabase::set_mover_pair(std::uint32_t slot, std::uint32_t sample, PairState fixed) {
    const std::uint32_t node = std::uint32_t(patches_.nodes().size()) + slot;
    const std::uint32_t word = rows_[std::size_t(node) * words_per_row() + sample / 16];
    const PairState before = PairState((word >> (sample % 16 * 2)) & 3u);
    static_states_[at(node, sample)] = std::uint8_t(fixed);
    record(node, sample, before, state(node, sample));
}

bool VisibilityDatabase::counts(std::uint32_t node) const {
    if (node < patches_.nodes().size())
        return patches_.nodes()[node].is_leaf();
    return !mover_slots_[node - patches_.nodes().size()].is_null();
}

std::uint64_t& VisibilityDatabase::count_of(PairState state) {
    switch (state) {
    case PairState::full:
        return counters_.full;
    case PairState::partial:
        return counters_.partial;
    case PairState::none:
        return counters_.none;
    case PairState::unlit:
        break;
    }
    return counters_.unlit;
}

void VisibilityDatabase::record(std::uint32_t node, std::uint32_t sample, PairState before, PairState after) {
    write_flags(node, sample);
    if (before == after)
        return;
    write_pair(node, sample, after);
    if (node < patches_.nodes().size() ? patches_.nodes()[node].is_leaf() : true) {
        --count_of(before);
        ++count_of(after);
        changes_.push_back({node, sample, before, after});
    }
}

void VisibilityDatabase::write_pair(std::uint32_t node, std::uint32_t sample, PairState state) {
    std::uint32_t& word = rows_[std::size_t(node) * words_per_row() + sample / 16];
    const std::uint32_t shift = sample % 16 * 2;
    word = (word & ~(3u << shift)) | (std::uint32_t(state) << shift);
    dirty_[node] = 1;
}

void VisibilityDatabase::write_flags(std::uint32_t node, std::uint32_t sample) {
    std::uint32_t* const flags = rows_.data() + std::size_t(node) * words_per_row() + state_words();
    const PairState fixed = static_state(node, sample);
    const auto write = [&](std::uint32_t& word, bool set) {
        const std::uint32_t bit = 1u << (sample % 32), before = word;
        word = set ? word | bit : word & ~bit;
        if (word != before)
            dirty_[node] = 1;
    };
    write(flags[sample / 32], meets_mover(node, sample));
    write(flags[flag_words() + sample / 32], fixed == PairState::partial || fixed == PairState::full);
}

std::uint32_t VisibilityDatabase::flag_words() const {
    return std::uint32_t(samples_.size() + 31) / 32;
}

std::uint32_t VisibilityDatabase::state_words() const {
    return std::uint32_t(samples_.size() + shared::pairs_per_word - 1) / shared::pairs_per_word;
}

std::uint32_t VisibilityDatabase::words_per_row() const {
    return state_words() + 2 * flag_words();
}

// Rows of new nodes begin unlit, and without anything in the way.
void VisibilityDatabase::grow_rows() {
    static_states_.resize(at(node_count(), 0), std::uint8_t(PairState::unlit));
    full_counts_.resize(at(node_count(), 0));
    partial_counts_.resize(at(node_count(), 0));
    const std::size_t had = dirty_.size();
    rows_.resize(std::size_t(node_count()) * words_per_row(), 0xffffffffu);
    dirty_.resize(node_count(), 1);
    for (std::size_t node = had; node < node_count(); ++node)
        std::fill_n(rows_.begin() + std::ptrdiff_t(node * words_per_row() + state_words()),
                    words_per_row() - state_words(), 0u);
    for (std::size_t node = std::max(had, patches_.nodes().size()); node < node_count(); ++node)
        counters_.unlit += samples_.size();
}

std::vector<std::uint32_t> VisibilityDatabase::take_dirty_rows() {
    std::vector<std::uint32_t> result;
    for (std::uint32_t node = 0; node < dirty_.size(); ++node)
        if (dirty_[node]) {
            result.push_back(node);
            dirty_[node] = 0;
        }
    return result;
}

} // namespace sunfleck::gi
