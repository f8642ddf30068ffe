#include "gi_module/reference/path_tracer.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"
#include "gi_module/reference/bsdf.h"

#include <algorithm>
#include <atomic>

namespace sunfleck::gi::reference {
namespace {

constexpr float offset_distance = 1e-4f;           // m, off a surface before the next ray starts
constexpr float shadow_shortening = 1e-4f;         // share of a shadow ray's length left out before its end
constexpr std::uint32_t roulette_start = 4;        // bounces before paths end by chance
constexpr std::uint32_t dimensions_per_vertex = 8; // two groups of four: light, scattering

float power_heuristic(float a, float b) {
    const float a2 = a * a, b2 = b * b;
    return a2 + b2 > 0.0f ? a2 / (a2 + b2) : 0.0f;
}

struct Frame {
    explicit Frame(vec3 n) : normal(n) { orthonormal_basis(n, tangent, bitangent); }
    vec3 to_local(vec3 v) const { return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)}; }
    vec3 to_world(vec3 v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
    vec3 tangent, bitangent, normal;
};

// Emitters of mirrored meshes have their corners turned round.
vec3 textured_emission(const raytrace::RayScene& rays, const Emitter& emitter, const EmittedPoint& point) {
    const bool mirrored = glm::determinant(mat3(emitter.matrix)) < 0.0f;
    return rays.emission_at(emitter.entity, point.triangle, mirrored ? point.v : point.u, mirrored ? point.u : point.v);
}

} // namespace

// A surface that the path scatters at, seen from the side it came from.
struct PathTracer::Vertex {
    vec3 position;
    vec3 geometric_normal;
    Frame frame;   // of the shading normal
    vec3 outgoing; // local
    Bsdf bsdf;
    bool entering = true; // glass: the path comes from outside
};

struct PathTracer::Path {
    RandomSequence random;
    std::uint32_t bounces;  // reflections still allowed after the first vertex
    std::uint32_t salt = 0; // of its rays
    vec3 throughput{1.0f};
    std::vector<vec3>* by_bounce = nullptr; // contributions are added here, by reflections, if set
    bool skip_direct = false;
    bool skip_indirect = false;
    vec3 result{0.0f};
    std::uint64_t rays = 0;

    void add(std::uint32_t reflections, vec3 light) {
        if ((reflections == 0 && skip_direct) || (reflections > 0 && skip_indirect))
            return;
        result += light;
        if (by_bounce != nullptr)
            (*by_bounce)[reflections] += light;
    }
};

PathTracer::PathTracer(const raytrace::RayScene& rays, std::vector<Emitter> emitters) : rays_(rays) {
    double total = 0;
    for (Emitter& emitter : emitters) {
        if (emitter.kind == EmitterKind::environment) {
            environments_.push_back(emitter); // without a picture, found by scattered rays alone
            if (!emitter.map.image)
                continue;
        }
        cumulative_.push_back(total += double(luminance(emitter.flux)));
        if (!emitter.is_delta() && emitter.kind != EmitterKind::environment)
            area_emitters_[emitter.entity] = emitters_.size();
        emitters_.push_back(std::move(emitter));
    }
}

vec3 PathTracer::environment(vec3 direction) const {
    vec3 sum(0.0f);
    for (const Emitter& emitter : environments_)
        sum += emitter.environment_radiance(direction);
    return sum;
}

// What a scattered ray finds that hits nothing, weighted against direct_light's way of finding it. pdf: of the ray.
vec3 PathTracer::environment_found(vec3 direction, float pdf, bool delta) const {
    vec3 sum(0.0f);
    for (const Emitter& emitter : environments_) {
        float other = 0.0f;
        if (emitter.map.image && !delta)
            other = float(double(luminance(emitter.flux)) / cumulative_.back()) *
                    emitter.map.image->density(emitter.map.to_image(direction));
        sum += emitter.environment_radiance(direction) * (other > 0.0f ? power_heuristic(pdf, other) : 1.0f);
    }
    return sum;
}

vec3 PathTracer::emitted(const raytrace::SurfacePoint& point, vec3 direction) const {
    return glm::dot(point.geometric_normal, direction) < 0.0f ? point.material.emission : vec3(0.0f);
}

// Density, per solid angle, with which direct_light would have picked the point that a scattered ray has hit.
float PathTracer::emitter_density(const raytrace::SurfacePoint& point, vec3 direction, float distance) const {
    const auto found = area_emitters_.find(point.entity);
    const float cosine = -glm::dot(point.geometric_normal, direction);
    if (found == area_emitters_.end() || cosine <= 0.0f)
        return 0.0f;
    const Emitter& emitter = emitters_[found->second];
    const float chosen = float(double(luminance(emitter.flux)) / cumulative_.back());
    return chosen / emitter.area * distance * distance / cosine;
}

vec3 PathTracer::direct_light(Path& path, const Vertex& vertex) const {
    const float choice = path.random.next(), u = path.random.next(), v = path.random.next();
    if (emitters_.empty())
        return vec3(0.0f);
    const double target = double(choice) * cumulative_.back();
    const std::size_t index = std::min<std::size_t>(
        std::size_t(std::upper_bound(cumulative_.begin(), cumulative_.end(), target) - cumulative_.begin()),
        emitters_.size() - 1);
    const Emitter& emitter = emitters_[index];
    const float probability = float(double(luminance(emitter.flux)) / cumulative_.back());
    const EmittedPoint point = sample_emitter_point(emitter, u, v);
    vec3 to_light = point.position - vertex.position;
    vec3 light(0.0f);     // radiance or its like, already over the density
    float density = 0.0f; // per solid angle, 0 for lights that scattering cannot hit
    if (emitter.kind == EmitterKind::environment) {
        const scene::EnvironmentImage::Draw drawn = emitter.map.image->draw(u, v);
        to_light = 2.1f * emitter.scene_radius * emitter.map.to_world(drawn.direction);
        density = probability * drawn.density;
        light = density > 0.0f ? emitter.map_scale * drawn.radiance / density : vec3(0.0f);
    } else if (emitter.kind == EmitterKind::directional) {
        to_light = -2.1f * emitter.scene_radius * point.normal;
        light = emitter.intensity / probability;
    } else {
        const float squared = std::max(glm::dot(to_light, to_light), 1e-12f);
        const vec3 direction = to_light / std::sqrt(squared);
        if (emitter.kind == EmitterKind::point) {
            light = emitter.intensity / (squared * probability);
        } else if (emitter.kind == EmitterKind::spot) {
            float scale, offset;
            spot_cone(emitter, scale, offset);
            const float falloff = std::clamp(-glm::dot(direction, point.normal) * scale + offset, 0.0f, 1.0f);
            light = emitter.intensity * (falloff * falloff / (squared * probability));
        } else {
            const float cosine = -glm::dot(direction, point.normal);
            if (cosine <= 0.0f)
                return vec3(0.0f);
            density = probability / emitter.area * squared / cosine;
            const bool textured = emitter.kind == EmitterKind::mesh && emitter.textured;
            light = (textured ? textured_emission(rays_, emitter, point) : emitter.radiance) / density;
        }
    }
    const vec3 direction = glm::normalize(to_light);
    const vec3 incoming = vertex.frame.to_local(direction);
    if (incoming.z <= 0.0f || glm::dot(direction, vertex.geometric_normal) <= 0.0f || luminance(light) <= 0.0f)
        return vec3(0.0f);
    const vec3 scattered = vertex.bsdf.evaluate(vertex.outgoing, incoming) * incoming.z;
    if (luminance(scattered) <= 0.0f)
        return vec3(0.0f);
    ++path.rays;
    const vec3 origin = vertex.position + offset_distance * vertex.geometric_normal;
    const bool far = emitter.kind == EmitterKind::directional || emitter.kind == EmitterKind::environment;
    const vec3 target_point = far ? origin + to_light : point.position;
    if (rays_.occluded(raytrace::Ray{origin, target_point - origin, 0.0f, 1.0f - shadow_shortening, path.salt}))
        return vec3(0.0f);
    const float weight =
        density > 0.0f ? power_heuristic(density, vertex.bsdf.density(vertex.outgoing, incoming)) : 1.0f;
    return light * scattered * weight;
}

void PathTracer::trace(Path& path, Vertex vertex) const {
    // `reflections`: how often the light found at the next ray's end will have been reflected before the first vertex.
    for (std::uint32_t reflections = 0;; ++reflections) {
        path.random.seek(8 + reflections * dimensions_per_vertex);
        BsdfSample scattered;
        if (vertex.bsdf.is_glass()) {
            path.random.seek(8 + reflections * dimensions_per_vertex + 4);
            scattered = vertex.bsdf.sample_glass(vertex.outgoing, vertex.entering, path.random.next());
        } else {
            path.add(reflections, path.throughput * direct_light(path, vertex));
            path.random.seek(8 + reflections * dimensions_per_vertex + 4);
            const float numbers[3] = {path.random.next(), path.random.next(), path.random.next()};
            if (!vertex.bsdf.sample(vertex.outgoing, numbers, scattered))
                return;
        }
        const vec3 direction = vertex.frame.to_world(scattered.direction);
        const float side = glm::dot(direction, vertex.geometric_normal);
        if (!vertex.bsdf.is_glass() && side <= 0.0f)
            return;
        path.throughput *= scattered.weight;

        const vec3 origin =
            vertex.position + (side > 0.0f ? offset_distance : -offset_distance) * vertex.geometric_normal;
        const raytrace::Ray ray{origin, direction, 0.0f, 1e30f, path.salt};
        ++path.rays;
        const auto hit = rays_.closest_hit(ray);
        if (!hit) {
            path.add(reflections, path.throughput * environment_found(direction, scattered.pdf, scattered.delta));
            return;
        }
        const raytrace::SurfacePoint point = rays_.surface(ray, *hit);
        const vec3 emission = emitted(point, direction);
        if (luminance(emission) > 0.0f) {
            const float other = scattered.delta ? 0.0f : emitter_density(point, direction, hit->distance);
            path.add(reflections,
                     path.throughput * emission * (scattered.delta ? 1.0f : power_heuristic(scattered.pdf, other)));
        }
        if (reflections >= path.bounces)
            return;
        if (reflections >= roulette_start) {
            const float survive =
                std::clamp(std::max({path.throughput.x, path.throughput.y, path.throughput.z}), 0.05f, 0.98f);
            if (path.random.next() >= survive)
                return;
            path.throughput /= survive;
        }
        const bool front = glm::dot(point.geometric_normal, direction) < 0.0f;
        const Frame frame(front ? point.shading_normal : -point.shading_normal);
        vertex = Vertex{point.position,
                        front ? point.geometric_normal : -point.geometric_normal,
                        frame,
                        frame.to_local(-direction),
                        Bsdf(point.material),
                        front};
        // A shading normal that leans away from the viewer would make the surface vanish.
        vertex.outgoing.z = std::max(vertex.outgoing.z, 1e-4f);
    }
}

namespace {

// What the camera sees along the ray: single-sided surfaces not from behind.
std::optional<raytrace::SurfacePoint> visible_surface(const raytrace::RayScene& rays, raytrace::Ray ray,
                                                      std::uint64_t& count) {
    constexpr int max_layers = 64;
    for (int layer = 0; layer < max_layers; ++layer) {
        ++count;
        const auto hit = rays.closest_hit(ray);
        if (!hit)
            return std::nullopt;
        const raytrace::SurfacePoint point = rays.surface(ray, *hit);
        if (point.material.double_sided || glm::dot(point.geometric_normal, ray.direction) < 0.0f)
            return point;
        ray.origin = point.position + offset_distance * ray.direction;
    }
    return std::nullopt;
}

} // namespace

vec3 PathTracer::pixel_sample(std::uint32_t x, std::uint32_t y, std::uint32_t sample, const shared::CameraRow& camera,
                              const ReferenceSettings& settings, std::uint64_t& rays, std::uint8_t& covered) const {
    const std::uint32_t pixel_seed = hash_combine(settings.seed, y * 65536u + x);
    Path path{RandomSequence(SequenceKind::sobol, pixel_seed, sample), settings.bounces, sample};
    vec2 centre(float(x) + 0.5f, float(y) + 0.5f);
    if (settings.antialiasing)
        centre += vec2(path.random.at(0), path.random.at(1)) - 0.5f;
    const raytrace::Ray ray{vec3(camera.position), glm::normalize(shared::camera_ray(camera, centre)), 0.0f, 1e30f,
                            sample};
    const auto found = visible_surface(rays_, ray, rays);
    const bool radiance = settings.view == ReferenceView::radiance;
    if (!found) {
        covered = 0;
        return radiance ? environment(ray.direction) : vec3(0.0f);
    }
    const raytrace::SurfacePoint& point = *found;
    const auto emitter = area_emitters_.find(point.entity);
    covered = emitter != area_emitters_.end() && emitters_[emitter->second].is_lamp ? 0 : 1;
    if (!radiance && covered == 0)
        return vec3(0.0f);
    const bool front = glm::dot(point.geometric_normal, ray.direction) < 0.0f;
    const Frame frame(front ? point.shading_normal : -point.shading_normal);
    vec3 outgoing = frame.to_local(-ray.direction);
    outgoing.z = std::max(outgoing.z, 1e-4f);
    path.skip_direct = settings.view == ReferenceView::indirect;
    path.skip_indirect = settings.view == ReferenceView::direct;
    if (path.skip_indirect)
        path.bounces = 0;
    trace(path, {point.position, front ? point.geometric_normal : -point.geometric_normal, frame, outgoing,
                 radiance ? Bsdf(point.material) : Bsdf::white(), front});
    rays += path.rays;
    // A white Lambertian surface reflects irradiance / pi.
    return radiance ? path.result + emitted(point, ray.direction) : path.result * pi;
}

bool PathTracer::accumulate(Accumulation& accumulation, const scene::CameraView& camera,
                            const ReferenceSettings& settings, std::uint32_t count,
                            const std::function<bool()>& cancelled) const {
    const shared::CameraRow row = scene::make_camera_row(camera, settings.width, settings.height);
    const std::size_t pixels = std::size_t(settings.width) * settings.height;
    if (accumulation.sums.empty()) {
        accumulation.width = settings.width;
        accumulation.height = settings.height;
        accumulation.sums.assign(pixels * 3, 0.0);
        accumulation.covered.assign(pixels, 0);
    }
    std::vector<vec3> added(pixels);
    std::vector<double> sums(accumulation.sums);
    std::vector<std::uint8_t> covered(pixels);
    std::atomic<std::uint64_t> rays{0};
    std::atomic<bool> stop{false};
    parallel_for_chunks(pixels, 256, [&](std::size_t begin, std::size_t end) {
        std::uint64_t chunk_rays = 0;
        for (std::size_t i = begin; i < end && !stop; ++i) {
            // Sample by sample in double precision: the same sums however the samples are split over calls.
            for (std::uint32_t s = 0; s < count; ++s) {
                const vec3 value = pixel_sample(std::uint32_t(i % settings.width), std::uint32_t(i / settings.width),
                                                accumulation.samples + s, row, settings, chunk_rays, covered[i]);
                for (int c = 0; c < 3; ++c)
                    sums[i * 3 + std::size_t(c)] += double(value[c]);
            }
        }
        rays += chunk_rays;
        if (cancelled && cancelled())
            stop = true;
    });
    if (stop)
        return false;
    accumulation.sums = std::move(sums);
    accumulation.covered = std::move(covered);
    accumulation.samples += count;
    accumulation.rays += rays;
    return true;
}

std::vector<vec3> PathTracer::irradiance_by_bounce(vec3 position, vec3 normal, std::uint32_t bounces,
                                                   std::uint32_t samples, std::uint32_t seed) const {
    std::vector<vec3> sums(bounces + 1, vec3(0.0f));
    for (std::uint32_t s = 0; s < samples; ++s) {
        Path path{RandomSequence(SequenceKind::sobol, seed, s), bounces, s};
        path.by_bounce = &sums;
        trace(path, {position, normal, Frame(normal), vec3(0.0f, 0.0f, 1.0f), Bsdf::white(), true});
    }
    for (vec3& sum : sums)
        sum *= pi / float(samples);
    return sums;
}

} // namespace sunfleck::gi::reference
