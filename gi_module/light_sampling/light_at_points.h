// What arrives of samples' light (VPLs) at single points, by rays past everything that stands in the way. A sample that
// stands for a disc of surface is spread over it near such points: few samples light the gap between a mover and a
// wall, and whether one point of a disc sees into it says little.
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "gi_module/transport/light_row_shared.h"

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace sunfleck::gi {

struct IncomingLight {
    shared::LightRow row;
    std::uint32_t light_class = 0;
    std::uint32_t bounce = 0; // reflections so far
    float radius = 0.0f;      // of the disc that a sample of the surface class is spread over, m; 0: it is a point
};

class LightAtPoints {
public:
    // `light` and `rays` must outlive it. `points`: of gather. `far`: beyond all geometry, m.
    LightAtPoints(std::span<const IncomingLight> light, const Bounds& points, float far,
                  const raytrace::RayScene& rays);

    // Of light that reaches the point: its place in `light`, and W/m2. That of a disc is visited in parts.
    using Visit = std::function<void(std::size_t, vec3)>;
    void gather(vec3 point, vec3 normal, const Visit& visit) const;

private:
    static constexpr std::size_t disc_points = 4;
    using Disc = std::array<vec3, disc_points>; // each a fourth of the sample

    Disc spread(const IncomingLight& one) const;

    std::span<const IncomingLight> light_;
    float far_;
    const raytrace::RayScene& rays_;
    std::vector<std::uint32_t> disc_of_; // by sample: place in discs_ + 1, or 0
    std::vector<Disc> discs_;
};

} // namespace sunfleck::gi
