// The moving half of the database: states of pairs, and movers that come, change and go.
#include "gi_module/visibility/visibility_database.h"

#include "engine/core/divide_up.h"
#include "engine/core/jobs.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace sunfleck::gi {

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
    for (std::uint32_t root = 0; root < root_entities_.size(); ++root)
        note(root_entities_[root], root);
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

void VisibilityDatabase::begin_frame() {
    changes_.clear();
    std::fill(affected_.begin(), affected_.end(), std::uint8_t(0));
    counters_.tests = 0;
}

void VisibilityDatabase::update_movers(std::span<const MoverPlace> movers, const scene::MeshStore& meshes) {
    std::set<EntityBits> present;
    for (const MoverPlace& place : movers)
        present.insert(place.entity.bits());
    std::vector<ecs::Entity> gone;
    for (const auto& [bits, mover] : movers_)
        if (present.count(bits) == 0)
            gone.push_back(mover.entity);
    change_movers(movers, gone, meshes);
}

// By entity, whatever order they are given in: those that go, then those that come or stay.
void VisibilityDatabase::change_movers(std::span<const MoverPlace> changed, std::span<const ecs::Entity> removed,
                                       const scene::MeshStore& meshes) {
    std::map<EntityBits, const MoverPlace*> places;
    std::set<EntityBits> leaving;
    for (const ecs::Entity entity : removed)
        leaving.insert(entity.bits());
    for (const MoverPlace& place : changed) {
        const EntityBits bits = place.entity.bits();
        if (place.mesh < meshes.size())
            places[bits] = &place;
        const auto known = movers_.find(bits);
        if (known != movers_.end() &&
            (place.mesh >= meshes.size() || known->second.mesh != place.mesh || known->second.solid != place.solid))
            leaving.insert(bits);
    }
    for (const EntityBits bits : leaving)
        remove_mover(bits);
    std::vector<Mover*> movers;
    movers.reserve(places.size());
    for (const auto& [bits, place] : places)
        if (Mover* const mover = place_mover(*place, meshes); mover != nullptr)
            movers.push_back(mover);
    std::vector<std::uint32_t> samples(movers.empty() ? 0 : samples_.size());
    std::iota(samples.begin(), samples.end(), 0u);
    set_mover_pairs(movers, samples);
    for (const Mover* const mover : movers)
        mark_affected(*mover);
    replace_footprints(movers, all_clusters());
}

// Samples that see the mover where it is now: their maps show it.
void VisibilityDatabase::mark_affected(const Mover& mover) {
    const std::uint32_t node = mover_node(mover.entity);
    for (std::uint32_t sample = 0; mover.blocks && sample < samples_.size(); ++sample) {
        const PairState fixed = static_state(node, sample);
        affected_[sample] |= fixed == PairState::none || fixed == PairState::partial;
    }
}

void VisibilityDatabase::remove_mover(EntityBits bits) {
    const auto found = movers_.find(bits);
    if (found == movers_.end())
        return;
    Mover& mover = found->second;
    const std::uint32_t slot = mover.slot;
    mark_affected(mover);
    mover.blocks = false;
    Mover* const movers[] = {&mover};
    replace_footprints(movers, all_clusters());
    mover_slots_[slot] = ecs::null_entity;
    for (std::uint32_t sample = 0; sample < samples_.size(); ++sample)
        set_mover_pair(slot, sample, PairState::unlit);
    movers_.erase(found);
}

VisibilityDatabase::Mover& VisibilityDatabase::add_mover(const MoverPlace& place) {
    Mover& mover = movers_[place.entity.bits()];
    mover.entity = place.entity;
    mover.mesh = place.mesh;
    mover.solid = place.solid;
    mover.blocks = false; // until it is placed
    mover.footprint.resize(samples_.size());
    auto free = std::find(mover_slots_.begin(), mover_slots_.end(), ecs::null_entity);
    if (free == mover_slots_.end())
        free = mover_slots_.insert(free, ecs::null_entity);
    *free = place.entity;
    mover.slot = std::uint32_t(free - mover_slots_.begin());
    unlit_slots_.resize(mover_slots_.size(), 0);
    grow_rows();
    return mover;
}

// Null where the mover is known and nothing about it changed; else its pairs and footprints are still to be found.
VisibilityDatabase::Mover* VisibilityDatabase::place_mover(const MoverPlace& place, const scene::MeshStore& meshes) {
    const auto found = movers_.find(place.entity.bits());
    const bool added = found == movers_.end();
    Mover& mover = added ? add_mover(place) : found->second;
    if (!added && mover.matrix == place.matrix && mover.blocks == place.blocks &&
        unlit_slots_[mover.slot] == !place.lit && mover.revision == place.revision && !mover.outdated)
        return nullptr;
    mark_affected(mover);
    if (added || mover.revision != place.revision)
        mover.blocker = MovingBlocker(meshes[place.mesh], place.solid);
    mover.revision = place.revision;
    mover.blocks = place.blocks;
    unlit_slots_[mover.slot] = !place.lit;
    mover.matrix = place.matrix;
    mover.blocker.place(place.matrix);
    mover.outdated = false;
    return &mover;
}

// Of movers against static geometry.
void VisibilityDatabase::set_mover_pairs(std::span<Mover* const> movers, std::span<const std::uint32_t> samples) {
    std::vector<PairState> fixed(movers.size() * samples.size());
    counters_.tests += fixed.size();
    parallel_for_chunks(fixed.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            fixed[i] = decide_mover(movers[i / samples.size()]->blocker, samples_[samples[i % samples.size()]]);
    });
    for (std::size_t i = 0; i < fixed.size(); ++i)
        set_mover_pair(movers[i / samples.size()]->slot, samples[i % samples.size()], fixed[i]);
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

void VisibilityDatabase::record(std::uint32_t node, std::uint32_t sample, PairState before, PairState after) {
    write_flags(node, sample);
    if (before == after)
        return;
    write_pair(node, sample, after);
    if (node < patches_.nodes().size() ? patches_.nodes()[node].is_leaf() : true) {
        --counters_.of(before);
        ++counters_.of(after);
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
    return divide_up(std::uint32_t(samples_.size()), shared::pairs_per_word);
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
