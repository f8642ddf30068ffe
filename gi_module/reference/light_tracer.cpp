#include "gi_module/reference/light_tracer.h"

#include "engine/core/divide_up.h"
#include "engine/core/jobs.h"
#include "gi_module/reference/path.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi::reference {
namespace {

// Numbers of a particle: where it leaves its emitter takes the first four, which are stratified together.
constexpr std::uint32_t emitter_dimension = 4;
constexpr std::uint32_t first_vertex_dimension = 8; // kind of surface: 1, scattering: 3, roulette: 1
constexpr std::uint32_t dimensions_of_vertex = 8;
constexpr std::uint32_t scatterings_before_roulette = 4; // as of the path tracer

constexpr std::size_t chunk_particles = 1024;
constexpr std::size_t group_particles = 64 * chunk_particles; // some 0.1 s on a core

// What a particle's flux is multiplied with where it is scattered: the adjoint of what the path tracer does to
// radiance. Shading normals make the two differ (Veach, 1997, sec. 5.3, eq. 5.19), and refraction does (sec. 5.2):
// where the path tracer leaves out that radiance grows with the squared index, flux must shrink by it, so that the two
// estimate the same; through closed glass both factors cancel.
struct Scattered {
    vec3 direction{0.0f};
    vec3 weight{0.0f};
};

std::optional<Scattered> scatter_at_glass(const Vertex& vertex, vec3 to_light, float number) {
    const BsdfSample sample = vertex.bsdf.sample_glass(vertex.outgoing, vertex.entering, number);
    const vec3 direction = vertex.frame.to_world(sample.direction);
    const float leaving = glm::dot(direction, vertex.geometric_normal);
    const float arriving = glm::dot(to_light, vertex.geometric_normal);
    if (leaving * sample.direction.z <= 0.0f) // by the shading normal it passes, by the triangle it doesn't
        return std::nullopt;
    const float shading = std::abs(vertex.outgoing.z / sample.direction.z);
    return Scattered{direction, sample.weight * (std::abs(leaving) / arriving * shading / sample.index_ratio2)};
}

// Diffuse light is distributed by the triangle's normal, about which flux has a cosine; gloss by the shading normal.
std::optional<Scattered> scatter_at_opaque(const Vertex& vertex, vec3 to_light, const float numbers[3]) {
    BsdfSample sample;
    if (!vertex.bsdf.sample(vertex.outgoing, numbers, sample))
        return std::nullopt;
    const vec3 direction = sample.diffuse ? sample_cosine_direction(vertex.geometric_normal, numbers[0], numbers[1])
                                          : vertex.frame.to_world(sample.direction);
    const float leaving = glm::dot(direction, vertex.geometric_normal);
    const float arriving = glm::dot(to_light, vertex.geometric_normal);
    const vec3 local = vertex.frame.to_local(direction);
    const float diffuse = 1.0f - vertex.bsdf.microfacet_probability(vertex.outgoing);
    const float density = vertex.bsdf.density(vertex.outgoing, local) +
                          std::max(diffuse, 0.0f) * (leaving - std::max(local.z, 0.0f)) / pi;
    if (leaving <= 0.0f || !(density > 0.0f))
        return std::nullopt;
    const vec3 reflected = vertex.bsdf.evaluate(visible(local), vertex.outgoing);
    return Scattered{direction, reflected * (vertex.outgoing.z / arriving * leaving / density)};
}

} // namespace

struct LightTracer::Particle {
    RandomSequence random;
    std::uint32_t salt = 0; // of its rays
    vec3 flux{0.0f};        // W, that it would carry were it the only one
    raytrace::Ray ray;
    vec3 throughput{1.0f};
    std::uint32_t scatterings = 0;

    void seek(std::uint32_t number) {
        random.seek(first_vertex_dimension + scatterings * dimensions_of_vertex + number);
    }
    bool survives() {
        if (scatterings <= scatterings_before_roulette)
            return true;
        const float most = std::max({throughput.x, throughput.y, throughput.z});
        const float survive = std::clamp(most, 0.05f, 0.98f);
        throughput /= survive;
        seek(4);
        return random.next() < survive;
    }
};

struct LightTracer::Splat {
    std::size_t pixel = 0;
    vec3 value{0.0f};
};

struct LightTracer::Picture {
    shared::CameraRow camera;
    const ReferenceSettings& settings;
    std::size_t pixels;
    float area; // of the whole picture at a depth of 1, over the square of that depth

    vec3 position() const { return vec3(camera.position); }
    bool shows_radiance() const { return settings.view == ReferenceView::radiance; }
    bool shows(std::uint32_t scatterings) const {
        return !(settings.view == ReferenceView::indirect && scatterings == 0) &&
               !(settings.view == ReferenceView::direct && scatterings > 0);
    }
    // `away`: from the camera. False: outside of the picture.
    bool find_pixel(vec3 away, std::size_t& pixel) const {
        const float depth = glm::dot(away, vec3(camera.axis));
        if (depth <= 0.0f)
            return false;
        const auto along = [&](vec4 side) { return glm::dot(away, vec3(side)) / glm::dot(vec3(side), vec3(side)); };
        const float x = 0.5f * (along(camera.right) / depth + 1.0f) * float(settings.width);
        const float y = 0.5f * (along(camera.down) / depth + 1.0f) * float(settings.height);
        if (!(x >= 0.0f && x < float(settings.width) && y >= 0.0f && y < float(settings.height)))
            return false;
        pixel = std::size_t(y) * settings.width + std::size_t(x);
        return true;
    }
};

// What some of the particles bring, in their order.
struct LightTracer::Chunk {
    std::vector<Splat> splats;
    std::uint64_t rays = 0;
};

LightTracer::LightTracer(const raytrace::RayScene& rays, std::vector<Emitter> emitters,
                         std::vector<Emitter> backgrounds)
    : rays_(rays), emitters_(std::move(emitters)), backgrounds_(std::move(backgrounds)) {
    double sum = 0.0;
    for (const Emitter& emitter : emitters_) {
        chances_.push_back(sum += double(luminance(emitter.flux)));
        if (emitter.is_lamp)
            lamps_.insert(emitter.entity);
    }
    for (double& chance : chances_)
        chance /= sum;
}

// By flux: all particles then carry about the same.
LightTracer::Particle LightTracer::emit(std::uint64_t index, std::uint32_t seed) const {
    // Sequences have 32 bits for the index.
    const std::uint32_t high = std::uint32_t(index >> 32), low = std::uint32_t(index);
    Particle particle{RandomSequence(SequenceKind::sobol, high == 0 ? seed : hash_combine(seed, high), low), low};
    const double choice = double(particle.random.at(emitter_dimension));
    const auto found = std::upper_bound(chances_.begin(), chances_.end(), choice);
    const std::size_t chosen = std::min(std::size_t(found - chances_.begin()), chances_.size() - 1);
    const double chance = chances_[chosen] - (chosen > 0 ? chances_[chosen - 1] : 0.0);
    const Emitter& emitter = emitters_[chosen];
    float numbers[4];
    for (std::uint32_t i = 0; i < 4; ++i)
        numbers[i] = particle.random.at(i);
    const EmittedRay ray = sample_emitter_ray(emitter, numbers);
    particle.flux = emitter.flux * ray.tint * float(double(ray.weight) / chance);
    if (emitter.kind == EmitterKind::mesh && emitter.textured)
        particle.flux = pi * emitter.area / float(chance) *
                        textured_emission(rays_, emitter, sample_emitter_point(emitter, numbers[0], numbers[1]));
    particle.ray.origin = ray.origin + raytrace::ray_offset(ray.origin) * ray.normal;
    particle.ray.direction = ray.direction;
    particle.ray.salt = low;
    return particle;
}

// Whether the camera sees the vertex, from the side that the particle comes from.
bool LightTracer::is_seen(const Vertex& vertex, const Picture& picture, std::uint32_t salt, std::uint64_t& rays) const {
    const vec3 origin = vertex.position + vertex.offset * vertex.geometric_normal;
    raytrace::Ray ray{origin, picture.position() - origin, 0.0f, 1.0f, salt};
    constexpr int max_layers = 64;
    for (int layer = 0; layer < max_layers; ++layer) {
        ++rays;
        const auto hit = rays_.closest_hit(ray);
        if (!hit)
            return true;
        const raytrace::SurfacePoint point = rays_.surface(ray, *hit);
        if (point.material.double_sided || glm::dot(point.geometric_normal, ray.direction) > 0.0f)
            return false;
        ray.origin = point.on_triangle - point.offset * point.geometric_normal; // the camera sees it from behind
        ray.direction = picture.position() - ray.origin;
    }
    return false;
}

// What the camera sees of the particle at a surface. A pixel's value is the mean over its area. A square metre of
// surface covers cosine distance / depth^3 of the picture's plane, and there are as many particles as pixels.
void LightTracer::connect(const Particle& particle, const Vertex& vertex, const raytrace::SurfacePoint& point,
                          const Picture& picture, Chunk& chunk) const {
    const bool radiance = picture.shows_radiance();
    Splat splat;
    const vec3 away = vertex.position - picture.position();
    if (!picture.find_pixel(away, splat.pixel) || (!point.material.double_sided && !vertex.entering) ||
        (radiance ? vertex.bsdf.is_glass() : lamps_.count(point.entity) != 0))
        return;
    const float distance = glm::length(away), depth = glm::dot(away, vec3(picture.camera.axis));
    const vec3 to_camera = away / -distance;
    const float cosine = glm::dot(to_camera, vertex.geometric_normal);
    const float arriving = -glm::dot(particle.ray.direction, vertex.geometric_normal);
    if (cosine <= 0.0f)
        return;
    // Irradiance is by the shading normal (Veach, 1997, sec. 5.3).
    splat.value = particle.flux * particle.throughput *
                  (vertex.outgoing.z / arriving * cosine * distance / (depth * depth * depth * picture.area));
    if (radiance)
        splat.value *= vertex.bsdf.evaluate(visible(vertex.frame.to_local(to_camera)), vertex.outgoing);
    if (splat.value != vec3(0.0f) && is_seen(vertex, picture, particle.salt, chunk.rays))
        chunk.splats.push_back(splat);
}

// At a surface; false if the particle ends there.
bool LightTracer::meet(Particle& particle, const raytrace::SurfacePoint& point, const Picture& picture,
                       Chunk& chunk) const {
    particle.seek(0);
    const Vertex vertex = Vertex::at(point, particle.ray.direction, Bsdf(point.material, particle.random.next()));
    const vec3 to_light = -particle.ray.direction;
    const float arriving = glm::dot(to_light, vertex.geometric_normal);
    const bool lit = arriving > 0.0f && glm::dot(to_light, vertex.frame.normal) > 0.0f;
    if (lit && picture.shows(particle.scatterings))
        connect(particle, vertex, point, picture, chunk);
    const float side = glm::dot(point.geometric_normal, particle.ray.direction) < 0.0f ? -1.0f : 1.0f;
    if (!point.casts_shadow) { // light passes
        particle.ray.origin = point.on_triangle + side * point.offset * point.geometric_normal;
        return true;
    }
    if (!lit || particle.scatterings >= picture.settings.bounces || picture.settings.view == ReferenceView::direct)
        return false;
    const float numbers[3] = {particle.random.next(), particle.random.next(), particle.random.next()};
    const std::optional<Scattered> scattered = vertex.bsdf.is_glass() ? scatter_at_glass(vertex, to_light, numbers[0])
                                                                      : scatter_at_opaque(vertex, to_light, numbers);
    if (!scattered)
        return false;
    particle.throughput *= scattered->weight;
    const float leaving = glm::dot(scattered->direction, vertex.geometric_normal);
    particle.ray.origin = vertex.position + (leaving > 0.0f ? vertex.offset : -vertex.offset) * vertex.geometric_normal;
    particle.ray.direction = scattered->direction;
    ++particle.scatterings;
    return particle.survives();
}

void LightTracer::trace(Particle& particle, const Picture& picture, Chunk& chunk) const {
    constexpr int max_layers = 64; // of surfaces that cast no shadow
    std::uint32_t layers = 0, scatterings = 0;
    while (layers < max_layers) {
        ++chunk.rays;
        const auto hit = rays_.closest_hit(particle.ray);
        if (!hit || !meet(particle, rays_.surface(particle.ray, *hit), picture, chunk))
            return;
        layers = particle.scatterings == scatterings ? layers + 1 : 0;
        scatterings = particle.scatterings;
    }
}

// What the camera sees without any light: emitters and surroundings, in views of radiance. Returns whether the pixel
// is covered, as Accumulation has it.
bool LightTracer::look(const Picture& picture, std::size_t pixel, std::uint32_t sample, Chunk& chunk) const {
    const ReferenceSettings& settings = picture.settings;
    const std::uint32_t seed = hash_combine(settings.seed, std::uint32_t(pixel));
    const RandomSequence random(SequenceKind::sobol, seed, sample);
    const bool radiance = picture.shows_radiance();
    const vec2 within = radiance ? vec2(random.at(0), random.at(1)) : vec2(0.5f);
    const vec2 place = vec2(float(pixel % settings.width), float(pixel / settings.width)) + within;
    const raytrace::Ray ray{picture.position(), glm::normalize(shared::camera_ray(picture.camera, place)), 0.0f, 1e30f,
                            sample};
    const auto found = visible_surface(rays_, ray, chunk.rays);
    vec3 seen = found ? emitted(*found, ray.direction) : vec3(0.0f);
    for (const std::vector<Emitter>* list : {&emitters_, &backgrounds_})
        for (const Emitter& emitter : *list)
            if (!found && emitter.kind == EmitterKind::environment)
                seen += emitter.environment_radiance(ray.direction);
    if (radiance)
        chunk.splats.push_back({pixel, seen});
    return found && lamps_.count(found->entity) == 0;
}

// One particle for each of the pixels. What they bring is added in their order, whichever thread was first.
void LightTracer::trace_group(Accumulation& accumulation, const Picture& picture, std::size_t begin,
                              std::size_t end) const {
    const std::uint32_t sample = accumulation.counts[begin];
    std::vector<Chunk> chunks(divide_up(end - begin, chunk_particles));
    parallel_for_chunks(end - begin, chunk_particles, [&](std::size_t first, std::size_t last) {
        Chunk& chunk = chunks[first / chunk_particles];
        for (std::size_t i = begin + first; i < begin + last; ++i) {
            if (sample == 0 || picture.shows_radiance())
                accumulation.covered[i] = look(picture, i, sample, chunk) ? 1 : 0;
            if (emitters_.empty())
                continue;
            Particle particle = emit(std::uint64_t(sample) * picture.pixels + i, picture.settings.seed);
            trace(particle, picture, chunk);
        }
    });
    for (const Chunk& chunk : chunks) {
        for (const Splat& splat : chunk.splats)
            for (int c = 0; c < 3; ++c)
                accumulation.sums[splat.pixel * 3 + std::size_t(c)] += double(splat.value[c]);
        accumulation.rays += chunk.rays;
    }
    for (std::size_t i = begin; i < end; ++i)
        ++accumulation.counts[i];
}

bool LightTracer::accumulate(Accumulation& accumulation, const scene::CameraView& camera,
                             const ReferenceSettings& settings, std::uint32_t count,
                             const std::function<bool()>& cancelled) const {
    Picture picture{scene::make_camera_row(camera, settings.width, settings.height), settings,
                    std::size_t(settings.width) * settings.height, 0.0f};
    picture.area = 4.0f * glm::length(vec3(picture.camera.right)) * glm::length(vec3(picture.camera.down));
    if (accumulation.sums.empty())
        start(accumulation, settings);
    std::vector<std::uint32_t>& counts = accumulation.counts;
    const std::uint32_t until = accumulation.samples + count;
    // All pixels have their sample before any has the next: sums are in the same order however the work is split.
    std::size_t next = std::size_t(std::min_element(counts.begin(), counts.end()) - counts.begin());
    while (counts[next] < until) {
        const std::size_t end = std::min(next + group_particles, picture.pixels);
        trace_group(accumulation, picture, next, end);
        next = end == picture.pixels ? 0 : end;
        if (cancelled && cancelled() && counts[next] < until)
            return false;
    }
    accumulation.samples = until;
    return true;
}

} // namespace sunfleck::gi::reference
