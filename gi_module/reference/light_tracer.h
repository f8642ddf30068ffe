// The same truth from the other end: particles leave the emitters, and each surface that one meets is connected with
// the pinhole camera (E. Veach, 1997, sec. 10.2: light tracing, the paths of bidirectional path tracing with a single
// vertex on the eye's side). It finds what the path tracer cannot, light of points, spots and suns that arrives through
// smooth glass. What it cannot find itself is seen only by way of glass: no connection passes a smooth surface. Where
// light is on one side of glass by the shading normal and on the other by the triangle, it ends.
#pragma once

#include "gi_module/reference/path_tracer.h"

#include <unordered_set>

namespace sunfleck::gi::reference {

class LightTracer {
public:
    // As of PathTracer.
    LightTracer(const raytrace::RayScene& rays, std::vector<Emitter> emitters, std::vector<Emitter> backgrounds = {});

    // As PathTracer::accumulate, with one particle for each sample of each pixel, wherever that lands; `cancelled` is
    // called between groups of particles. The result depends on neither the number of threads nor on how the work is
    // split. Each pixel shows the mean over its area, whatever `antialiasing` says; `caustics` must be on.
    bool accumulate(Accumulation& accumulation, const scene::CameraView& camera, const ReferenceSettings& settings,
                    std::uint32_t count, const std::function<bool()>& cancelled = {}) const;

private:
    struct Particle;
    struct Splat;
    struct Picture;
    struct Chunk;
    Particle emit(std::uint64_t index, std::uint32_t seed) const;
    void trace(Particle& particle, const Picture& picture, Chunk& chunk) const;
    bool meet(Particle& particle, const raytrace::SurfacePoint& point, const Picture& picture, Chunk& chunk) const;
    void connect(const Particle& particle, const Vertex& vertex, const raytrace::SurfacePoint& point,
                 const Picture& picture, Chunk& chunk) const;
    bool is_seen(const Vertex& vertex, const Picture& picture, std::uint32_t salt, std::uint64_t& rays) const;
    bool look(const Picture& picture, std::size_t pixel, std::uint32_t sample, Chunk& chunk) const;
    void trace_group(Accumulation& accumulation, const Picture& picture, std::size_t begin, std::size_t end) const;

    const raytrace::RayScene& rays_;
    std::vector<Emitter> emitters_, backgrounds_;
    std::vector<double> chances_;           // of the emitters before and up to each
    std::unordered_set<ecs::Entity> lamps_; // whose surfaces views of irradiance leave out
};

} // namespace sunfleck::gi::reference
