// The truth that every technique is held against: an unbiased path tracer with next-event estimation and multiple
// importance sampling (E. Veach, 1997, ch. 9, power heuristic), on the CPU.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "engine/scene/camera_view.h"
#include "gi_module/light_sampling/emitters.h"

#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

namespace sunfleck::gi::reference {

enum class ReferenceView { radiance, irradiance, direct, indirect }; // the last three in W/m2

struct ReferenceSettings {
    std::uint32_t width = 640, height = 360;
    std::uint32_t samples_per_pixel = 256;
    std::uint32_t bounces = 5; // reflections after the first visible surface; unlimited_bounces ends by chance alone
    std::uint32_t seed = 1;
    ReferenceView view = ReferenceView::radiance;
    bool antialiasing = false; // off: through pixel centres, as the rasteriser; on: box filter
};
inline constexpr std::uint32_t unlimited_bounces = 0xffffffffu;

// Running sums, so that work can stop, be saved, and go on with the same result as if it had never stopped.
struct Accumulation {
    std::uint32_t width = 0, height = 0;
    std::uint32_t samples = 0;         // per pixel
    std::vector<double> sums;          // RGB a pixel, rows from the top
    std::vector<std::uint8_t> covered; // 1: the pixel shows a surface other than an AreaLight's
    std::uint64_t rays = 0;
};

class PathTracer {
public:
    // The registry's emitters and the ray scene must not change while rendering.
    PathTracer(const raytrace::RayScene& rays, std::vector<Emitter> emitters);

    // Adds `count` samples to every pixel. The result depends on neither the number of threads nor on how the samples
    // are split over calls. Returns false, with the accumulation unchanged, if `cancelled` said true meanwhile.
    bool accumulate(Accumulation& accumulation, const scene::CameraView& camera, const ReferenceSettings& settings,
                    std::uint32_t count, const std::function<bool()>& cancelled = {}) const;

    // Mean over `samples` of the irradiance at a point, W/m2, by the number of reflections that its light has seen:
    // element 0 is direct light. `normal`: unit, of the lit side.
    std::vector<vec3> irradiance_by_bounce(vec3 position, vec3 normal, std::uint32_t bounces, std::uint32_t samples,
                                           std::uint32_t seed) const;

private:
    struct Path;
    struct Vertex;
    vec3 direct_light(Path& path, const Vertex& vertex) const;
    vec3 environment(vec3 direction) const;
    vec3 environment_found(vec3 direction, float pdf, bool delta) const;
    vec3 emitted(const raytrace::SurfacePoint& point, vec3 direction) const;
    float emitter_density(const raytrace::SurfacePoint& point, vec3 direction, float distance) const;
    void trace(Path& path, Vertex vertex) const;
    vec3 pixel_sample(std::uint32_t x, std::uint32_t y, std::uint32_t sample, const shared::CameraRow& camera,
                      const ReferenceSettings& settings, std::uint64_t& rays, std::uint8_t& covered) const;

    const raytrace::RayScene& rays_;
    std::vector<Emitter> emitters_;  // those that next-event estimation samples
    std::vector<double> cumulative_; // of their flux
    std::vector<Emitter> environments_;
    std::unordered_map<ecs::Entity, std::size_t> area_emitters_;
};

// Saves and loads an accumulation with the hash of what it belongs to. Loading a file of another hash is an error.
Status save_accumulation(const std::string& path, const Accumulation& accumulation, std::uint64_t hash);
Result<Accumulation> load_accumulation(const std::string& path, std::uint64_t hash);

} // namespace sunfleck::gi::reference
