#include "gi_module/reference/path_tracer.h"

#include "engine/core/jobs.h"
#include "gi_module/reference/path.h"

#include <algorithm>
#include <atomic>

namespace sunfleck::gi::reference {
namespace {

constexpr std::uint32_t roulette_start = 4;        // bounces before Russian roulette
constexpr std::uint32_t dimensions_per_vertex = 8; // light: 3, kind of surface: 1, scattering: 3, roulette: 1

std::uint32_t first_dimension(std::uint32_t reflections) {
    return 8 + reflections * dimensions_per_vertex;
}

// Of a vertex after so many reflections.
Bsdf bsdf_at(const raytrace::SurfacePoint& point, const RandomSequence& random, std::uint32_t reflections) {
    return Bsdf(point.material, random.at(first_dimension(reflections) + 3));
}

} // namespace

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
        ray.origin = point.on_triangle - point.offset * point.geometric_normal; // it is seen from behind
    }
    return std::nullopt;
}

PathTracer::PathTracer(const raytrace::RayScene& rays, std::vector<Emitter> emitters, std::vector<Emitter> backgrounds)
    : rays_(rays), backgrounds_(std::move(backgrounds)) {
    for (Emitter& emitter : emitters) {
        if (emitter.kind == EmitterKind::environment) {
            environments_.push_back(emitter); // without an image: found by scattered rays only
            environment_places_.push_back(emitter.map.image ? emitters_.size() : not_sampled);
            if (!emitter.map.image)
                continue;
        }
        if (!emitter.is_delta() && emitter.kind != EmitterKind::environment)
            area_emitters_[emitter.entity] = emitters_.size();
        whereabouts_.push_back(find(emitter));
        total_flux_ += double(luminance(emitter.flux));
        emitters_.push_back(std::move(emitter));
    }
}

// As the camera sees it.
vec3 PathTracer::environment(vec3 direction) const {
    vec3 sum(0.0f);
    for (const std::vector<Emitter>* list : {&environments_, &backgrounds_})
        for (const Emitter& emitter : *list)
            sum += emitter.environment_radiance(direction);
    return sum;
}

// Scatters the path at the vertex; false if it ends.
bool PathTracer::scatter(Path& path, const Vertex& vertex, std::uint32_t reflections, BsdfSample& scattered) const {
    const std::uint32_t dimension = first_dimension(reflections);
    path.random.seek(dimension);
    if (vertex.bsdf.is_glass()) {
        path.random.seek(dimension + 4);
        scattered = vertex.bsdf.sample_glass(vertex.outgoing, vertex.entering, path.random.next());
        return true;
    }
    path.add(reflections, path.throughput * direct_light(path, vertex));
    path.random.seek(dimension + 4);
    const float numbers[3] = {path.random.next(), path.random.next(), path.random.next()};
    return vertex.bsdf.sample(vertex.outgoing, numbers, scattered);
}

// Russian roulette; false if the path ends.
bool PathTracer::survives(Path& path) const {
    const float survive = std::clamp(std::max({path.throughput.x, path.throughput.y, path.throughput.z}), 0.05f, 0.98f);
    if (path.random.next() >= survive)
        return false;
    path.throughput /= survive;
    return true;
}

// The surface that a scattered ray reaches; adds what it finds of emitters. Light passes what casts no shadow.
std::optional<raytrace::SurfacePoint> PathTracer::follow(Path& path, const Vertex& vertex, std::uint32_t reflections,
                                                         raytrace::Ray ray, const BsdfSample& scattered) const {
    constexpr int max_layers = 64;
    for (int layer = 0; layer < max_layers; ++layer) {
        ++path.rays;
        const auto hit = rays_.closest_hit(ray);
        if (!hit) {
            path.add(reflections, path.to_emitters * environment_found(vertex.position, ray.direction, scattered.pdf,
                                                                       scattered.delta));
            return std::nullopt;
        }
        raytrace::SurfacePoint point = rays_.surface(ray, *hit);
        const vec3 emission = emitted(point, ray.direction);
        if (luminance(emission) > 0.0f) {
            const float other = scattered.delta ? 0.0f : emitter_density(vertex.position, point, ray.direction);
            path.add(reflections,
                     path.to_emitters * emission * (scattered.delta ? 1.0f : power_heuristic(scattered.pdf, other)));
        }
        if (point.casts_shadow)
            return point;
        const float side = glm::dot(point.geometric_normal, ray.direction) < 0.0f ? -1.0f : 1.0f;
        ray.origin = point.on_triangle + side * point.offset * point.geometric_normal;
    }
    return std::nullopt;
}

// Of a scattered ray, should it find an emitter.
vec3 PathTracer::weight_for_emitters(const Path& path, const Vertex& vertex, const BsdfSample& scattered) {
    if (!path.without_gloss())
        return scattered.weight;
    if (scattered.delta)
        return vec3(0.0f);
    return vertex.bsdf.evaluate_diffuse(vertex.outgoing, scattered.direction) * (scattered.direction.z / scattered.pdf);
}

void PathTracer::trace(Path& path, Vertex vertex) const {
    // `reflections`: how often light found at the end of the next ray is reflected before it reaches the first vertex.
    for (std::uint32_t reflections = 0;; ++reflections) {
        BsdfSample scattered;
        if (!scatter(path, vertex, reflections, scattered))
            return;
        const vec3 direction = vertex.frame.to_world(scattered.direction);
        const float side = glm::dot(direction, vertex.geometric_normal);
        if (!vertex.bsdf.is_glass() && side <= 0.0f)
            return;
        path.scatter(scattered.weight, weight_for_emitters(path, vertex, scattered), scattered.diffuse);
        const vec3 origin = vertex.position + (side > 0.0f ? vertex.offset : -vertex.offset) * vertex.geometric_normal;
        const auto point = follow(path, vertex, reflections, {origin, direction, 0.0f, 1e30f, path.salt}, scattered);
        if (!point)
            return;
        if (reflections >= path.bounces || (reflections >= roulette_start && !survives(path)))
            return;
        vertex = Vertex::at(*point, direction, bsdf_at(*point, path.random, reflections + 1));
    }
}

PathTracer::PixelSample PathTracer::pixel_sample(glm::uvec2 pixel, std::uint32_t sample,
                                                 const shared::CameraRow& camera,
                                                 const ReferenceSettings& settings) const {
    const std::uint32_t pixel_seed = hash_combine(settings.seed, pixel.y * 65536u + pixel.x);
    Path path{RandomSequence(SequenceKind::sobol, pixel_seed, sample), settings.bounces, sample};
    vec2 centre(float(pixel.x) + 0.5f, float(pixel.y) + 0.5f);
    if (settings.antialiasing)
        centre += vec2(path.random.at(0), path.random.at(1)) - 0.5f;
    const raytrace::Ray ray{vec3(camera.position), glm::normalize(shared::camera_ray(camera, centre)), 0.0f, 1e30f,
                            sample};
    PixelSample result;
    const auto found = visible_surface(rays_, ray, result.rays);
    const bool radiance = settings.view == ReferenceView::radiance;
    if (!found) {
        result.value = radiance ? environment(ray.direction) : vec3(0.0f);
        return result;
    }
    const auto emitter = area_emitters_.find(found->entity);
    result.covered = emitter == area_emitters_.end() || !emitters_[emitter->second].is_lamp;
    if (!radiance && !result.covered)
        return result;
    path.caustics = settings.caustics;
    path.skip_direct = settings.view == ReferenceView::indirect;
    path.skip_indirect = settings.view == ReferenceView::direct;
    if (path.skip_indirect)
        path.bounces = 0;
    trace(path, Vertex::at(*found, ray.direction, radiance ? bsdf_at(*found, path.random, 0) : Bsdf::white()));
    result.rays += path.rays;
    // A white Lambertian surface reflects irradiance / pi.
    result.value = radiance ? path.result + emitted(*found, ray.direction) : path.result * pi;
    return result;
}

void start(Accumulation& accumulation, const ReferenceSettings& settings) {
    const std::size_t pixels = std::size_t(settings.width) * settings.height;
    accumulation.width = settings.width;
    accumulation.height = settings.height;
    accumulation.sums.assign(pixels * 3, 0.0);
    accumulation.counts.assign(pixels, 0);
    accumulation.covered.assign(pixels, 0);
}

// Sample by sample in double precision: the same sums however the samples are split over calls.
std::uint64_t PathTracer::add_samples(Accumulation& accumulation, std::size_t pixel, std::uint32_t until,
                                      const shared::CameraRow& camera, const ReferenceSettings& settings) const {
    const glm::uvec2 place(pixel % settings.width, pixel / settings.width);
    std::uint64_t rays = 0;
    for (std::uint32_t& count = accumulation.counts[pixel]; count < until; ++count) {
        const PixelSample sample = pixel_sample(place, count, camera, settings);
        for (int c = 0; c < 3; ++c)
            accumulation.sums[pixel * 3 + std::size_t(c)] += double(sample.value[c]);
        accumulation.covered[pixel] = sample.covered ? 1 : 0;
        rays += sample.rays;
    }
    return rays;
}

bool PathTracer::accumulate(Accumulation& accumulation, const scene::CameraView& camera,
                            const ReferenceSettings& settings, std::uint32_t count,
                            const std::function<bool()>& cancelled) const {
    const shared::CameraRow row = scene::make_camera_row(camera, settings.width, settings.height);
    if (accumulation.sums.empty())
        start(accumulation, settings);
    const std::size_t pixels = std::size_t(settings.width) * settings.height;
    const std::uint32_t until = accumulation.samples + count;
    std::atomic<std::uint64_t> rays{0};
    std::atomic<bool> stop{false};
    parallel_for_chunks(pixels, 256, [&](std::size_t begin, std::size_t end) {
        std::uint64_t chunk_rays = 0;
        for (std::size_t i = begin; i < end && !stop; ++i) {
            if (accumulation.counts[i] >= until)
                continue;
            chunk_rays += add_samples(accumulation, i, until, row, settings);
            if (cancelled && cancelled())
                stop = true;
        }
        rays += chunk_rays;
    });
    accumulation.rays += rays;
    const std::vector<std::uint32_t>& counts = accumulation.counts;
    if (stop && *std::min_element(counts.begin(), counts.end()) < until)
        return false;
    accumulation.samples = until;
    return true;
}

std::vector<vec3> PathTracer::irradiance_by_bounce(vec3 position, vec3 normal, std::uint32_t bounces,
                                                   std::uint32_t samples, std::uint32_t seed) const {
    std::vector<vec3> sums(bounces + 1, vec3(0.0f));
    for (std::uint32_t s = 0; s < samples; ++s) {
        Path path{RandomSequence(SequenceKind::sobol, seed, s), bounces, s};
        path.by_bounce = &sums;
        trace(path, {position, rays_.ray_offset_anywhere(), normal, Frame(normal), vec3(0.0f, 0.0f, 1.0f),
                     Bsdf::white(), true});
    }
    for (vec3& sum : sums)
        sum *= pi / float(samples);
    return sums;
}

} // namespace sunfleck::gi::reference
