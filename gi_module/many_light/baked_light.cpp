#include "gi_module/many_light/baked_light.h"

#include "engine/core/divide_up.h"
#include "engine/core/jobs.h"
#include "engine/gpu/compute_pass.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t texels_at_a_time = 64; // of a work group: baked_light.comp
// Samples times texels that a frame evaluates at most, and one patch more: 30 to 60 ms on two cores. More at first: the
// frame that builds the visibility database is long anyway.
constexpr std::uint64_t max_evaluations = 16000000, max_first_evaluations = 400000000;
// In portions: as long with filtered shadow maps, which take some eight times as long, beside the frames of others.
constexpr std::uint64_t max_portion_evaluations = 2000000;
constexpr std::uint64_t max_portion_marks = 50000; // texels whose cells are marked again: some 5 ms
// Of the light: by so much may second differences of neighbouring texels exceed a straight line. Interpolation is off
// by at most half of it where a single edge lies between two texels, by an eighth where light is curved evenly.
constexpr float roughness_limit = 0.2f;
// Where light is refined, that of a frame's few samples at a pixel is off by more than that.
constexpr float refined_roughness_limit = 0.5f;
constexpr std::uint64_t texel_bytes = 8;
constexpr std::uint32_t longest_roughness_wait = 32; // frames, where strengths never cease to change

// What static geometry lets pass of a sample's light to some nodes: nothing, or a sample's change (light_maps_shared.h)
// with the flag for shadow tests if some of it is blocked.
std::optional<std::uint32_t> test_flag(const VisibilityDatabase& database, std::span<const std::uint32_t> nodes,
                                       std::uint32_t sample) {
    bool any = false, blocked = false;
    for (const std::uint32_t node : nodes) {
        const PairState state = database.static_state(node, sample);
        any = any || reaches(state);
        blocked = blocked || state == PairState::partial || state == PairState::full;
    }
    if (!any)
        return std::nullopt;
    return blocked ? shared::light_map_test : 0u;
}

} // namespace

Result<std::unique_ptr<BakedLight>> BakedLight::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<BakedLight> light(new BakedLight(device, pipelines));
    SUNFLECK_ASSIGN(light->texels_,
                    gpu::Buffer::create(device, {"baked light", texel_bytes, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                                                 gpu::MemoryUse::device, VK_FORMAT_R16G16B16A16_SFLOAT}));
    return light;
}

void BakedLight::forget() {
    in_use_ = false;
    generation_ = 0;
    points_.forget_pieces();
    curved_rows_.forget_pieces();
    jobs_.clear();
    finish_.clear();
    waiting_.clear();
    wipe_ = false;
    wiped_.clear();
    counters_ = {};
}

void BakedLight::find_pieces(const VisibilityDatabase& database, const LightMaps& light_maps,
                             const CurvedCharts& curved) {
    pieces_.clear();
    for (std::uint32_t node = 0; node < light_maps.node_rows().size(); ++node)
        if (const shared::NodeRow& row = light_maps.node_rows()[node]; row.first_texel != shared::no_light_map)
            pieces_.push_back({LightMapJobs::job_of(database.patches().nodes()[node], row), {node}});
    for (const CurvedChart& chart : curved.charts()) {
        if (chart.columns == 0)
            continue;
        shared::LightMapJob job{};
        const float scale = chart.row.size.w;
        const float side = chart.direction % 2 == 0 ? 1.0f : -1.0f;
        job.height[int(chart.direction / 2)] = side * scale;
        job.height.w = -chart.row.place.z * scale;
        job.cell = scale / chart.row.place.w;
        job.first_point = chart.first_point;
        job.first_texel = std::uint32_t(light_maps.counters().texels) + chart.first_point;
        job.columns = chart.columns;
        job.rows = chart.rows;
        const std::span<const std::uint32_t> nodes = curved.nodes(chart);
        pieces_.push_back({job, {nodes.begin(), nodes.end()}});
    }
}

Status BakedLight::upload_charts(std::uint64_t first_texel, const CurvedCharts& curved,
                                 gpu::FrameResources& resources) {
    std::vector<shared::CurvedChartRow> rows;
    for (const CurvedChart& chart : curved.charts()) {
        rows.push_back(chart.row);
        rows.back().size.z += float(first_texel); // whole numbers below 2^24 are exact
    }
    const auto row_bytes = std::as_bytes(std::span(rows)), point_bytes = std::as_bytes(std::span(curved.points()));
    SUNFLECK_TRY(curved_rows_.reserve(device_, resources, "curved charts",
                                      std::max(row_bytes.size(), sizeof(shared::CurvedChartRow)),
                                      VK_FORMAT_R32G32B32A32_SFLOAT));
    SUNFLECK_TRY(points_.reserve(device_, resources, "points of curved surfaces",
                                 std::max(point_bytes.size(), sizeof(shared::CurvedPoint))));
    SUNFLECK_TRY(curved_rows_.write(resources, 0, row_bytes));
    return points_.write(resources, 0, point_bytes);
}

Status BakedLight::start_anew(const VisibilityDatabase& database, const LightMaps& light_maps,
                              const CurvedCharts& curved, std::span<const shared::LightRow> rows,
                              gpu::FrameResources& resources) {
    if (generation_ != database.generation()) {
        find_pieces(database, light_maps, curved);
        SUNFLECK_TRY(upload_charts(light_maps.counters().texels, curved, resources));
    }
    generation_ = database.generation();
    fixed_point_ = light_maps.fixed_point();
    baked_rows_.assign(rows.begin(), rows.end());
    waiting_.resize(pieces_.size());
    std::iota(waiting_.rbegin(), waiting_.rend(), 0u);
    wipe_ = true;
    next_marked_ = pieces_.size(); // baking marks them all
    roughness_waits_.assign(pieces_.size(), 0);
    const std::uint64_t texels = std::max<std::uint64_t>(light_maps.counters().texels + curved.points().size(), 1);
    texel_count_ = texels;
    if (sums_.size() >= texels * sizeof(glm::ivec4))
        return {};
    resources.retire(std::move(sums_));
    resources.retire(std::move(texels_));
    SUNFLECK_ASSIGN(
        sums_, gpu::Buffer::create(device_, {"baked light sums", texels * sizeof(glm::ivec4),
                                             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                                             gpu::MemoryUse::device, VK_FORMAT_R32G32B32A32_SINT}));
    SUNFLECK_ASSIGN(
        texels_,
        gpu::Buffer::create(device_, {"baked light", texels * texel_bytes,
                                      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                          VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                                      gpu::MemoryUse::device, VK_FORMAT_R16G16B16A16_SFLOAT}));
    return {};
}

// The piece is rough from this frame on, until it is its turn.
void BakedLight::bake_later(std::uint32_t piece) {
    roughness_waits_[piece] = 0;
    waiting_.insert(waiting_.begin(), piece);
    wiped_.push_back(piece);
}

// While more strengths change in the frames that follow, what is rough is what it was before: finding that takes as
// long as summing, and is done once they have.
void BakedLight::follow_strengths(const VisibilityDatabase& database, std::span<const shared::LightRow> rows,
                                  std::span<const std::uint32_t> changed, bool more_follow) {
    job_rows_ = baked_rows_;
    add_replacements(job_rows_, rows, changed);
    std::vector<std::uint8_t> waits(pieces_.size(), 0);
    for (const std::uint32_t piece : waiting_)
        waits[piece] = 1;
    std::vector<std::uint32_t> changes;
    roughness_waited_ = more_follow ? roughness_waited_ + 1 : 0;
    if (roughness_waited_ > longest_roughness_wait)
        roughness_waited_ = 0, more_follow = false;
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
        const Piece& piece = pieces_[i];
        if (waits[i])
            continue;
        changes.clear();
        for (std::uint32_t k = 0; k < changed.size(); ++k)
            if (const auto flag = test_flag(database, piece.nodes, changed[k]))
                add_replacement(changes, job_rows_, std::uint32_t(baked_rows_.size()) + 2 * k, *flag);
        evaluations_ += changes.size() * piece.texels();
        if (!changes.empty() && evaluations_ > max_evaluations) {
            bake_later(i);
            continue;
        }
        if (!changes.empty() || (roughness_waits_[i] != 0 && !more_follow))
            finish_.add(piece.job, !more_follow);
        roughness_waits_[i] = more_follow && (roughness_waits_[i] != 0 || !changes.empty());
        if (!changes.empty())
            jobs_.add(piece.job, false);
        for (const std::uint32_t change : changes)
            jobs_.add_change(change);
    }
    baked_rows_.assign(rows.begin(), rows.end());
}

// How many of those that wait are baked in this frame, from the last on: until they evaluate so much, or their changes
// are as many as a shader can see. Both are counted for many at once.
std::uint32_t BakedLight::take_waiting(const VisibilityDatabase& database, std::span<const LightSample> samples,
                                       std::uint64_t most) {
    constexpr std::size_t at_once = 1024;
    const std::uint64_t most_changes = device_.traits().max_storage_range / sizeof(std::uint32_t);
    std::size_t count = 0;
    std::uint64_t changes = jobs_.changes().size();
    std::vector<std::uint64_t> reached; // by how many samples, or somewhat more
    const auto is_full = [&] { return evaluations_ >= most || changes + samples.size() >= most_changes; };
    while (count < waiting_.size() && !is_full()) {
        reached.assign(std::min(at_once, waiting_.size() - count), 1);
        parallel_for_chunks(reached.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Piece& piece = pieces_[waiting_[waiting_.size() - 1 - count - i]];
                for (std::uint32_t sample = 0; sample < samples.size(); ++sample)
                    if (held_by_light_maps(samples[sample]))
                        reached[i] += test_flag(database, piece.nodes, sample).has_value();
            }
        });
        for (std::size_t i = 0; i < reached.size() && !is_full(); ++i, ++count) {
            evaluations_ += reached[i] * pieces_[waiting_[waiting_.size() - 1 - count]].texels();
            changes += reached[i];
        }
    }
    return std::uint32_t(count);
}

void BakedLight::add_samples(LightMapJobs& jobs, const VisibilityDatabase& database,
                             std::span<const LightSample> samples, const Piece& piece, std::uint32_t first_row) {
    for (std::uint32_t sample = 0; sample < samples.size(); ++sample)
        if (held_by_light_maps(samples[sample]))
            if (const auto flag = test_flag(database, piece.nodes, sample))
                jobs.add_change((first_row + sample) | *flag);
}

void BakedLight::bake_waiting(const VisibilityDatabase& database, std::span<const LightSample> samples,
                              std::uint64_t most) {
    const std::uint32_t now = std::uint32_t(job_rows_.size()); // the rows as they are at present
    job_rows_.insert(job_rows_.end(), baked_rows_.begin(), baked_rows_.end());
    const std::uint32_t count = take_waiting(database, samples, most);
    const auto piece_at = [&](std::uint32_t i) -> const Piece& { return pieces_[waiting_[waiting_.size() - 1 - i]]; };
    for (std::uint32_t i = 0; i < count; ++i)
        finish_.add(piece_at(i).job, true);
    jobs_.add_all(count, [&](LightMapJobs& jobs, std::uint32_t i) {
        const Piece& piece = piece_at(i);
        jobs.add(piece.job, true);
        add_samples(jobs, database, samples, piece, now);
    });
    waiting_.resize(waiting_.size() - count);
}

Status BakedLight::update(const ManyLightScene& scene, const LightMaps& light_maps, bool static_maps_changed,
                          bool in_portions, gpu::FrameResources& resources) {
    const VisibilityDatabase& database = scene.database;
    if (light_maps.counters().texels + scene.curved.points().size() > device_.traits().max_texel_elements) {
        forget();
        return {};
    }
    jobs_.clear();
    finish_.clear();
    job_rows_.clear();
    wipe_ = false;
    wiped_.clear();
    evaluations_ = 0;
    in_use_ = true;
    std::vector<std::uint32_t> changed;
    const bool first = generation_ != database.generation();
    const bool same = !first && !static_maps_changed && fixed_point_ == light_maps.fixed_point() &&
                      find_changed_intensities(scene.samples, baked_rows_, scene.rows, changed);
    if (same)
        follow_strengths(database, scene.rows, changed, scene.strengths_wait);
    else
        SUNFLECK_TRY(start_anew(database, light_maps, scene.curved, scene.rows, resources));
    const std::uint64_t usual = first ? max_first_evaluations : max_evaluations;
    if (finish_.empty() && waiting_.empty())
        mark_again(in_portions ? max_portion_marks : texel_count_);
    bake_waiting(database, scene.samples, in_portions ? max_portion_evaluations : usual);
    counters_ = {jobs_.changes().size(), waiting_.size()};
    jobs_.split(texels_at_a_time);
    return {};
}

void BakedLight::judge_by(const gpu::Buffer& texels, bool refined) {
    refined_texels_ = &texels;
    if (std::exchange(refined_, refined) != refined)
        next_marked_ = 0;
}

// In a frame in which no other cells are marked.
void BakedLight::mark_again(std::uint64_t most_texels) {
    for (std::uint64_t texels = 0; marks_again() && texels < most_texels; ++next_marked_) {
        finish_.add(pieces_[next_marked_].job, true);
        texels += pieces_[next_marked_].texels();
    }
}

// Texels become rough: all, or those of some pieces.
void BakedLight::add_wipe(gpu::FrameGraph& graph) {
    graph.add_pass("baked light wipe")
        .write(graph.import_buffer(texels_), gpu::Usage::transfer_destination)
        .execute([this](gpu::PassContext& context) -> Status {
            constexpr std::uint32_t ones = 0x3c003c00u; // every cell is rough
            const auto fill = [&](VkDeviceSize offset, VkDeviceSize bytes) {
                context.device.vk.vkCmdFillBuffer(context.commands, texels_.handle(), offset, bytes, ones);
            };
            if (wipe_)
                fill(0, VK_WHOLE_SIZE);
            for (const std::uint32_t piece : wiped_)
                fill(pieces_[piece].job.first_texel * texel_bytes, pieces_[piece].texels() * texel_bytes);
            return {};
        });
}

Status BakedLight::upload_jobs(gpu::FrameGraph& graph, gpu::FrameResources& resources) {
    const auto upload = [&](gpu::UploadedBuffer& buffer, const char* name, std::span<const std::byte> bytes) -> Status {
        SUNFLECK_TRY(buffer.reserve(device_, resources, name, bytes.size(), VK_FORMAT_R32G32B32A32_UINT));
        SUNFLECK_TRY(buffer.write(resources, 0, bytes));
        buffer.add_pass(graph);
        return {};
    };
    SUNFLECK_TRY(upload(job_texels_, "baked light jobs", std::as_bytes(jobs_.jobs())));
    SUNFLECK_TRY(upload(finish_texels_, "baked light cell jobs", std::as_bytes(finish_.jobs())));
    return upload(row_texels_, "baked light rows", std::as_bytes(std::span<const shared::LightRow>(job_rows_)));
}

Status BakedLight::add_passes(gpu::FrameGraph& graph, const ShadowMaps& maps, bool filter,
                              gpu::FrameResources& resources) {
    points_.add_pass(graph);
    curved_rows_.add_pass(graph);
    if (wipe_ || !wiped_.empty())
        add_wipe(graph);
    if (finish_.empty()) // of each piece that has a job
        return {};
    gpu::ComputeDescription description;
    description.shader = "gi_module/many_light/baked_light.comp";
    description.specialization = {filter, maps.bits()};
    SUNFLECK_ASSIGN(const gpu::Pipeline* const bake, pipelines_.compute(description));
    description.shader = "gi_module/many_light/baked_light_cells.comp";
    description.specialization = {};
    SUNFLECK_ASSIGN(const gpu::Pipeline* const finish, pipelines_.compute(description));

    SUNFLECK_TRY(upload_jobs(graph, resources));
    shared::LightMapConstants constants{};
    constants.fixed_point = fixed_point_;
    constants.map_resolution = maps.resolution();
    constants.roughness_limit = refined_ ? refined_roughness_limit : roughness_limit;
    constants.refined = refined_;
    const auto dispatch = [&](gpu::ComputePass& pass, std::size_t count) {
        constants.jobs = std::uint32_t(count);
        constants.row_length = std::min(constants.jobs, 32768u);
        pass.push(constants).dispatch(constants.row_length, divide_up(constants.jobs, constants.row_length));
    };
    if (!jobs_.empty()) {
        SUNFLECK_ASSIGN(const gpu::UploadSlice changes, resources.upload(jobs_.changes()));
        gpu::ComputePass pass(graph, "baked light", *bake);
        pass.texels(job_texels_.buffer())
            .storage_read(changes)
            .texels(row_texels_.buffer())
            .texels(maps.static_texels())
            .storage_read_write(sums_)
            .storage_read(points_.buffer());
        dispatch(pass, jobs_.jobs().size());
    }
    gpu::ComputePass pass(graph, "baked light cells", *finish);
    pass.texels(finish_texels_.buffer())
        .texels(sums_)
        .storage_read_write(texels_)
        .storage_read(points_.buffer())
        .texels(*refined_texels_);
    dispatch(pass, finish_.jobs().size());
    return {};
}

} // namespace sunfleck::gi
