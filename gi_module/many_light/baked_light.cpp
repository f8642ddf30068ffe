#include "gi_module/many_light/baked_light.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t invocations = 64; // texels that a work group handles at a time: baked_light.comp
// Samples times texels that a frame evaluates at most, and one patch more: 30 to 60 ms on two cores. More at first: the
// frame that builds the visibility database is long anyway.
constexpr std::uint64_t most_evaluations = 16000000, most_evaluations_at_first = 400000000;
// Of the light: by so much may second differences of neighbouring texels exceed a straight line. Interpolation is off
// by at most half of it where a single edge lies between two texels, by an eighth where light is curved evenly.
constexpr float roughness_limit = 0.2f;
constexpr std::uint64_t texel_bytes = 8;

std::uint64_t texels_of(const shared::NodeRow& row) {
    return std::uint64_t(row.columns) * row.rows;
}

// Beside a sample in a change: some of its light is blocked.
std::uint32_t test_flag(PairState state) {
    return state == PairState::partial ? shared::light_map_test : 0u;
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
    jobs_.clear();
    finish_.clear();
    waiting_.clear();
    wipe_ = false;
    counters_ = {};
}

Status BakedLight::start_anew(const VisibilityDatabase& database, const LightMaps& light_maps,
                              std::span<const shared::LightRow> rows, gpu::FrameResources& resources) {
    generation_ = database.generation();
    fixed_point_ = light_maps.fixed_point();
    baked_rows_.assign(rows.begin(), rows.end());
    waiting_.clear();
    for (std::uint32_t node = std::uint32_t(light_maps.node_rows().size()); node-- > 0;)
        if (light_maps.node_rows()[node].first_texel != shared::no_light_map)
            waiting_.push_back(node);
    wipe_ = true;
    const std::uint64_t texels = std::max<std::uint64_t>(light_maps.counters().texels, 1);
    if (sums_.size() >= texels * sizeof(glm::ivec4))
        return {};
    resources.retire(std::move(sums_));
    resources.retire(std::move(texels_));
    SUNFLECK_ASSIGN(sums_, gpu::Buffer::create(device_, {"baked light sums", texels * sizeof(glm::ivec4),
                                                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::MemoryUse::device,
                                                         VK_FORMAT_UNDEFINED}));
    SUNFLECK_ASSIGN(
        texels_,
        gpu::Buffer::create(device_, {"baked light", texels * texel_bytes,
                                      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                          VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                                      gpu::MemoryUse::device, VK_FORMAT_R16G16B16A16_SFLOAT}));
    return {};
}

// False if it would be too much for a frame.
bool BakedLight::follow_strengths(const VisibilityDatabase& database, const LightMaps& light_maps,
                                  std::span<const shared::LightRow> rows, std::span<const std::uint32_t> changed) {
    job_rows_ = baked_rows_;
    for (const std::uint32_t sample : changed)
        job_rows_.push_back(rows[sample]);
    std::vector<std::uint8_t> waits(light_maps.node_rows().size(), 0);
    for (const std::uint32_t node : waiting_)
        waits[node] = 1;
    std::uint64_t evaluations = 0;
    for (std::uint32_t node = 0; node < light_maps.node_rows().size() && !changed.empty(); ++node) {
        const shared::NodeRow& row = light_maps.node_rows()[node];
        if (row.first_texel == shared::no_light_map || waits[node])
            continue;
        bool begun = false;
        for (std::uint32_t k = 0; k < changed.size(); ++k) {
            const PairState state = database.static_state(node, changed[k]);
            if (!reaches(state))
                continue;
            if (!begun) {
                jobs_.add(database.patches().nodes()[node], row, false);
                finish_.add(database.patches().nodes()[node], row, false);
            }
            begun = true;
            jobs_.add_change(changed[k] | test_flag(state) | shared::light_map_subtract);
            jobs_.add_change((std::uint32_t(baked_rows_.size()) + k) | test_flag(state));
            evaluations += 2 * texels_of(row);
        }
    }
    baked_rows_.assign(rows.begin(), rows.end());
    return evaluations <= most_evaluations;
}

void BakedLight::bake_waiting(const VisibilityDatabase& database, const LightMaps& light_maps,
                              std::span<const LightSample> samples, std::uint64_t most) {
    const std::uint32_t now = std::uint32_t(job_rows_.size()); // the rows as they are at present
    job_rows_.insert(job_rows_.end(), baked_rows_.begin(), baked_rows_.end());
    std::uint64_t evaluations = 0;
    while (!waiting_.empty() && evaluations < most) {
        const std::uint32_t node = waiting_.back();
        waiting_.pop_back();
        const shared::NodeRow& row = light_maps.node_rows()[node];
        jobs_.add(database.patches().nodes()[node], row, true);
        finish_.add(database.patches().nodes()[node], row, false);
        for (std::uint32_t sample = 0; sample < samples.size(); ++sample) {
            const PairState state = database.static_state(node, sample);
            if (!held_by_light_maps(samples[sample]) || !reaches(state))
                continue;
            jobs_.add_change((now + sample) | test_flag(state));
            evaluations += texels_of(row);
        }
        evaluations += texels_of(row);
    }
}

Status BakedLight::update(const VisibilityDatabase& database, const LightMaps& light_maps,
                          std::span<const LightSample> samples, std::span<const shared::LightRow> rows,
                          bool static_maps_changed, gpu::FrameResources& resources) {
    if (light_maps.counters().texels > device_.traits().max_texel_elements) {
        forget();
        return {};
    }
    jobs_.clear();
    finish_.clear();
    job_rows_.clear();
    wipe_ = false;
    in_use_ = true;
    std::vector<std::uint32_t> changed;
    const bool first = generation_ != database.generation();
    const bool same = !first && !static_maps_changed && fixed_point_ == light_maps.fixed_point() &&
                      find_new_strengths(samples, baked_rows_, rows, changed);
    if (!same || !follow_strengths(database, light_maps, rows, changed)) {
        jobs_.clear();
        finish_.clear();
        job_rows_.clear();
        SUNFLECK_TRY(start_anew(database, light_maps, rows, resources));
    }
    bake_waiting(database, light_maps, samples, first ? most_evaluations_at_first : most_evaluations);
    counters_ = {jobs_.changes().size(), waiting_.size()};
    jobs_.split(invocations);
    finish_.split(invocations);
    return {};
}

Status BakedLight::add_passes(gpu::FrameGraph& graph, const ShadowMaps& maps, bool filter,
                              gpu::FrameResources& resources) {
    const gpu::ResourceId texels = graph.import_buffer(texels_);
    if (wipe_)
        graph.add_pass("baked light")
            .write(texels, gpu::Usage::transfer_destination)
            .execute([this](gpu::PassContext& context) -> Status {
                context.device.vk.vkCmdFillBuffer(context.commands, texels_.handle(), 0, VK_WHOLE_SIZE,
                                                  0x3c003c00u); // ones: every cell is rough
                return {};
            });
    if (jobs_.empty())
        return {};
    gpu::ComputeDescription description;
    description.shader = "gi_module/many_light/baked_light.comp";
    description.bindings = {gpu::BindingKind::storage_buffer, gpu::BindingKind::storage_buffer,
                            gpu::BindingKind::storage_buffer, gpu::BindingKind::texel_buffer,
                            gpu::BindingKind::storage_buffer};
    description.push_constant_bytes = sizeof(shared::LightMapConstants);
    description.specialization = {filter, maps.bits()};
    SUNFLECK_ASSIGN(const gpu::Pipeline* const bake, pipelines_.compute(description));
    description.shader = "gi_module/many_light/baked_light_cells.comp";
    description.bindings.assign(3, gpu::BindingKind::storage_buffer);
    description.specialization = {};
    SUNFLECK_ASSIGN(const gpu::Pipeline* const finish, pipelines_.compute(description));

    SUNFLECK_ASSIGN(const gpu::UploadSlice jobs, resources.upload(jobs_.jobs()));
    SUNFLECK_ASSIGN(const gpu::UploadSlice finish_jobs, resources.upload(finish_.jobs()));
    SUNFLECK_ASSIGN(const gpu::UploadSlice changes, resources.upload(jobs_.changes()));
    SUNFLECK_ASSIGN(const gpu::UploadSlice rows, resources.upload(std::span<const shared::LightRow>(job_rows_)));
    const gpu::ResourceId sums = graph.import_buffer(sums_);
    const auto dispatch = [](gpu::PassContext& context, const gpu::Pipeline& kernel,
                             shared::LightMapConstants constants) {
        constants.row_length = std::min(constants.jobs, 32768u);
        context.resources.push(context.commands, kernel, constants);
        context.device.vk.vkCmdDispatch(context.commands, constants.row_length,
                                        (constants.jobs + constants.row_length - 1) / constants.row_length, 1);
    };
    shared::LightMapConstants constants{};
    constants.fixed_point = fixed_point_;
    constants.map_resolution = maps.resolution();
    constants.roughness_limit = roughness_limit;
    constants.jobs = std::uint32_t(jobs_.jobs().size());
    graph.add_pass("baked light")
        .read(graph.import_buffer(maps.static_texels()), gpu::Usage::texel_read)
        .write(sums, gpu::Usage::storage_read_write)
        .execute([this, bake, jobs, changes, rows, constants, dispatch, &maps](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {gpu::Binding::slice(jobs), gpu::Binding::slice(changes),
                                             gpu::Binding::slice(rows), gpu::Binding::texels(maps.static_texels()),
                                             gpu::Binding::buffer(sums_)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *bake, bindings));
            dispatch(context, *bake, constants);
            return {};
        });
    constants.jobs = std::uint32_t(finish_.jobs().size());
    graph.add_pass("baked light")
        .read(sums, gpu::Usage::storage_read)
        .write(texels, gpu::Usage::storage_write)
        .execute([this, finish, finish_jobs, constants, dispatch](gpu::PassContext& context) -> Status {
            const gpu::Binding bindings[] = {gpu::Binding::slice(finish_jobs), gpu::Binding::buffer(sums_),
                                             gpu::Binding::buffer(texels_)};
            SUNFLECK_TRY(context.resources.bind(context.commands, *finish, bindings));
            dispatch(context, *finish, constants);
            return {};
        });
    return {};
}

} // namespace sunfleck::gi
