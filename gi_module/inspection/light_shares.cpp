#include "gi_module/inspection/light_shares.h"

#include "gi_module/transport/arrival.h"

namespace sunfleck::gi {
namespace {

constexpr int most_surfaces = 64; // of surfaces that let light through, one behind another
constexpr float far_away = 1e6f;

// True if nothing that casts a shadow in this light stands between.
bool arrives(const PointQuestion& question, const LightSample& sample, vec3 to_light, bool parallel) {
    const vec3 origin = question.point.position + question.point.offset * question.point.geometric_normal;
    vec3 way = to_light;
    if (!parallel) {
        const vec3 above = sample.kind == SampleKind::surface ? sample.normal * question.point.offset : vec3(0.0f);
        way = sample.position + above - origin;
    }
    raytrace::Ray ray{origin, way, 0.0f, 1.0f - 0x1p-18f};
    if (!sample.on_mover)
        return !question.rays.occluded(ray);
    for (int layer = 0; layer < most_surfaces; ++layer) {
        const auto hit = question.rays.closest_hit(ray);
        if (!hit)
            return true;
        const raytrace::SurfacePoint surface = question.rays.surface(ray, *hit);
        if (surface.casts_shadow && surface.entity != sample.emitter)
            return false;
        ray.minimum = hit->distance + 2.0f * surface.offset / glm::length(way);
    }
    return true;
}

LightShare share_of(const PointQuestion& question, std::uint32_t index) {
    const LightSample& sample = question.samples.samples()[index];
    LightShare share;
    share.sample = index;
    share.emitter = sample.emitter;
    share.bounce = sample.bounce;
    share.parallel = sample.kind == SampleKind::directional;
    share.position = share.parallel ? sample.normal : sample.position;
    const Arrival light =
        arrival(question.samples.rows()[index], light_class(sample.kind), question.point.position, far_away);
    const float facing = glm::dot(light.to_light, question.point.geometric_normal);
    const float cosine = glm::dot(light.to_light, question.point.normal);
    if (facing <= 0.0f || cosine <= 0.0f)
        return share;
    const shared::LightRow& row = question.samples.rows()[index];
    if (sample.kind == SampleKind::surface) {
        // The kernels bound the whole geometry term, with both cosines.
        const float squared = std::max(glm::dot(light.to_light, light.to_light), 1e-12f);
        const float along = std::max(-glm::dot(sample.normal, light.to_light), 0.0f);
        share.unshadowed =
            vec3(row.intensity_slot) * std::min(along * cosine / (squared * squared), row.position_bound.w);
    } else {
        share.unshadowed = light.irradiance * (cosine / glm::length(light.to_light));
    }
    const bool any = glm::dot(share.unshadowed, share.unshadowed) > 0.0f;
    if (any && (!question.shadows || arrives(question, sample, light.to_light, share.parallel)))
        share.irradiance = share.unshadowed;
    return share;
}

bool owns(CellSet cells, const LightSample& sample, bool on_mover) {
    return cells[LightCell{path_part(sample.bounce, sample.punctual), sample.dynamic, on_mover, false}.index()];
}

} // namespace

ReceiverPoint ReceiverPoint::of(const raytrace::SurfacePoint& surface, vec3 towards, bool on_mover) {
    const float side = glm::dot(surface.geometric_normal, towards) < 0.0f ? 1.0f : -1.0f;
    return {surface.on_triangle, side * surface.shading_normal, side * surface.geometric_normal, surface.offset,
            on_mover};
}

std::vector<LightShare> sample_shares(const PointQuestion& question) {
    std::vector<LightShare> result;
    for (std::uint32_t i = 0; i < question.samples.size(); ++i) {
        if (!owns(question.cells, question.samples.samples()[i], question.point.on_mover))
            continue;
        const LightShare share = share_of(question, i);
        if (share.unshadowed != vec3(0.0f))
            result.push_back(share);
    }
    return result;
}

vec3 ExplainedLight::sum() const {
    vec3 result(0.0f);
    for (const LightShare& share : shares)
        result += share.irradiance;
    return result;
}

} // namespace sunfleck::gi
