// What arrives at a point from all light samples, as spherical harmonics (thesis sec. 4.4.1). At several points of a
// mover, so that the edge of a shadow can cross it (fig. 4-14 shows what one point does).
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "engine/scene/gpu_scene.h"
#include "gi_module/harmonics/spherical_harmonics.h"
#include "gi_module/transport/light_row.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

// Incident radiance by colour, in a mover's own space.
struct Environment {
    std::array<Harmonics, 3> colours{};
};

// A grid of points in a mover's box, the same number along each axis.
class PointGrid {
public:
    PointGrid(const Bounds& local, std::uint32_t side) : local_(local), side_(side) {}
    std::uint32_t size() const { return side_ * side_ * side_; }
    vec3 point(std::uint32_t index) const;
    // The eight points around a place, and their weights; outside of the grid the nearest count.
    struct Weights {
        std::array<std::uint32_t, 8> points;
        std::array<float, 8> weights;
    };
    Weights around(vec3 place) const;

private:
    Bounds local_;
    std::uint32_t side_;
};

struct ProbeScene {
    const raytrace::RayScene& rays;
    std::span<const LightSample> samples;
    std::span<const shared::LightRow> rows; // of the samples
    std::span<const scene::DrawItem> draws;
    const VisibilityDatabase* database = nullptr; // null: every sample is tested
};

// The environments of all points of the grid. What hides a sample from a point is found by rays; samples that the
// database knows to be hidden from all of the mover cost none. The mover itself does not count.
std::vector<Environment> project_environment(const ProbeScene& scene, const scene::DrawItem& mover, const mat4& matrix,
                                             const PointGrid& grid);

} // namespace sunfleck::gi
