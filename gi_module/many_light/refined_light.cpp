#include "gi_module/many_light/refined_light.h"

#include "engine/core/divide_up.h"
#include "engine/gpu/compute_pass.h"
#include "gi_module/shadows/light_batches.h"
#include "gi_module/technique.h"
#include "gi_module/transport/clamping.h"

#include <algorithm>
#include <utility>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t map_side = 128;    // texels; of so many maps, no single one shows
constexpr std::uint32_t small_group = 32;  // samples whose maps are drawn in one frame, with a budget
constexpr std::uint32_t large_group = 512; // and without
constexpr std::uint64_t most_evaluations = 400000000;
constexpr std::uint32_t fading_frames = 16; // with a budget
// Columns of texels: whether a place on the very edge of a surface is lit depends on how it is rounded, and of the many
// thin ones (frames, mouldings) all texels are on edges.
constexpr float border_inset = 0.25f;
constexpr std::uint32_t texels_at_once = 64;     // of a work group: baked_light.comp
constexpr double sum_of_all = 0x1p30;            // samples at their bounds, in steps, as in light maps
constexpr std::uint64_t evaluations_of_ray = 40; // a ray of nearby light takes as long
constexpr double bounded_share = 0.02; // of reflected light, by samples that are bounded more than all are in common

Result<gpu::Buffer> make_texels(gpu::Device& device, const char* name, std::uint64_t bytes, VkFormat format) {
    return gpu::Buffer::create(device, {name, bytes,
                                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                            VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                        gpu::MemoryUse::device, format});
}

// Whether a sample and a piece may face each other: a flat one by its corners, others always.
bool may_light(const shared::LightRow& row, const shared::LightMapJob& piece) {
    if (piece.first_point != shared::no_points)
        return true;
    const vec3 position(row.position_bound), axis(row.normal_offset), corner(piece.corner);
    if (glm::dot(position - corner, vec3(piece.normal)) <= 0.0f)
        return false;
    const float here = glm::dot(corner - position, axis);
    const float u = glm::dot(vec3(piece.u_edge), axis), v = glm::dot(vec3(piece.v_edge), axis);
    return here + std::max(u, 0.0f) + std::max(v, 0.0f) > 0.0f;
}

// The bounds of the geometry terms of those that refine. Samples of reflected light have one in common, which hardly
// any of their light undercuts: what it takes away is known at any point then, and given back (nearby_light.h).
class RefiningBounds {
public:
    explicit RefiningBounds(const RefinedLightScene& scene) : scale_(scene.light_settings.clamp_scale) {
        const std::span<const LightSample> samples = scene.samples.refining_samples();
        bound_ = geometry_bound(std::uint32_t(samples.size()), scene.rays.static_area(), scale_);
        // Where another technique lights some of what is reflected, it is not known here how bright surfaces are.
        if (!std::all_of(samples.begin(), samples.end(), [&](const LightSample& sample) {
                return !held_by_light_maps(sample) || owns_sample(scene.cells, sample);
            }))
            return;
        std::vector<std::pair<float, double>> reflected; // bound, light
        double all = 0.0, below = 0.0;
        for (const LightSample& sample : samples)
            if (sample.bounce > 0 && held_by_light_maps(sample)) {
                reflected.emplace_back(geometry_bound_of(sample.radius, bound_, scale_), luminance(sample.flux));
                all += reflected.back().second;
            }
        std::sort(reflected.begin(), reflected.end());
        for (const auto& [bound, light] : reflected) {
            common_ = bound;
            if ((below += light) >= bounded_share * all)
                break;
        }
    }

    float common() const { return common_; } // 0: nothing is reflected
    float of(const LightSample& sample) const {
        const float own = geometry_bound_of(sample.radius, bound_, scale_);
        return sample.bounce > 0 && common_ > 0.0f ? std::min(own, common_) : own;
    }

private:
    float scale_, bound_ = 0.0f, common_ = 0.0f;
};

// The share of the light of samples that is reflected once more; at the last bounce, it is not.
float reflected_again(std::span<const LightSample> samples) {
    std::uint32_t last = 0;
    for (const LightSample& sample : samples)
        last = std::max(last, sample.bounce);
    double all = 0.0, again = 0.0;
    for (const LightSample& sample : samples) {
        all += luminance(sample.flux);
        again += sample.bounce < last ? luminance(sample.flux) : 0.0;
    }
    return all > 0.0 ? float(again / all) : 0.0f;
}

} // namespace

Result<std::unique_ptr<RefinedLight>> RefinedLight::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<RefinedLight> light(new RefinedLight(device, pipelines));
    SUNFLECK_ASSIGN(light->refined_texels_, make_texels(device, "refined light", 8, VK_FORMAT_R32G32_UINT));
    return light;
}

void RefinedLight::forget() {
    cause_ = {};
    rows_.clear();
    own_ = false;
    group_begin_ = group_end_ = piece_ = 0;
    share_ = 0.0f;
    jobs_.clear();
    draws_maps_ = divides_ = false;
    nearby_.forget();
}

void RefinedLight::restart() {
    if (!draws_maps_ && !divides_ && jobs_.empty() && !nearby_.has_work())
        return;
    forget();
    if (maps_)
        maps_->begin_frame(true);
}

std::uint64_t RefinedLight::memory_bytes() const {
    return own_sums_.size() + refined_sums_.size() + refined_texels_.size() + (maps_ ? maps_->texels().size() : 0);
}

Status RefinedLight::begin(const RefinedLightScene& scene, const BakedLight& baked, std::uint32_t group,
                           gpu::FrameResources& resources) {
    if (!maps_) {
        SUNFLECK_ASSIGN(maps_, ShadowMaps::create(device_, pipelines_,
                                                  {"refined light maps", "refined light map copies", "",
                                                   "refined light map staging"}));
    }
    MapLayout layout;
    layout.resolution = map_side;
    layout.wanted = group;
    layout.memory_bytes = std::uint64_t(group) * map_side * map_side * layout.bits / 8;
    SUNFLECK_TRY(maps_->configure(layout, resources));
    largest_group_ = maps_->slots();
    texels_ = baked.texel_count();
    const auto renew = [&](gpu::Buffer& buffer, const char* name, std::uint64_t bytes, VkFormat format) -> Status {
        if (buffer && buffer.size() >= texels_ * bytes)
            return {};
        if (buffer)
            resources.retire(std::move(buffer));
        SUNFLECK_ASSIGN(buffer, make_texels(device_, name, texels_ * bytes, format));
        return {};
    };
    SUNFLECK_TRY(renew(own_sums_, "sums of the frame's samples", 16, VK_FORMAT_R32G32B32A32_SINT));
    SUNFLECK_TRY(renew(refined_sums_, "sums of refined light", 16, VK_FORMAT_R32G32B32A32_SINT));
    SUNFLECK_TRY(renew(refined_texels_, "refined light", 8, VK_FORMAT_R32G32_UINT));
    begin_nearby(scene, baked, make_rows(scene));
    begin_group(0);
    return {};
}

// The frame's own samples as they are when nothing blocks their paths, and the others. Returns the bound that those of
// reflected light have in common.
float RefinedLight::make_rows(const RefinedLightScene& scene) {
    own_rows_.assign(scene.samples.rows().begin(), scene.samples.rows().end());
    rows_.clear();
    const auto is_wanted = [&](const LightSample& sample) {
        return held_by_light_maps(sample) && owns_sample(scene.cells, sample);
    };
    for (const LightSample& sample : scene.samples.samples()) {
        vec4& intensity = own_rows_[sample.index].intensity_slot;
        intensity = vec4(is_wanted(sample) ? sample.flux / pi : vec3(0.0f), intensity.w);
    }
    const RefiningBounds bounds(scene);
    double most = 0.0;
    for (const LightSample& sample : scene.samples.refining_samples())
        if (is_wanted(sample)) {
            const shared::LightRow row = make_light_row(sample, 0, bounds.of(sample), scene.bounds);
            const vec4& intensity = row.intensity_slot;
            most += double(std::max({intensity.x, intensity.y, intensity.z})) * double(row.position_bound.w);
            rows_.push_back(row);
        }
    fixed_point_ = most > 0.0 ? float(sum_of_all / most) : 1.0f;
    return bounds.common();
}

NearbyLightScene RefinedLight::nearby_scene(const RefinedLightScene& scene, const BakedLight& baked) const {
    return {scene.database, scene.curved, scene.rays, scene.bounds, baked.pieces(), texels_, border_inset};
}

void RefinedLight::begin_nearby(const RefinedLightScene& scene, const BakedLight& baked, float bound) {
    std::vector<IncomingLight> others;
    for (const LightSample& sample : scene.samples.samples())
        if (sample.kind != SampleKind::surface && !sample.dynamic)
            others.push_back({make_light_row(sample, 0, 0.0f, scene.bounds), light_class(sample.kind)});
    const float reflected = reflected_again(scene.samples.refining_samples());
    nearby_.begin(nearby_scene(scene, baked), {bound, reflected, fixed_point_}, std::move(others));
}

void RefinedLight::begin_group(std::uint32_t begin) {
    group_begin_ = begin;
    group_end_ = std::min(begin + largest_group_, std::uint32_t(rows_.size()));
    piece_ = 0;
    for (std::uint32_t i = group_begin_; i < group_end_; ++i)
        rows_[i].intensity_slot.w = float(i - group_begin_);
}

void RefinedLight::add_job(LightMapJobs& jobs, const shared::LightMapJob& piece) const {
    bool added = group_begin_ == 0;
    if (added)
        jobs.add(piece, true);
    for (std::uint32_t i = 0; i < job_rows_.size(); ++i) {
        if (!may_light(job_rows_[i], piece))
            continue;
        if (!std::exchange(added, true))
            jobs.add(piece, false);
        jobs.add_change(i | shared::light_map_test);
    }
}

void RefinedLight::add_own_job(LightMapJobs& jobs, const RefinedLightScene& scene,
                               const BakedLight::Piece& piece) const {
    jobs.add(piece.job, true);
    BakedLight::add_samples(jobs, scene.database, scene.samples.samples(), piece, 0);
}

// Jobs of the next pieces.
void RefinedLight::take_portion(const RefinedLightScene& scene, const BakedLight& baked, std::uint64_t most) {
    sums_own_ = own_;
    draws_maps_ = !own_ && piece_ == 0;
    if (own_)
        job_rows_ = own_rows_;
    else
        job_rows_.assign(rows_.begin() + group_begin_, rows_.begin() + group_end_);
    const std::vector<BakedLight::Piece>& pieces = baked.pieces();
    const std::uint32_t first = piece_;
    const std::uint64_t most_changes = device_.traits().max_storage_range / sizeof(std::uint32_t);
    const std::uint64_t most_pieces = std::max<std::uint64_t>(most_changes / job_rows_.size(), 1);
    for (std::uint64_t taken = 0; piece_ < pieces.size() && taken < most && piece_ - first < most_pieces; ++piece_)
        taken += pieces[piece_].texels() * job_rows_.size() / 2 + 1; // half of them look the other way
    jobs_.add_all(piece_ - first, [&](LightMapJobs& jobs, std::uint32_t i) {
        const BakedLight::Piece& piece = pieces[first + i];
        if (own_)
            add_own_job(jobs, scene, piece);
        else
            add_job(jobs, piece.job);
    });
    jobs_.split(texels_at_once);
    if (piece_ < pieces.size())
        return;
    if (own_)
        divides_ = true;
    else
        begin_group(group_end_);
    own_ = !own_ && unsummed() == 0;
}

Status RefinedLight::update(const RefinedLightScene& scene, const BakedLight& baked, std::uint32_t budget,
                            gpu::FrameResources& resources) {
    jobs_.clear();
    draws_maps_ = divides_ = false;
    nearby_.end_frame();
    const bool in_portions = budget != FrameInput().refinement_budget;
    const Cause now{scene.samples.generation(), baked.pieces_generation(), scene.cells,
                    scene.light_settings.clamp_scale, baked.fixed_point()};
    if (cause_ != now || !baked.in_use())
        forget();
    if (!baked.in_use() || scene.samples.refining_samples().empty())
        return {};
    if (cause_ != now)
        SUNFLECK_TRY(begin(scene, baked, in_portions ? small_group : large_group, resources));
    cause_ = now;
    if (rows_.empty())
        return {};
    const bool is_summed = unsummed() == 0 && !own_ && !nearby_.light_waits() && !nearby_.sources_wait();
    if (is_summed && own_sums_)
        for (gpu::Buffer* sums : {&own_sums_, &refined_sums_})
            resources.retire(std::move(*sums));
    if (is_summed)
        share_ = in_portions ? std::min(share_ + 1.0f / float(fading_frames), 1.0f) : 1.0f;
    else if (budget > 0 && baked.counters().waiting == 0) { // that comes first
        const std::uint64_t evaluations = in_portions ? std::uint64_t(budget) * 1000 : most_evaluations;
        if (unsummed() == 0 && (nearby_.light_waits() || !own_))
            nearby_.update(nearby_scene(scene, baked), evaluations / evaluations_of_ray);
        else
            take_portion(scene, baked, evaluations);
    }
    return {};
}

Status RefinedLight::add_maps(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene,
                              gpu::FrameResources& resources) {
    std::vector<std::uint8_t> movers; // they cast no shadow here
    for (const scene::DrawItem& item : gpu_scene.draws())
        if (!item.is_static) {
            movers.resize(std::max<std::size_t>(movers.size(), item.entity.index + 1));
            movers[item.entity.index] = 1;
        }
    std::vector<ShadowRequest> requests(job_rows_.size());
    for (std::uint32_t i = 0; i < requests.size(); ++i) {
        requests[i].slot = i;
        requests[i].light_class = shared::light_class_surface;
        requests[i].light = job_rows_[i];
        requests[i].hidden = movers;
    }
    ShadowCounters counters;
    return maps_->add_passes(graph, gpu_scene, resources, requests, {}, counters);
}

Status RefinedLight::add_sums(gpu::FrameGraph& graph, const BakedLight& baked, const ShadowMaps& maps, bool filter,
                              gpu::FrameResources& resources) {
    const auto upload = [&](gpu::UploadedBuffer& buffer, const char* name, std::span<const std::byte> bytes) -> Status {
        SUNFLECK_TRY(buffer.reserve(device_, resources, name, bytes.size(), VK_FORMAT_R32G32B32A32_UINT));
        SUNFLECK_TRY(buffer.write(resources, 0, bytes));
        buffer.add_pass(graph);
        return {};
    };
    SUNFLECK_TRY(upload(job_texels_, "refined light jobs", std::as_bytes(jobs_.jobs())));
    SUNFLECK_TRY(
        upload(row_texels_, "refined light rows", std::as_bytes(std::span<const shared::LightRow>(job_rows_))));
    const ShadowMaps& used = sums_own_ ? maps : *maps_;
    gpu::ComputeDescription description;
    description.shader = "gi_module/many_light/baked_light.comp";
    description.specialization = {sums_own_ && filter, used.bits()};
    SUNFLECK_ASSIGN(const gpu::Pipeline* const kernel, pipelines_.compute(description));
    shared::LightMapConstants constants{};
    constants.fixed_point = sums_own_ ? cause_.fixed_point : fixed_point_;
    constants.map_resolution = used.resolution();
    constants.inset = sums_own_ ? 0.0f : border_inset;
    constants.jobs = std::uint32_t(jobs_.jobs().size());
    constants.row_length = std::min(constants.jobs, 32768u);
    SUNFLECK_ASSIGN(const gpu::UploadSlice changes, resources.upload(jobs_.changes()));
    gpu::ComputePass pass(graph, "refined light", *kernel);
    pass.texels(job_texels_.buffer())
        .storage_read(changes)
        .texels(row_texels_.buffer())
        .texels(sums_own_ ? maps.static_texels() : maps_->texels())
        .storage_read_write(sums_own_ ? own_sums_ : refined_sums_)
        .storage_read(baked.points())
        .push(constants)
        .dispatch(constants.row_length, divide_up(constants.jobs, constants.row_length));
    return {};
}

Status RefinedLight::add_ratios(gpu::FrameGraph& graph) {
    gpu::ComputeDescription description;
    description.shader = "gi_module/many_light/refined_light.comp";
    SUNFLECK_ASSIGN(const gpu::Pipeline* const kernel, pipelines_.compute(description));
    shared::RefinedLightConstants constants{};
    constants.texels = std::uint32_t(texels_);
    constants.row_length = std::min(constants.texels, 1u << 20);
    constants.own_steps = cause_.fixed_point / fixed_point_;
    gpu::ComputePass(graph, "refined light ratios", *kernel)
        .texels(own_sums_)
        .texels(refined_sums_)
        .storage_write(refined_texels_)
        .push(constants)
        .dispatch(divide_up(constants.row_length, 64), divide_up(constants.texels, constants.row_length));
    return {};
}

Status RefinedLight::add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const BakedLight& baked,
                                const ShadowMaps& maps, bool filter, gpu::FrameResources& resources) {
    if (draws_maps_)
        SUNFLECK_TRY(add_maps(graph, gpu_scene, resources));
    if (!jobs_.empty())
        SUNFLECK_TRY(add_sums(graph, baked, maps, filter, resources));
    const NearbyLight::Target target{refined_sums_, own_sums_, refined_texels_, cause_.fixed_point / fixed_point_};
    SUNFLECK_TRY(nearby_.add_passes(graph, pipelines_, target, resources));
    return divides_ ? add_ratios(graph) : Status();
}

} // namespace sunfleck::gi
