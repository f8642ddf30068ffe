#include "gi_module/many_light/light_maps.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

// A near sample's light changes over the radius within which it is clamped: so many texels along it, and limits in m.
constexpr float texels_per_radius = 10.0f, smallest_texel = 0.02f, largest_texel = 0.10f;
constexpr std::uint32_t max_samples = 60000; // with more, a single texel would take too many
constexpr std::uint32_t invocations = 64;    // of a work group: light_maps.comp
constexpr std::uint32_t max_texels = 256;    // along a patch's side
constexpr std::uint64_t max_bytes = std::uint64_t(128) << 20;
constexpr float highest_sum = 1073741824.0f; // of all samples at once: 2^30 leaves room in 32 bits
// Samples times texels that a portion evaluates at most, and one job more: about 20 ms on two cores.
constexpr std::uint64_t evaluations_of_portion = 3000000;
constexpr double rounding_share = 0.002; // of the mean light: more is not lost to the steps

// Of what maps may cover, in units of the scene.
double covered_area(const VisibilityDatabase& database) {
    double area = 0.0;
    for (const SurfacePatch& patch : database.patches().nodes())
        if (patch.planar && patch.is_leaf())
            area += glm::length(patch.corners[1] - patch.corners[0]) * glm::length(patch.corners[3] - patch.corners[0]);
    return area;
}

} // namespace

float light_map_texel(float bound) {
    const float radius = bound > 0.0f ? 1.0f / std::sqrt(bound) : 1.0f;
    return std::clamp(radius / texels_per_radius, smallest_texel, largest_texel);
}

Result<std::unique_ptr<LightMaps>> LightMaps::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<LightMaps> maps(new LightMaps(device));
    gpu::ComputeDescription description;
    description.shader = "gi_module/many_light/light_maps.comp";
    SUNFLECK_ASSIGN(maps->kernel_, pipelines.compute(description));
    SUNFLECK_ASSIGN(maps->texels_, gpu::Buffer::create(device, {"light maps", 16, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                                gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
    return maps;
}

Status LightMaps::lay_out(const VisibilityDatabase& database, float texel_side, gpu::FrameResources& resources) {
    // Large scenes get coarser maps: a shader sees so many bytes of a buffer, and no host has memory without end.
    const std::uint64_t most = std::min(device_.traits().max_storage_range, max_bytes) / sizeof(glm::ivec4);
    std::uint64_t total = place_maps(database, texel_side);
    for (int i = 0; total > most && i < 64; ++i)
        total = place_maps(database, texel_side *= 1.25f);
    counters_.texels = total;
    const std::uint64_t bytes = std::max<std::uint64_t>(total, 1) * sizeof(glm::ivec4);
    if (texels_.size() >= bytes)
        return {};
    resources.retire(std::move(texels_));
    SUNFLECK_ASSIGN(texels_,
                    gpu::Buffer::create(device_, {"light maps", bytes,
                                                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                                  gpu::MemoryUse::device, VK_FORMAT_UNDEFINED}));
    return {};
}

// Fills the rows of nodes; returns the number of texels.
std::uint64_t LightMaps::place_maps(const VisibilityDatabase& database, float texel_side) {
    node_rows_.assign(database.patches().nodes().size(), {});
    std::uint64_t next = 0;
    for (std::size_t i = 0; i < node_rows_.size(); ++i) {
        const SurfacePatch& patch = database.patches().nodes()[i];
        shared::NodeRow& row = node_rows_[i];
        row.first_texel = shared::no_light_map;
        if (!patch.planar || !patch.is_leaf() || database.sample_count() > max_samples || steps_are_coarse_)
            continue;
        const auto texels = [&](const dvec3& a, const dvec3& b) {
            return std::clamp(std::uint32_t(std::ceil(float(glm::length(b - a)) / texel_side)) + 1u, 2u, max_texels);
        };
        row.place = patch.place;
        row.chart = patch.chart;
        row.columns = texels(patch.corners[0], patch.corners[1]);
        row.rows = texels(patch.corners[0], patch.corners[3]);
        row.first_texel = std::uint32_t(next);
        next += std::uint64_t(row.columns) * row.rows;
    }
    return next;
}

// Pairs that changed their state, with the old strengths; then the new strengths, wherever the samples reach now.
void LightMaps::follow_changes(const VisibilityDatabase& database, std::span<const LightSample> samples,
                               std::span<const std::uint32_t> changed) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> wanted; // node, change
    for (const PairChange& change : database.changes())
        if (change.node < node_rows_.size() && node_rows_[change.node].first_texel != shared::no_light_map &&
            held_by_light_maps(samples[change.sample]) && reaches(change.before) != reaches(change.after))
            wanted.emplace_back(change.node, change.sample | (reaches(change.after) ? 0u : shared::light_map_subtract));
    std::vector<std::uint32_t> replacement;
    for (std::uint32_t k = 0; k < changed.size(); ++k) {
        replacement.clear();
        add_replacement(replacement, job_rows_, std::uint32_t(summed_rows_.size()) + 2 * k, 0);
        for (std::uint32_t node = 0; node < node_rows_.size(); ++node)
            if (node_rows_[node].first_texel != shared::no_light_map && reaches(database.state(node, changed[k])))
                for (const std::uint32_t change : replacement)
                    wanted.emplace_back(node, change);
    }
    std::stable_sort(wanted.begin(), wanted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (i == 0 || wanted[i].first != wanted[i - 1].first)
            changes_.add(database.patches().nodes()[wanted[i].first], node_rows_[wanted[i].first], false);
        changes_.add_change(wanted[i].second);
    }
}

Status LightMaps::update(const VisibilityDatabase& database, std::span<const LightSample> samples,
                         std::span<const shared::LightRow> rows, bool in_portions, gpu::FrameResources& resources) {
    changes_.clear();
    portion_ = next_;
    std::vector<std::uint32_t> changed;
    const bool first = generation_ != database.generation();
    if (!first && find_changed_intensities(samples, summed_rows_, rows, changed)) {
        job_rows_ = summed_rows_;
        add_replacements(job_rows_, rows, changed);
        follow_changes(database, samples, changed);
        changes_.split(invocations);
        summed_rows_.assign(rows.begin(), rows.end());
        take_portion(in_portions && changes_.empty() && changed.empty());
        return {};
    }
    generation_ = database.generation();
    summed_rows_.assign(rows.begin(), rows.end());
    job_rows_ = summed_rows_;
    double most = 0.0, flux = 0.0;
    float bound = 0.0f;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (held_by_light_maps(samples[i])) {
            // Of all samples at full strength, so that the steps are the same whatever is blocked.
            const vec3 intensity = samples[i].flux / pi;
            const double brightest = double(std::max({intensity.x, intensity.y, intensity.z}));
            most += brightest * double(rows[i].position_bound.w);
            flux += brightest * double(pi);
            bound = std::max(bound, rows[i].position_bound.w);
        }
    fixed_point_ = most > 0.0 ? float(double(highest_sum) / most) : 1.0f;
    // Each sample's light is rounded: off by a step over the root of 12, at random. With a bound that hardly bounds
    // (clamp_scale), steps are too coarse for that, and samples are evaluated at every pixel instead.
    const double rounding = std::sqrt(double(samples.size()) / 12.0) / double(fixed_point_);
    steps_are_coarse_ = flux > 0.0 && rounding * covered_area(database) > rounding_share * flux;
    SUNFLECK_TRY(lay_out(database, light_map_texel(bound), resources));
    sum_all(database, samples);
    take_portion(in_portions && first);
    return {};
}

void LightMaps::restart() {
    generation_ = 0;
    sums_ = {};
    portion_ = next_ = 0;
    counters_.waiting = 0;
}

void LightMaps::sum_all(const VisibilityDatabase& database, std::span<const LightSample> samples) {
    sums_ = {};
    portion_ = next_ = 0;
    sums_.add_all(node_rows_.size(), [&](LightMapJobs& jobs, std::uint32_t node) {
        if (node_rows_[node].first_texel == shared::no_light_map)
            return;
        jobs.add(database.patches().nodes()[node], node_rows_[node], true);
        for (std::uint32_t sample = 0; sample < samples.size(); ++sample)
            if (held_by_light_maps(samples[sample]) && reaches(database.state(node, sample)))
                jobs.add_change(sample);
    });
    sums_.split(invocations);
}

// What is left, or a portion of it. Once all is done, nothing of it is kept.
void LightMaps::take_portion(bool only_one) {
    if (portion_ == sums_.jobs().size()) {
        sums_ = {};
        portion_ = 0;
    }
    next_ = only_one ? sums_.end_of_portion(portion_, evaluations_of_portion) : sums_.jobs().size();
    counters_.waiting = sums_.jobs().size() - next_;
    counters_.updates = changes_.changes().size();
    for (std::size_t i = portion_; i < next_; ++i)
        counters_.updates += sums_.jobs()[i].change_count;
}

Status LightMaps::add_passes(gpu::FrameGraph& graph, gpu::FrameResources& resources) {
    const std::span<const shared::LightMapJob> portion = sums_.jobs().subspan(portion_, next_ - portion_);
    if (portion.empty() && changes_.empty())
        return {};
    SUNFLECK_ASSIGN(const gpu::UploadSlice rows, resources.upload(std::span<const shared::LightRow>(job_rows_)));
    const std::uint64_t most = device_.traits().max_storage_range;
    std::vector<LightMapJobs::Piece> pieces = sums_.pieces(most, portion);
    for (LightMapJobs::Piece& piece : changes_.pieces(most))
        pieces.push_back(std::move(piece));
    for (const LightMapJobs::Piece& piece : pieces) {
        SUNFLECK_ASSIGN(const gpu::UploadSlice jobs,
                        resources.upload(std::span<const shared::LightMapJob>(piece.jobs)));
        SUNFLECK_ASSIGN(const gpu::UploadSlice changes, resources.upload(piece.changes));
        const std::uint32_t count = std::uint32_t(piece.jobs.size()), row_length = std::min(count, 32768u);
        gpu::ComputePass(graph, "light maps", *kernel_)
            .storage_read(jobs)
            .storage_read(changes)
            .storage_read(rows)
            .storage_read_write(texels_)
            .push(shared::LightMapConstants{fixed_point_, count, row_length, 0, 0.0f})
            .dispatch(row_length, divide_up(count, row_length));
    }
    return {};
}

} // namespace sunfleck::gi
