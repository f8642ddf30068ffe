// Light from all light samples (VPLs) at a point, as spherical harmonics (thesis sec. 4.4.1). Evaluated at several
// points of a mover, so that the edge of a shadow can cross it (fig. 4-14 shows the result with one point).
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "engine/scene/gpu_scene.h"
#include "gi_module/harmonics/spherical_harmonics.h"
#include "gi_module/transport/light_row.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

// Incident radiance by colour channel, in a mover's object space.
struct Environment {
    std::array<Harmonics, 3> colours{};
};

// A regular grid of points in a mover's bounding box, `side` along each axis.
class PointGrid {
public:
    PointGrid(const Bounds& local, std::uint32_t side) : local_(local), side_(side) {}
    std::uint32_t size() const { return side_ * side_ * side_; }
    vec3 point(std::uint32_t index) const;
    // The eight grid points around a position and their trilinear weights; outside of the grid, those of the nearest
    // position in it.
    struct Weights {
        std::array<std::uint32_t, 8> points;
        std::array<float, 8> weights;
    };
    Weights around(vec3 position) const;

private:
    Bounds local_;
    std::uint32_t side_;
};

struct ProbeScene {
    const raytrace::RayScene& rays;
    std::span<const LightSample> samples;
    std::span<const shared::LightRow> rows; // of the samples
    std::span<const scene::DrawItem> draws;
    const VisibilityDatabase* database = nullptr; // null: every sample is tested by rays
    scene::SceneSpace space{};                    // where all of them lie
};

// The environments of all points of the grid. Occlusion between samples and points is found by rays; samples that are
// hidden from the whole mover, according to the database, cost none. The mover itself does not occlude.
std::vector<Environment> project_environment(const ProbeScene& scene, const scene::DrawItem& mover, const mat4& matrix,
                                             const PointGrid& grid);

} // namespace sunfleck::gi
