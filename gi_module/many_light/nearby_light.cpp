#include "gi_module/many_light/nearby_light.h"

#include "engine/core/divide_up.h"
#include "engine/core/jobs.h"
#include "engine/core/octahedral.h"
#include "engine/core/random.h"
#include "engine/core/shared_exponent.h"
#include "engine/gpu/compute_pass.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/transport/arrival.h"
#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t rays_of_texel = 32;
constexpr std::uint32_t first_rays = 8;    // of those; where none meets anything, there is nothing nearby
constexpr std::uint32_t usual_rays = 25;   // in the mean over texels
constexpr std::size_t others_at_once = 64; // one of so many is looked at from where a ray ends
constexpr std::uint32_t texels_of_part = 64;
constexpr std::size_t kept_together = 500000; // entries of a frame, after the first round: less than a millisecond each

// A reflecting point at which a ray ended, and how much of its light samples do not give.
struct Meeting {
    raytrace::SurfacePoint point;
    vec3 normal{0.0f}; // geometric, towards the ray
    float missing = 0.0f;
    bool front = true;
};

std::optional<Meeting> meet(const NearbyLightScene& scene, const raytrace::Ray& ray, float cosine, float bound) {
    const auto hit = scene.rays.closest_hit(ray, raytrace::Scope::static_only);
    if (!hit)
        return std::nullopt;
    Meeting meeting;
    meeting.point = scene.rays.surface(ray, *hit);
    meeting.front = glm::dot(meeting.point.geometric_normal, ray.direction) < 0.0f;
    meeting.normal = meeting.front ? meeting.point.geometric_normal : -meeting.point.geometric_normal;
    const float other_cosine = std::abs(glm::dot(meeting.point.shading_normal, ray.direction));
    const float term = cosine * other_cosine / std::max(hit->distance * hit->distance, 1e-30f);
    meeting.missing = std::max(1.0f - bound / std::max(term, 1e-30f), 0.0f);
    return meeting;
}

} // namespace

void NearbyLight::forget() {
    round_ = finished;
    end_frame();
}

void NearbyLight::end_frame() {
    copies_ = false;
    portion_ = nullptr;
    found_ = {};
    if (round_ == finished)
        portions_.clear();
}

void NearbyLight::begin(const NearbyLightScene& scene, const NearbyLightCause& cause,
                        std::vector<IncomingLight> others) {
    forget();
    cause_ = cause;
    others_ = std::move(others);
    next_ = next_texel_ = 0;
    piece_of_.assign(scene.database.patches().nodes().size(), shared::no_node);
    for (std::uint32_t i = 0; i < scene.pieces.size(); ++i)
        if (scene.pieces[i].job.first_point == shared::no_points)
            piece_of_[scene.pieces[i].nodes.front()] = i;
    directions_.clear();
    for (std::uint32_t i = 0; i < rays_of_texel; ++i) {
        const RandomSequence numbers(SequenceKind::sobol, 0, i);
        directions_.emplace_back(numbers.at(0), numbers.at(1));
    }
    round_ = cause.bound > 0.0f && cause.reflected > 0.0f ? first_light : finished;
}

// As baked_light.comp has them.
std::optional<NearbyLight::Texel> NearbyLight::texel_of(const NearbyLightScene& scene, const BakedLight::Piece& piece,
                                                        std::uint32_t place) const {
    const shared::LightMapJob& job = piece.job;
    Texel texel;
    texel.index = job.first_texel + place;
    if (job.first_point != shared::no_points) {
        const shared::CurvedPoint& point = scene.curved.points()[job.first_point + place];
        texel.position = vec3(point.position);
        texel.normal = shared::unpack_normal(point.normal);
        texel.geometric_normal = shared::unpack_normal(point.geometric_normal);
        return point.exists != 0 ? std::optional(texel) : std::nullopt;
    }
    const vec2 last(job.columns - 1, job.rows - 1);
    const vec2 uv =
        glm::clamp(vec2(place % job.columns, place / job.columns), vec2(scene.inset), last - scene.inset) / last;
    texel.position = vec3(job.corner) + vec3(job.u_edge) * uv.x + vec3(job.v_edge) * uv.y;
    texel.normal = texel.geometric_normal = vec3(job.normal);
    return texel;
}

// The nearest texel of the surface at a point, on its front.
std::optional<std::uint32_t> NearbyLight::texel_at(const NearbyLightScene& scene,
                                                   const raytrace::SurfacePoint& point) const {
    const SurfacePatches& patches = scene.database.patches();
    const std::uint32_t node = patches.node_at(point.entity, point.on_triangle, point.geometric_normal);
    if (node < piece_of_.size() && piece_of_[node] != shared::no_node) {
        const shared::LightMapJob& job = scene.pieces[piece_of_[node]].job;
        const vec3 from = point.on_triangle - vec3(job.corner), u(job.u_edge), v(job.v_edge);
        const auto place = [](float along, std::uint32_t count) {
            const float inside = along > 0.0f ? std::min(along, 1.0f) : 0.0f; // also of a patch without extent
            return std::uint32_t(std::lround(inside * float(count - 1)));
        };
        return job.first_texel + place(glm::dot(from, v) / glm::dot(v, v), job.rows) * job.columns +
               place(glm::dot(from, u) / glm::dot(u, u), job.columns);
    }
    const std::uint32_t first = scene.curved.first_chart(point.entity);
    if (first == shared::no_node)
        return std::nullopt;
    const std::uint32_t direction = shared::curved_direction(point.geometric_normal);
    const CurvedChart& chart = scene.curved.charts()[first + direction];
    if (chart.columns == 0)
        return std::nullopt;
    const vec2 place =
        (vec2(shared::curved_place(direction, point.on_triangle)) - vec2(chart.row.place)) * chart.row.place.w;
    const glm::ivec2 nearest(glm::clamp(glm::round(place), vec2(0.0f), vec2(chart.columns - 1, chart.rows - 1)));
    const std::uint32_t index = chart.first_point + std::uint32_t(nearest.y) * chart.columns + std::uint32_t(nearest.x);
    if (scene.curved.points()[index].exists == 0)
        return std::nullopt;
    return std::uint32_t(scene.texels - scene.curved.points().size()) + index;
}

// One of the lights, chosen by what it gives where nothing is in the way, in place of all: of these, or of some of
// them in turn (resampled importance sampling; J. Talbot, D. Cline, P. Egbert, EGSR 2005).
vec3 NearbyLight::light_of_others(const NearbyLightScene& scene, vec3 point, vec3 normal, std::uint32_t turn) const {
    const std::size_t stride = std::max<std::size_t>(divide_up(others_.size(), others_at_once), 1);
    const float far = 4.0f * glm::length(scene.bounds.extent());
    float sum = 0.0f;
    vec3 chosen(0.0f), to_light(0.0f);
    for (std::size_t i = turn % stride; i < others_.size(); i += stride) {
        const Arrival arrived = arrival(others_[i].row, others_[i].light_class, point, far);
        const float cosine = glm::dot(normal, arrived.to_light) / glm::length(arrived.to_light);
        const vec3 irradiance = arrived.irradiance * std::max(cosine, 0.0f);
        const float weight = luminance(irradiance);
        if (!(weight > 0.0f))
            continue;
        sum += weight;
        if (to_unit_float(hash_combine(turn, std::uint32_t(i))) * sum < weight) {
            chosen = irradiance / weight;
            to_light = arrived.to_light;
        }
    }
    const raytrace::Ray ray{point, to_light, 0.0f, 0.9999f};
    if (sum <= 0.0f || scene.rays.occluded(ray, raytrace::Scope::static_only))
        return vec3(0.0f);
    return chosen * sum * float(stride);
}

void NearbyLight::look(const NearbyLightScene& scene, const Texel& texel, Portion& portion) const {
    std::array<Seen, rays_of_texel> seen;
    std::uint32_t count = 0;
    vec3 constant(0.0f);
    const float offset = raytrace::ray_offset(texel.position);
    const auto add = [&](std::uint32_t index, vec3 weight) {
        const auto same =
            std::find_if(seen.begin(), seen.begin() + count, [&](const Seen& one) { return one.texel == index; });
        if (same == seen.begin() + count)
            *same = Seen{index, vec3(0.0f)}, ++count;
        same->weight += weight;
    };
    for (std::uint32_t i = 0; i < rays_of_texel; ++i) {
        if (i == first_rays && count == 0)
            return;
        const vec3 direction = sample_cosine_direction(texel.normal, directions_[i].x, directions_[i].y);
        if (glm::dot(direction, texel.geometric_normal) <= 0.0f)
            continue;
        const raytrace::Ray ray{texel.position + offset * texel.geometric_normal, direction, 0.0f,
                                1.0f / std::sqrt(cause_.bound)};
        const auto meeting = meet(scene, ray, glm::dot(direction, texel.normal), cause_.bound);
        if (!meeting || (!meeting->front && scene.database.patches().is_closed(meeting->point.entity)))
            continue;
        const vec3 weight = mean_reflectance(meeting->point.material) * (meeting->missing / float(rays_of_texel));
        const auto index = meeting->front ? texel_at(scene, meeting->point) : std::nullopt;
        add(index.value_or(texel.index), weight * cause_.reflected);
        if (!others_.empty() && meeting->missing > 0.0f)
            constant +=
                weight * light_of_others(scene, meeting->point.on_triangle + meeting->point.offset * meeting->normal,
                                         meeting->normal, hash_combine(texel.index, i));
    }
    if (count == 0)
        return;
    const float steps = cause_.fixed_point / shared::constant_steps;
    portion.rows.push_back(
        {texel.index, std::uint32_t(portion.entries.size()), count, shared::pack_shared_exponent(constant * steps)});
    for (std::uint32_t i = 0; i < count; ++i)
        portion.entries.push_back({seen[i].texel, shared::pack_shared_exponent(seen[i].weight)});
}

NearbyLight::Portion NearbyLight::find(const NearbyLightScene& scene, std::uint64_t texels) {
    struct Part {
        std::uint32_t piece = 0, first = 0, end = 0;
    };
    std::vector<Part> parts;
    for (std::uint64_t taken = 0; next_ < scene.pieces.size() && taken < texels;) {
        const std::uint32_t all = std::uint32_t(scene.pieces[next_].texels());
        const std::uint32_t end = std::min(next_texel_ + texels_of_part, all);
        parts.push_back({std::uint32_t(next_), next_texel_, end});
        taken += end - next_texel_;
        next_texel_ = end < all ? end : 0;
        next_ += end == all;
    }
    std::vector<Portion> found(parts.size());
    parallel_for_chunks(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            for (std::uint32_t place = parts[i].first; place < parts[i].end; ++place)
                if (const auto texel = texel_of(scene, scene.pieces[parts[i].piece], place))
                    look(scene, *texel, found[i]);
    });
    Portion whole;
    for (const Portion& part : found)
        whole.append(part);
    return whole;
}

void NearbyLight::Portion::append(const Portion& other) {
    for (shared::NearbyRow row : other.rows) {
        row.first_entry += std::uint32_t(entries.size());
        rows.push_back(row);
    }
    entries.insert(entries.end(), other.entries.begin(), other.entries.end());
}

void NearbyLight::update(const NearbyLightScene& scene, std::uint64_t rays) {
    frame_round_ = round_;
    bool ends = false;
    if (round_ == first_light) {
        copies_ = portions_.empty();
        found_ = find(scene, std::max<std::uint64_t>(rays / usual_rays, 1));
        if (portions_.empty() || portions_.back().entries.size() + found_.entries.size() > kept_together)
            portions_.emplace_back();
        portions_.back().append(found_);
        portion_ = &found_;
        ends = next_ == scene.pieces.size();
    } else {
        portion_ = &portions_[next_++];
        ends = next_ == portions_.size();
    }
    round_ += ends;
    next_ = ends ? 0 : next_;
}

Status NearbyLight::add_passes(gpu::FrameGraph& graph, gpu::PipelineStore& pipelines, const Target& target,
                               gpu::FrameResources& resources) const {
    const gpu::Buffer &sums = target.sums, &own = target.own_sums;
    if (copies_)
        graph.add_pass("nearby light, before")
            .read(graph.import_buffer(sums), gpu::Usage::transfer_source)
            .write(graph.import_buffer(own), gpu::Usage::transfer_destination)
            .execute([&sums, &own](gpu::PassContext& context) -> Status {
                const VkBufferCopy all{0, 0, std::min(sums.size(), own.size())};
                context.device.vk.vkCmdCopyBuffer(context.commands, sums.handle(), own.handle(), 1, &all);
                return {};
            });
    if (portion_ == nullptr || portion_->rows.empty())
        return {};
    gpu::ComputeDescription description;
    description.shader =
        frame_round_ == sources ? "gi_module/many_light/nearby_sources.comp" : "gi_module/many_light/nearby_light.comp";
    SUNFLECK_ASSIGN(const gpu::Pipeline* const kernel, pipelines.compute(description));
    SUNFLECK_ASSIGN(const gpu::UploadSlice rows, resources.upload(std::span(portion_->rows)));
    SUNFLECK_ASSIGN(const gpu::UploadSlice entries, resources.upload(std::span(portion_->entries)));
    shared::NearbyLightConstants constants{};
    constants.rows = std::uint32_t(portion_->rows.size());
    constants.row_length = std::min(constants.rows, 1u << 20);
    constants.own_steps = target.own_steps;
    gpu::ComputePass pass(graph, frame_round_ == sources ? "nearby sources" : "nearby light", *kernel);
    pass.storage_read(rows).storage_read(entries);
    if (frame_round_ == first_light)
        pass.texels(sums).storage_read_write(own);
    else if (frame_round_ == second_light)
        pass.texels(own).storage_read_write(sums);
    else
        pass.texels(own).texels(sums).storage_read_write(target.texels);
    pass.push(constants).dispatch(divide_up(constants.row_length, 64), divide_up(constants.rows, constants.row_length));
    return {};
}

} // namespace sunfleck::gi
