// What is decided for many pairs at once: groups of root patches, clusters of samples, and what becomes of scenes with
// more pairs than can be tested one by one.
#include "gi_module/visibility/build_progress.h"
#include "gi_module/visibility/visibility_database.h"

#include "engine/core/jobs.h"
#include "engine/core/memory_limit.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace sunfleck::gi {
namespace {

constexpr std::size_t roots_per_group = 4;
constexpr std::size_t most_groups = 1024; // leaves of their tree: each sample may be tested with all of them

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

} // namespace

// Where testing every root with every sample would take too long, the largest ones are tested: they cover most of the
// picture. What is known of the others is what one blocker or the sample's tangent plane does to a group of them; all
// else is "partial", which is always right, and costs shadow tests.
void VisibilityDatabase::choose_exact_roots() {
    is_exact_.clear();
    const std::size_t roots = patches_.roots(), samples = std::max<std::size_t>(samples_.size(), 1);
    if (roots <= options_.max_tests / samples)
        return;
    const std::size_t most = std::size_t(std::min(options_.max_tests, options_.max_tests_of_largest) / samples);
    std::vector<std::uint32_t> order(roots);
    std::iota(order.begin(), order.end(), 0u);
    std::vector<float> sizes(roots);
    for (std::size_t i = 0; i < roots; ++i) {
        const vec3 extent = patches_.nodes()[i].bounds.extent();
        sizes[i] = glm::dot(extent, extent);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return sizes[a] > sizes[b]; });
    is_exact_.assign(roots, 0);
    for (std::size_t i = 0; i < most; ++i)
        is_exact_[order[i]] = 1;
}

// Of all nodes that there are, and their rows for shaders.
Status VisibilityDatabase::check_size(std::uint64_t bytes_per_pair) const {
    const std::uint64_t nodes = patches_.nodes().size(), samples = samples_.size(), rows = nodes * words_per_row() * 4;
    const std::string what =
        "the visibility of " + std::to_string(nodes) + " surfaces from " + std::to_string(samples) + " light samples";
    if (rows > options_.max_row_bytes)
        return Error{what + " would take a buffer of " + std::to_string(rows >> 20) + " MiB; this device allows " +
                         std::to_string(options_.max_row_bytes >> 20) +
                         ". Lower the number of light samples (lights), or switch the setting visibility off",
                     ErrorCode::memory};
    return check_memory(nodes * samples * bytes_per_pair + rows, what, "the number of light samples (lights)");
}

bool VisibilityDatabase::may_split_more() const {
    const std::uint64_t samples = samples_.size(), nodes = patches_.nodes().size() + 4;
    return nodes * samples <= options_.max_pairs && nodes * words_per_row() * 4 <= options_.max_row_bytes &&
           (is_exact_.empty() || (nodes - patches_.roots()) * samples <= options_.max_tests_of_largest);
}

void VisibilityDatabase::decide_coarse_roots(BuildProgress& progress) {
    progress.begin_level(samples_.size());
    parallel_for_chunks(samples_.size(), 1, [&](std::size_t begin, std::size_t end) {
        std::vector<PairState> states(patches_.nodes().size());
        for (std::size_t sample = begin; sample < end && !progress.stopped(); ++sample) {
            decide_group(0, samples_[sample], states);
            for (std::uint32_t node = 0; node < patches_.roots(); ++node)
                if (!is_exact(node))
                    static_states_[at(node, std::uint32_t(sample))] = std::uint8_t(states[node]);
            progress.add(1);
        }
    });
    progress.end_level();
}

// All charts that one blocker hides, or the sample's tangent plane, at once.
void VisibilityDatabase::decide_group(std::uint32_t group, const LightSample& sample,
                                      std::vector<PairState>& states) const {
    const Group& node = groups_[group];
    const Bounds roomy{node.bounds.minimum - 1e-5f, node.bounds.maximum + 1e-5f};
    const auto gate = gate_of_box(sample, OrientedBox::of(roomy));
    if (!gate)
        return decide_roots(group, PairState::unlit, states);
    if (static_blockers_.covers(*gate))
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
    for (Cluster& cluster : clusters_)
        cluster.radius = 0.5f * glm::length(cluster.bounds.extent());
}

void VisibilityDatabase::make_outlines() {
    root_entities_.clear();
    root_entities_.reserve(patches_.roots());
    for (std::uint32_t root = 0; root < patches_.roots(); ++root)
        root_entities_.push_back(patches_.nodes()[root].entity);
    outlines_.clear();
    outlines_.reserve(patches_.nodes().size());
    for (const SurfacePatch& patch : patches_.nodes()) {
        const vec3 corner = patch.planar ? vec3(patch.corners[0]) : vec3(0.0f);
        outlines_.push_back({patch.bounds, vec3(patch.normal), corner, 0.5f * glm::length(patch.bounds.extent()),
                             patch.first_child, patch.planar});
    }
}

void VisibilityDatabase::make_groups() {
    groups_.clear();
    std::vector<std::uint32_t> roots(patches_.roots());
    std::iota(roots.begin(), roots.end(), 0u);
    const std::size_t largest_leaf = std::max<std::size_t>(roots_per_group, roots.size() / most_groups);
    if (!roots.empty())
        make_group(std::move(roots), largest_leaf);
}

std::uint32_t VisibilityDatabase::make_group(std::vector<std::uint32_t> roots, std::size_t largest_leaf) {
    const std::uint32_t index = std::uint32_t(groups_.size());
    groups_.emplace_back();
    Bounds bounds, centres;
    for (const std::uint32_t root : roots) {
        bounds.add(patches_.nodes()[root].bounds);
        centres.add(patches_.nodes()[root].bounds.centre());
    }
    groups_[index].bounds = bounds;
    groups_[index].radius = 0.5f * glm::length(bounds.extent());
    if (roots.size() <= largest_leaf) {
        groups_[index].roots = std::move(roots);
        return index;
    }
    const vec3 extent = centres.extent();
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::stable_sort(roots.begin(), roots.end(), [&](std::uint32_t a, std::uint32_t b) {
        return patches_.nodes()[a].bounds.centre()[axis] < patches_.nodes()[b].bounds.centre()[axis];
    });
    const auto middle = roots.begin() + std::ptrdiff_t(roots.size() / 2);
    const std::uint32_t left = make_group({roots.begin(), middle}, largest_leaf);
    const std::uint32_t right = make_group({middle, roots.end()}, largest_leaf);
    groups_[index].left = left;
    groups_[index].right = right;
    return index;
}

} // namespace sunfleck::gi
