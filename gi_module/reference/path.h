// A path of the reference while it is traced. For the files that implement PathTracer and LightTracer.
#pragma once

#include "engine/core/random.h"
#include "gi_module/reference/bsdf.h"
#include "gi_module/reference/path_tracer.h"

#include <algorithm>
#include <limits>

namespace sunfleck::gi::reference {

// Of multiple importance sampling: weight of the technique with density `a` against that with density `b`.
inline float power_heuristic(float a, float b) {
    const float a2 = a * a, sum = a2 + b * b;
    if (sum > 0.0f && sum < std::numeric_limits<float>::infinity())
        return a2 / sum;
    if (!(a > 0.0f))
        return 0.0f;
    const float ratio = b / a; // the squares are beyond what floats hold: a far lamp, or one that is seen edge-on
    return 1.0f / (1.0f + ratio * ratio);
}

struct Frame {
    explicit Frame(vec3 n) : normal(n) { orthonormal_basis(n, tangent, bitangent); }
    vec3 to_local(vec3 v) const { return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)}; }
    vec3 to_world(vec3 v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
    vec3 tangent, bitangent, normal;
};

// A local direction to a viewer; a shading normal that faces away from it would make the surface black.
inline vec3 visible(vec3 outgoing) {
    return {outgoing.x, outgoing.y, std::max(outgoing.z, 1e-4f)};
}

// A path vertex: a surface that scatters light, seen from the side that the path came from.
struct Vertex {
    vec3 position;
    float offset; // of ray origins from the surface, m
    vec3 geometric_normal;
    Frame frame;   // of the shading normal
    vec3 outgoing; // local, to where the path came from
    Bsdf bsdf;
    bool entering = true; // glass: the path comes from outside

    // `direction`: in which the path arrives.
    static Vertex at(const raytrace::SurfacePoint& point, vec3 direction, const Bsdf& bsdf) {
        const bool front = glm::dot(point.geometric_normal, direction) < 0.0f;
        const Frame frame(front ? point.shading_normal : -point.shading_normal);
        const vec3 normal = front ? point.geometric_normal : -point.geometric_normal;
        return {point.on_triangle, point.offset, normal, frame, visible(frame.to_local(-direction)), bsdf, front};
    }
};

// The first surface that the camera sees along the ray; single-sided surfaces are not seen from behind. `count`: of
// rays, is raised.
std::optional<raytrace::SurfacePoint> visible_surface(const raytrace::RayScene& rays, raytrace::Ray ray,
                                                      std::uint64_t& count);

// Radiance that a textured mesh emits at a point, W/(sr m2).
vec3 textured_emission(const raytrace::RayScene& rays, const Emitter& emitter, const EmittedPoint& point);

// On its front alone.
inline vec3 emitted(const raytrace::SurfacePoint& point, vec3 direction) {
    return glm::dot(point.geometric_normal, direction) < 0.0f ? point.material.emission : vec3(0.0f);
}

// Makes room for the settings' picture.
void start(Accumulation& accumulation, const ReferenceSettings& settings);

struct PathTracer::Path {
    RandomSequence random;
    std::uint32_t bounces;  // reflections still allowed after the first vertex
    std::uint32_t salt = 0; // of its rays
    vec3 throughput{1.0f};
    std::vector<vec3>* by_bounce = nullptr; // if set, contributions are added here, by number of reflections
    bool caustics = true;                   // ReferenceSettings::caustics
    bool was_diffuse = false;               // at an earlier vertex
    vec3 to_emitters{1.0f};                 // throughput for emitters that the scattered ray finds
    bool skip_direct = false;
    bool skip_indirect = false;
    vec3 result{0.0f};
    std::uint64_t rays = 0;

    // At the present vertex, emitters are reflected by its diffuse part alone.
    bool without_gloss() const { return !caustics && was_diffuse; }
    // Goes on from a vertex by what its surface does to the light.
    void scatter(vec3 weight, vec3 weight_for_emitters, bool diffuse) {
        to_emitters = throughput * weight_for_emitters;
        throughput *= weight;
        was_diffuse = was_diffuse || diffuse;
    }

    void add(std::uint32_t reflections, vec3 light) {
        if ((reflections == 0 && skip_direct) || (reflections > 0 && skip_indirect))
            return;
        result += light;
        if (by_bounce != nullptr)
            (*by_bounce)[reflections] += light;
    }
};

} // namespace sunfleck::gi::reference
