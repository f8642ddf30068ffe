// Places on a mesh's surface, evenly spread, each with the part of the surface around it.
#pragma once

#include "engine/raytrace/ray_scene.h"

#include <optional>
#include <vector>

namespace sunfleck::gi {

struct SurfacePlace {
    std::uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f; // weights of its second and third corner
    float side = 1.0f;        // -1: on the triangle's back
};

// `places`: the first in the middle of the part, the others anywhere in it.
struct SurfacePart {
    std::vector<SurfacePlace> places;
    float area = 0.0f; // of the part
};

// A place in the scene as it is now. Where the mover is gone, there is none.
struct PlaceNow {
    vec3 point{0.0f}; // off the surface, where rays start
    vec3 normal{0.0f};
    vec3 reflectance{0.0f};
};
std::optional<PlaceNow> place_now(ecs::Entity mover, const SurfacePlace& place, const raytrace::RayScene& rays);

// Of the light that leaves a place by Lambert's law: the share that meets the mover itself first, by eight rays.
float hidden_share(ecs::Entity mover, const PlaceNow& place, const raytrace::RayScene& rays);

// Of all triangles, m2, one side.
double surface_area(const scene::Mesh& mesh, const mat4& matrix);

struct PlaceRequest {
    std::uint32_t count = 0;  // of parts, at most
    std::uint32_t places = 1; // in each
    std::uint32_t seed = 1;
};

// Parts that differ little in place and direction. Meshes that enclose nothing have parts on both sides; where the mesh
// hides its surface from all else, there are none. `mesh`: the drawable's.
std::vector<SurfacePart> choose_places(const scene::Drawable& drawable, const scene::Mesh& mesh,
                                       const raytrace::RayScene& rays, const PlaceRequest& request);

} // namespace sunfleck::gi
