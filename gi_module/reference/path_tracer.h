// The ground truth for every technique: an unbiased path tracer with next-event estimation and multiple importance
// sampling (E. Veach, 1997, ch. 9, power heuristic), on the CPU.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "engine/scene/camera_view.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/reference/bsdf.h"

#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace sunfleck::gi::reference {

enum class ReferenceView { radiance, irradiance, direct, indirect }; // the last three in W/m2

struct ReferenceSettings {
    std::uint32_t width = 640, height = 360;
    std::uint32_t samples_per_pixel = 256;
    std::uint32_t bounces = 5; // reflections after the first visible surface; unlimited_bounces: Russian roulette only
    std::uint32_t seed = 1;
    ReferenceView view = ReferenceView::radiance;
    bool caustics = true;      // off: no emitter is found by way of a glossy or glass surface after a diffuse one
    bool antialiasing = false; // off: through pixel centres, as rasterised; on: box filter
};
inline constexpr std::uint32_t unlimited_bounces = 0xffffffffu;

// Running sums, so that rendering can stop, be saved (accumulation_file.h), and resume with the same result as without
// the stop.
struct Accumulation {
    std::uint32_t width = 0, height = 0;
    std::uint32_t samples = 0;         // that every pixel has
    std::vector<double> sums;          // RGB per pixel, rows from the top
    std::vector<std::uint32_t> counts; // samples of each pixel: more than `samples` where a stop came in between
    std::vector<std::uint8_t> covered; // 1: the pixel shows a surface other than an AreaLight's
    std::uint64_t rays = 0;
};

// A path vertex (path.h).
struct Vertex;

class PathTracer {
public:
    // The registry's emitters and the ray scene must not change while rendering. `backgrounds`: see
    // collect_backgrounds.
    PathTracer(const raytrace::RayScene& rays, std::vector<Emitter> emitters, std::vector<Emitter> backgrounds = {});

    // Brings every pixel to `count` more samples than `samples`. The result depends on neither the number of threads
    // nor on how the work is split over calls. Returns false if `cancelled` (called once a pixel, from any thread)
    // returned true before all was done: some pixels then have more samples than others, and the same call goes on.
    bool accumulate(Accumulation& accumulation, const scene::CameraView& camera, const ReferenceSettings& settings,
                    std::uint32_t count, const std::function<bool()>& cancelled = {}) const;

    // Irradiance at a point, W/m2, by the number of reflections of its light (element 0: direct light); the mean of
    // `samples` paths. `normal`: unit, of the lit side.
    std::vector<vec3> irradiance_by_bounce(vec3 position, vec3 normal, std::uint32_t bounces, std::uint32_t samples,
                                           std::uint32_t seed) const;

private:
    struct Path;
    struct EmitterSample;
    static constexpr std::size_t not_sampled = std::size_t(-1);
    struct PixelSample {
        vec3 value{0.0f};
        bool covered = false; // see Accumulation
        std::uint64_t rays = 0;
    };
    // Where an emitter is, for the choice between emitters.
    struct Whereabouts {
        vec3 centre{0.0f};
        float radius2 = 0.0f; // of a sphere around it, squared, m2
        float power = 0.0f;   // luminance of its flux, or of what it lends to each m2 where it is distant
        bool distant = false;
    };
    float importance(const Whereabouts& emitter, vec3 receiver) const;
    float total_importance(vec3 receiver) const;
    float chance(std::size_t emitter, vec3 receiver, float total) const;
    std::size_t choose_emitter(float number, vec3 receiver, float& probability) const;
    EmitterSample sample_near(const Emitter& emitter, const EmittedPoint& point, float probability,
                              vec3 receiver) const;
    EmitterSample sample_emitter(Path& path, vec3 receiver) const;
    vec3 direct_light(Path& path, const Vertex& vertex) const;
    vec3 environment(vec3 direction) const;
    vec3 environment_found(vec3 receiver, vec3 direction, float pdf, bool delta) const;
    float emitter_density(vec3 receiver, const raytrace::SurfacePoint& point, vec3 direction) const;
    static Whereabouts find(const Emitter& emitter);
    std::optional<raytrace::SurfacePoint> follow(Path& path, const Vertex& vertex, std::uint32_t reflections,
                                                 raytrace::Ray ray, const BsdfSample& scattered) const;
    static vec3 weight_for_emitters(const Path& path, const Vertex& vertex, const BsdfSample& scattered);
    void trace(Path& path, Vertex vertex) const;
    bool scatter(Path& path, const Vertex& vertex, std::uint32_t reflections, BsdfSample& scattered) const;
    bool survives(Path& path) const;
    PixelSample pixel_sample(glm::uvec2 pixel, std::uint32_t sample, const shared::CameraRow& camera,
                             const ReferenceSettings& settings) const;
    // Returns the number of rays.
    std::uint64_t add_samples(Accumulation& accumulation, std::size_t pixel, std::uint32_t until,
                              const shared::CameraRow& camera, const ReferenceSettings& settings) const;

    const raytrace::RayScene& rays_;
    std::vector<Emitter> emitters_;        // those that next-event estimation samples
    std::vector<Whereabouts> whereabouts_; // of the same
    double total_flux_ = 0.0;              // luminance of theirs
    std::vector<Emitter> environments_, backgrounds_;
    std::vector<std::size_t> environment_places_; // in emitters_, or none
    std::unordered_map<ecs::Entity, std::size_t> area_emitters_;
};

} // namespace sunfleck::gi::reference
