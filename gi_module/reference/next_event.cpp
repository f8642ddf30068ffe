// Next-event estimation of the reference path tracer: sampling of emitters, and the weights of scattered rays that hit
// them (E. Veach, 1997, ch. 9).
#include "gi_module/reference/path.h"

#include <algorithm>

namespace sunfleck::gi::reference {

// Emitters of mirrored meshes have their second and third corner swapped.
vec3 textured_emission(const raytrace::RayScene& rays, const Emitter& emitter, const EmittedPoint& point) {
    const bool mirrored = glm::determinant(mat3(emitter.matrix)) < 0.0f;
    return rays.emission_at(emitter.entity, point.triangle, mirrored ? point.v : point.u, mirrored ? point.u : point.v);
}

// A point on an emitter, as a path vertex receives its light.
struct PathTracer::EmitterSample {
    vec3 to_light{0.0f};
    vec3 position{0.0f};  // unless distant
    vec3 light{0.0f};     // radiance or its equivalent, divided by the density
    float density = 0.0f; // per solid angle; 0 for lights that scattered rays cannot hit
    bool distant = false; // directional light or environment
};

PathTracer::Whereabouts PathTracer::find(const Emitter& emitter) {
    Whereabouts result;
    result.power = luminance(emitter.flux);
    result.centre = vec3(emitter.matrix[3]);
    if (emitter.kind == EmitterKind::directional || emitter.kind == EmitterKind::environment) {
        result.distant = true;
        result.power /= pi * emitter.scene_radius * emitter.scene_radius;
    } else if (emitter.kind == EmitterKind::mesh) {
        Bounds bounds;
        for (const vec3 corner : emitter.corners)
            bounds.add(corner);
        result.centre = bounds.centre();
        result.radius2 = 0.25f * glm::dot(bounds.extent(), bounds.extent());
    } else {
        const vec2 half(0.5f * emitter.width, 0.5f * emitter.height);
        result.radius2 = glm::dot(half, half) + emitter.radius * emitter.radius;
    }
    return result;
}

// About the irradiance, were nothing in its way: W/m2.
float PathTracer::importance(const Whereabouts& emitter, vec3 receiver) const {
    if (emitter.distant)
        return emitter.power;
    const vec3 away = emitter.centre - receiver;
    return emitter.power / (pi * std::max(glm::dot(away, away) + emitter.radius2, 1e-30f));
}

float PathTracer::total_importance(vec3 receiver) const {
    float total = 0.0f;
    for (const Whereabouts& emitter : whereabouts_)
        total += importance(emitter, receiver);
    return total;
}

// Half of the choices go by what an emitter may do to the receiver, so that a small lamp beside it is not left to
// chance; half by flux alone, since the near one may be behind a wall.
float PathTracer::chance(std::size_t emitter, vec3 receiver, float total) const {
    const float by_flux = float(double(luminance(emitters_[emitter].flux)) / total_flux_);
    return 0.5f * (by_flux + importance(whereabouts_[emitter], receiver) / total);
}

std::size_t PathTracer::choose_emitter(float number, vec3 receiver, float& probability) const {
    const float total = total_importance(receiver);
    for (std::size_t i = 0;; ++i) {
        probability = chance(i, receiver, total);
        number -= probability;
        if (number < 0.0f || i + 1 == emitters_.size())
            return i;
    }
}

// MIS-weighted radiance of the environment along a scattered ray that hit nothing. pdf: of the ray.
vec3 PathTracer::environment_found(vec3 receiver, vec3 direction, float pdf, bool delta) const {
    vec3 sum(0.0f);
    for (std::size_t i = 0; i < environments_.size(); ++i) {
        const Emitter& emitter = environments_[i];
        float other = 0.0f;
        if (environment_places_[i] != not_sampled && !delta)
            other = chance(environment_places_[i], receiver, total_importance(receiver)) *
                    emitter.map.image->density(emitter.map.to_image(direction));
        sum += emitter.environment_radiance(direction) * (other > 0.0f ? power_heuristic(pdf, other) : 1.0f);
    }
    return sum;
}

// Density, per solid angle, with which direct_light would have sampled the point that a scattered ray has hit.
float PathTracer::emitter_density(vec3 receiver, const raytrace::SurfacePoint& point, vec3 direction) const {
    const auto found = area_emitters_.find(point.entity);
    const float cosine = -glm::dot(point.geometric_normal, direction);
    if (found == area_emitters_.end() || cosine <= 0.0f)
        return 0.0f;
    const vec3 way = point.on_triangle - receiver;
    const float chosen = chance(found->second, receiver, total_importance(receiver));
    return chosen / emitters_[found->second].area * glm::dot(way, way) / cosine;
}

// Point, spot and area kinds. `probability`: of the emitter.
PathTracer::EmitterSample PathTracer::sample_near(const Emitter& emitter, const EmittedPoint& point, float probability,
                                                  vec3 receiver) const {
    EmitterSample sample;
    sample.position = point.position;
    sample.to_light = point.position - receiver;
    const float squared = std::max(glm::dot(sample.to_light, sample.to_light), 1e-30f);
    const vec3 direction = sample.to_light / std::sqrt(squared);
    if (emitter.kind == EmitterKind::point) {
        sample.light = emitter.intensity / (squared * probability);
        return sample;
    }
    if (emitter.kind == EmitterKind::spot) {
        float scale, offset;
        spot_cone(emitter, scale, offset);
        const float falloff = std::clamp(-glm::dot(direction, point.normal) * scale + offset, 0.0f, 1.0f);
        sample.light = emitter.intensity * (falloff * falloff / (squared * probability));
        return sample;
    }
    const float cosine = -glm::dot(direction, point.normal);
    if (cosine <= 0.0f)
        return sample;
    sample.density = probability / emitter.area * squared / cosine;
    const bool textured = emitter.kind == EmitterKind::mesh && emitter.textured;
    sample.light = (textured ? textured_emission(rays_, emitter, point) : emitter.radiance) / sample.density;
    return sample;
}

PathTracer::EmitterSample PathTracer::sample_emitter(Path& path, vec3 receiver) const {
    const float choice = path.random.next(), u = path.random.next(), v = path.random.next();
    EmitterSample sample;
    if (emitters_.empty())
        return sample;
    float probability = 0.0f;
    const Emitter& emitter = emitters_[choose_emitter(choice, receiver, probability)];
    const EmittedPoint point = sample_emitter_point(emitter, u, v);
    if (emitter.kind != EmitterKind::environment && emitter.kind != EmitterKind::directional)
        return sample_near(emitter, point, probability, receiver);
    sample.distant = true;
    if (emitter.kind == EmitterKind::directional) {
        sample.to_light = -2.1f * emitter.scene_radius * point.normal;
        sample.light = emitter.intensity / probability;
        return sample;
    }
    const scene::EnvironmentImage::Draw drawn = emitter.map.image->draw(u, v);
    sample.to_light = 2.1f * emitter.scene_radius * emitter.map.to_world(drawn.direction);
    sample.density = probability * drawn.density;
    sample.light = sample.density > 0.0f ? emitter.map_scale * drawn.radiance / sample.density : vec3(0.0f);
    return sample;
}

vec3 PathTracer::direct_light(Path& path, const Vertex& vertex) const {
    const EmitterSample sample = sample_emitter(path, vertex.position);
    if (luminance(sample.light) <= 0.0f)
        return vec3(0.0f);
    const vec3 direction = glm::normalize(sample.to_light);
    const vec3 incoming = vertex.frame.to_local(direction);
    if (incoming.z <= 0.0f || glm::dot(direction, vertex.geometric_normal) <= 0.0f)
        return vec3(0.0f);
    const vec3 scattered = (path.without_gloss() ? vertex.bsdf.evaluate_diffuse(vertex.outgoing, incoming)
                                                 : vertex.bsdf.evaluate(vertex.outgoing, incoming)) *
                           incoming.z;
    if (luminance(scattered) <= 0.0f)
        return vec3(0.0f);
    ++path.rays;
    const vec3 origin = vertex.position + vertex.offset * vertex.geometric_normal;
    const vec3 way = sample.distant ? sample.to_light : sample.position - origin;
    // Up to the emitter's own surface, as closely as floats know where it is.
    const float left_out = sample.distant ? 0.0f : rays_.ray_offset_anywhere() / glm::length(way);
    if (rays_.occluded(raytrace::Ray{origin, way, 0.0f, 1.0f - std::max(left_out, 0x1p-20f), path.salt}))
        return vec3(0.0f);
    const float weight =
        sample.density > 0.0f ? power_heuristic(sample.density, vertex.bsdf.density(vertex.outgoing, incoming)) : 1.0f;
    return sample.light * scattered * weight;
}

} // namespace sunfleck::gi::reference
