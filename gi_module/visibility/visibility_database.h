// What stands between every light sample and every surface patch: state and blockers of each pair, kept while objects
// move. Thesis sec. 4.3.1 (how a pair is decided) and 4.5.1 (how decisions are maintained).
//
// A pair's state is a pure function of the static geometry, the sample and the movers' present places:
//   unlit    the patch faces away from the sample, or lies behind it
//   full     one convex blocker takes all the light
//   partial  something may take some of it
//   none     nothing does
// Static geometry is decided once. Of each mover, the database keeps its footprint: for each sample the sorted list of
// the nodes that it shadows, and whether fully. When a mover moves, its new footprint is made and compared with the old
// one; the differences are the cases of table 4-1, and only they touch pairs. (The thesis keeps the list of blockers at
// each pair instead; the footprint holds the same facts sorted by blocker, so that one mover's are found and replaced
// without a search, and counts at the pair are enough to infer its state.) Nodes within are found top-down: what a
// parent settles (none, full), its children inherit without tests.
//
// Samples of emitters that move (LightSample::dynamic) are decided again every frame, so more coarsely: what one
// blocker hides from them is found for whole groups of charts, all else that they face is "partial".
//
// Movers are nodes, too. They shadow themselves and each other, so between "unlit", "full" (by static geometry) and
// "partial" they have no state "none".
#pragma once

#include "engine/scene/scene_changes.h"
#include "gi_module/visibility/moving_blocker.h"
#include "gi_module/visibility/surface_patches.h"
#include "gi_module/visibility/test_grouping.h"

#include <functional>
#include <map>

namespace sunfleck::gi {

enum class PairState : std::uint8_t {
    full = shared::pair_full,
    none = shared::pair_none,
    partial = shared::pair_partial,
    unlit = shared::pair_unlit,
};

struct MoverPlace {
    ecs::Entity entity;
    std::uint32_t mesh = 0;
    mat4 matrix{1.0f};
    bool blocks = true;         // false: it is lit, but casts no shadow
    bool lit = true;            // false: its pixels get no light from here, so that all its pairs read "unlit"
    bool solid = true;          // false: it has holes, or changes its shape
    std::uint32_t revision = 0; // of the mesh

    // Lit, for all that a drawable says.
    static MoverPlace of(const scene::Drawable& drawable) {
        const bool solid = drawable.material.alpha_mode == scene::AlphaMode::opaque && drawable.revision == 0;
        return {drawable.entity, drawable.mesh, drawable.matrix, drawable.casts_shadow, true, solid, drawable.revision};
    }
};

struct PairChange {
    std::uint32_t node, sample;
    PairState before, after;
};

struct VisibilityOptions {
    PatchOptions patches;
    float split_share = 0.08f; // patches are split if at least this share of the samples that reach them is partial
    std::uint64_t max_pairs = std::uint64_t(24) << 20; // no further splits beyond
    // Where testing all roots with all samples takes more tests than that, only the largest are tested, within the
    // second number; the others are decided in groups.
    std::uint64_t max_tests = std::uint64_t(2) << 20, max_tests_of_largest = std::uint64_t(1) << 18;
    std::uint64_t max_row_bytes = ~std::uint64_t(0); // of all rows for shaders
    TestGrouping tests = TestGrouping::clusters;     // of movers
};

struct VisibilityCounters {
    std::uint64_t tests = 0;                                  // of blockers against pyramids, and of clusters
    std::uint64_t full = 0, partial = 0, none = 0, unlit = 0; // pairs of leaves and movers

    std::uint64_t& of(PairState state) {
        return state == PairState::full      ? full
               : state == PairState::partial ? partial
               : state == PairState::none    ? none
                                             : unlit;
    }
};

class BuildProgress;

class VisibilityDatabase {
public:
    // From scratch: finds patches of the registry's static geometry, splits them, decides all pairs. No movers yet.
    // The samples are not copied: they must stay where they are until the next build or change_samples.
    // `progress` is called with the share that is done, from any thread, never concurrently; if it returns false, build
    // stops. False: it was stopped, or the pairs are more than memory or the device's buffers hold: problem() says
    // which, and the database is empty.
    bool build(ecs::Registry& registry, const scene::MeshStore& meshes, std::span<const LightSample> samples,
               const VisibilityOptions& options, const std::function<bool(float)>& progress = {});
    const Error& problem() const { return problem_; }
    // Forgets the changes of the last frame. Once a frame, before the two below.
    void begin_frame();
    // Samples with these indices have changed (their values already have, where it is the same array); their number and
    // which are dynamic have not. The patches stay. `placed_next`: movers that change_movers or update_movers is called
    // with next, which then finds what they shadow from the changed samples, too; until then that is as it was.
    void change_samples(std::span<const LightSample> samples, std::span<const std::uint32_t> changed,
                        std::span<const MoverPlace> placed_next = {});
    // Follows the movers. Either by those that are new or may have changed and those that are gone (of all others
    // nothing is looked at), or by the whole set, without which there is nothing to follow after a build. In any order;
    // states depend on the set alone.
    void change_movers(std::span<const MoverPlace> changed, std::span<const ecs::Entity> removed,
                       const scene::MeshStore& meshes);
    void update_movers(std::span<const MoverPlace> movers, const scene::MeshStore& meshes);

    std::uint32_t node_count() const { return std::uint32_t(patches_.nodes().size() + mover_slots_.size()); }
    std::uint32_t sample_count() const { return std::uint32_t(samples_.size()); }
    const SurfacePatches& patches() const { return patches_; }
    // The node of a mover; no_node if it is none.
    std::uint32_t mover_node(ecs::Entity entity) const;

    PairState state(std::uint32_t node, std::uint32_t sample) const;
    PairState static_state(std::uint32_t node, std::uint32_t sample) const {
        return PairState(static_states_[at(node, sample)]);
    }
    // By entity index: 1 if static geometry hides all of the entity from the sample, so that it casts no shadow of its
    // own. Entities that are neither static geometry nor movers are not hidden.
    std::vector<std::uint8_t> hidden_entities(std::uint32_t sample) const;
    struct Blocker {
        ecs::Entity entity; // null: static geometry
        bool full = false;
        bool operator==(const Blocker&) const = default;
    };
    // Static geometry first, then movers by entity.
    std::vector<Blocker> blockers(std::uint32_t node, std::uint32_t sample) const;

    // Calls visit(node) for each leaf that a mover may shadow from the sample, once for each such mover.
    template <typename Visit>
    void visit_shadowed(std::uint32_t sample, const Visit& visit) const {
        for (const auto& [entity, mover] : movers_)
            for (const std::uint32_t entry : mover.footprint[sample])
                visit(entry >> 1);
    }

    // Since the last begin_frame. A pair may change more than once; changes are in order.
    const std::vector<PairChange>& changes() const { return changes_; }
    // Samples that changed, and those whose shadow map shows a mover that moved (and is, or was, in sight of them), was
    // added or removed.
    const std::vector<std::uint8_t>& affected_samples() const { return affected_; }
    const VisibilityCounters& counters() const { return counters_; }

    // Whether a mover may stand between the two.
    bool meets_mover(std::uint32_t node, std::uint32_t sample) const {
        return full_counts_[at(node, sample)] > 0 || partial_counts_[at(node, sample)] > 0;
    }

    // Rows for shaders: `words_per_row` words a node. First `state_words` of them with two bits a sample, its state;
    // then `flag_words` with a bit a sample, whether it meets a mover; and as many, whether static geometry may block
    // it. take_dirty_rows: nodes whose row changed since the last call.
    std::uint32_t words_per_row() const;
    std::uint32_t state_words() const;
    std::uint32_t flag_words() const;
    const std::vector<std::uint32_t>& rows() const { return rows_; }
    std::vector<std::uint32_t> take_dirty_rows();
    // Raised by build: everything read before is void.
    std::uint64_t generation() const { return generation_; }
    std::uint64_t memory_bytes() const;

private:
    // node * 2 + (full ? 1 : 0), sorted.
    using Footprint = std::vector<std::uint32_t>;
    struct Mover {
        ecs::Entity entity;
        std::uint32_t mesh = 0;
        std::uint32_t revision = 0;
        bool solid = true;
        std::uint32_t slot = 0;
        mat4 matrix{1.0f};
        bool blocks = true;
        bool outdated = false; // samples have changed since its footprints were found
        MovingBlocker blocker;
        std::vector<Footprint> footprint; // by sample
    };
    struct Cluster {
        Bounds bounds;
        float radius = 0.0f; // of the ball around the bounds; so in all of these
        std::vector<std::uint32_t> samples;
        bool unbounded = false; // directional samples
    };
    // What of a patch decides most tests, in one line of the cache.
    struct alignas(64) Outline {
        Bounds bounds;
        vec3 normal{0.0f}, corner{0.0f}; // of planar patches
        float radius = 0.0f;
        std::uint32_t first_child = shared::no_node;
        bool planar = true;
    };
    struct Group { // of root nodes
        Bounds bounds;
        float radius = 0.0f;
        std::uint32_t left = 0, right = 0;
        std::vector<std::uint32_t> roots;
    };
    static constexpr std::size_t samples_per_cluster = 16;
    // Some samples of a cluster.
    struct ClusterPart {
        const Cluster* cluster = nullptr;
        std::span<const std::uint32_t> samples;
    };
    // Footprints of one mover for them, while they are found.
    struct FootprintWalk {
        ClusterPart part;
        const MovingBlocker* blocker = nullptr;
        std::array<Footprint, samples_per_cluster> footprints;
        std::uint64_t tests = 0;
    };

    Status check_size(std::uint64_t bytes_per_pair) const;
    bool split_and_decide(const std::function<bool(float)>& progress);
    PairState decide_static(std::uint32_t node, std::uint32_t sample, LikelyBlockers* likely = nullptr) const;
    PairState inherit(const SurfacePatch& patch, PairState parent, const LightSample& sample) const;
    std::vector<PairState> decide_all_static(std::uint32_t sample) const;
    void decide_group(std::uint32_t group, const LightSample& sample, std::vector<PairState>& states) const;
    void decide_roots(std::uint32_t group, PairState state, std::vector<PairState>& states) const;
    PairState decide_box(const SurfacePatch& patch, const LightSample& sample, LikelyBlockers* likely) const;
    PairState decide_mover(const MovingBlocker& mover, const LightSample& sample) const;
    void make_clusters();
    void make_groups();
    std::uint32_t make_group(std::vector<std::uint32_t> roots, std::size_t largest_leaf);
    void make_outlines();
    void change_static_states(std::span<const std::uint32_t> changed);
    void choose_exact_roots();
    bool is_exact(std::uint32_t node) const { return node >= is_exact_.size() || is_exact_[node] != 0; }
    bool may_split_more() const;
    void decide_coarse_roots(BuildProgress& progress);
    // Roots that a mover may shadow from a cluster of samples.
    void candidate_roots(const Cluster& cluster, const MovingBlocker& mover, std::uint32_t group, Footprint& roots,
                         std::uint64_t& tests) const;
    static bool may_meet_hull(const Cluster& cluster, const Bounds& bounds, float radius, const MovingBlocker& mover);
    static bool behind(const Outline& patch, const MovingBlocker& mover);
    static bool may_shadow(const LightSample& light, const Outline& patch, const MovingBlocker& mover);
    Blocking shadow_on(std::uint32_t node, const LightSample& light, const MovingBlocker& blocker) const;
    void find_footprints(FootprintWalk& walk, const Mover& mover) const;
    void descend(FootprintWalk& walk, std::uint32_t node, std::uint32_t active, std::uint32_t counting) const;
    void add_all(std::uint32_t node, std::uint32_t sample, Footprint& out) const;
    Footprint roots_for(const Cluster& cluster, const Mover& mover, std::uint64_t& tests) const;
    bool reaches(const Mover& mover, std::uint32_t sample) const;
    std::vector<ClusterPart> all_clusters() const;
    void replace_footprints(std::span<Mover* const> movers, std::span<const ClusterPart> parts);
    Mover& add_mover(const MoverPlace& place);
    Mover* place_mover(const MoverPlace& place, const scene::MeshStore& meshes);
    void remove_mover(EntityBits bits);
    void mark_affected(const Mover& mover);
    void apply(std::uint32_t sample, const Footprint& before, const Footprint& after, std::vector<PairChange>& changes);
    void set_mover_pairs(std::span<Mover* const> movers, std::span<const std::uint32_t> samples);
    void set_mover_pair(std::uint32_t slot, std::uint32_t sample, PairState fixed);
    void record(std::uint32_t node, std::uint32_t sample, PairState before, PairState after);
    bool counts(std::uint32_t node) const;
    void write_pair(std::uint32_t node, std::uint32_t sample, PairState state);
    void write_flags(std::uint32_t node, std::uint32_t sample);
    std::size_t at(std::uint32_t node, std::uint32_t sample) const {
        return std::size_t(node) * samples_.size() + sample;
    }
    void recount();
    void grow_rows();

    VisibilityOptions options_;
    Error problem_;
    std::span<const LightSample> samples_; // the owner's
    SurfacePatches patches_;
    StaticBlockers static_blockers_;
    std::vector<Cluster> clusters_;
    std::vector<std::uint32_t> cluster_of_; // by sample
    std::vector<Group> groups_;
    std::vector<Outline> outlines_; // by node of the patches
    std::vector<ecs::Entity> root_entities_;
    std::vector<std::uint8_t> is_exact_;    // by root; empty: all are
    std::map<EntityBits, Mover> movers_;    // ordered: results never depend on insertion
    std::vector<ecs::Entity> mover_slots_;  // node = static nodes + slot; null entity: free
    std::vector<std::uint8_t> unlit_slots_; // by slot: MoverPlace::lit is false
    std::vector<std::uint8_t> static_states_;
    std::vector<std::uint16_t> full_counts_, partial_counts_;
    std::vector<PairChange> changes_;
    std::vector<std::uint8_t> affected_;
    std::vector<std::uint32_t> rows_;
    std::vector<std::uint8_t> dirty_;
    VisibilityCounters counters_;
    std::uint64_t generation_ = 0;
};

} // namespace sunfleck::gi
