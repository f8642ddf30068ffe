#include "viewer/pixel_report.h"

namespace sunfleck::viewer {

vec3 PixelReport::irradiance() const {
    vec3 sum(0.0f);
    for (const gi::ExplainedLight& part : light)
        sum += part.sum();
    return sum;
}

std::vector<PixelReport::Value> PixelReport::material_values() const {
    std::vector<Value> values;
    const std::vector<Field>& fields = scene::Material::description().fields;
    values.reserve(fields.size());
    for (const Field& field : fields)
        values.push_back({std::string(field.name), field_to_text(field, &material), std::string(field.unit)});
    return values;
}

namespace {

void find_samples(gi::System& lighting, const gi::ReceiverPoint& point, PixelReport& report) {
    const gi::VisibilityDatabase& database = lighting.visibility();
    const auto count = std::uint32_t(lighting.samples().size());
    report.samples.resize(count);
    for (std::uint32_t i = 0; i < count; ++i)
        report.samples[i].map = lighting.shadows().state(lighting.sample_set(), i);
    if (database.sample_count() != count)
        return;
    const std::uint32_t node = report.moves
                                   ? database.mover_node(report.entity)
                                   : database.patches().node_at(report.entity, point.position, point.geometric_normal);
    if (node >= database.node_count())
        return;
    report.patch = PixelReport::Patch();
    report.patch->node = node;
    if (node < database.patches().nodes().size())
        report.patch->level = database.patches().nodes()[node].level;
    for (std::uint32_t i = 0; i < count; ++i) {
        SampleState& sample = report.samples[i];
        sample.between = database.state(node, i);
        sample.blockers = database.blockers(node, i);
        ++report.patch->samples.of(sample.between);
    }
}

struct Seen {
    raytrace::SurfacePoint surface;
    gi::ReceiverPoint point;
    float distance = 0.0f; // along the ray, in the space that is lit
    bool moves = false;
};

// What is invisible from behind lets the eye through, as in the picture.
std::optional<Seen> first_surface(SceneRenderer& renderer, vec3 origin, vec3 direction) {
    const raytrace::RayScene& rays = renderer.rays();
    raytrace::Ray ray{renderer.space().point(origin), glm::normalize(direction)};
    constexpr int most_layers = 64;
    for (int layer = 0; layer < most_layers; ++layer) {
        const auto hit = rays.closest_hit(ray);
        if (!hit)
            return std::nullopt;
        const raytrace::SurfacePoint surface = rays.surface(ray, *hit);
        const bool front = glm::dot(surface.geometric_normal, ray.direction) < 0.0f;
        if (front || surface.material.double_sided) {
            const bool moves = !scene::is_static(renderer.registry(), surface.entity);
            return Seen{surface, gi::ReceiverPoint::of(surface, ray.direction, moves), hit->distance, moves};
        }
        ray.minimum = hit->distance + 2.0f * surface.offset;
    }
    return std::nullopt;
}

} // namespace

std::optional<gi::ListedPlace> place_in_view(SceneRenderer& renderer, vec3 origin, vec3 direction) {
    const std::optional<Seen> seen = first_surface(renderer, origin, direction);
    return seen ? std::optional(gi::ListedPlace{seen->surface.entity, seen->point}) : std::nullopt;
}

PixelReport report_pixel(SceneRenderer& renderer, vec3 origin, vec3 direction) {
    const scene::SceneSpace& space = renderer.space();
    PixelReport report;
    const std::optional<Seen> seen = first_surface(renderer, origin, direction);
    if (!seen)
        return report;
    report.moves = seen->moves;
    report.entity = seen->surface.entity;
    report.position = seen->point.position * space.unit + space.origin;
    report.normal = seen->point.normal;
    report.geometric_normal = seen->point.geometric_normal;
    report.distance = seen->distance * space.unit;
    report.material = seen->surface.material;
    report.light = renderer.lighting().explain(seen->point, renderer.rays());
    find_samples(renderer.lighting(), seen->point, report);
    for (gi::ExplainedLight& part : report.light)
        for (gi::LightShare& share : part.shares)
            if (!share.parallel)
                share.position = share.position * space.unit + space.origin;
    return report;
}

} // namespace sunfleck::viewer
