// Surfaces as rays see them: the material at a point, with its textures, pattern and alpha.
#pragma once

#include "engine/raytrace/ray_scene.h"

namespace sunfleck::raytrace {

// Everything of an instance that determines its appearance at a point.
struct SurfaceDescription {
    scene::Material material;
    scene::MaterialTextures textures;
    scene::SurfacePattern pattern{scene::PatternKind::none};
    bool has_textures = false;

    bool has_holes() const { return material.alpha_mode != scene::AlphaMode::opaque; }
};

// A point on a triangle.
struct TrianglePlace {
    const scene::Mesh& mesh;
    std::uint32_t primitive;
    float u, v; // barycentric weights of the second and third vertex

    template <typename T>
    T interpolate(const std::vector<T>& values) const {
        const std::uint32_t* corner = &mesh.indices[std::size_t(primitive) * 3];
        return (1.0f - u - v) * values[corner[0]] + u * values[corner[1]] + v * values[corner[2]];
    }
};

// Opacity there: the fraction of light blocked.
float alpha_at(const SurfaceDescription& surface, const scene::TextureStore* textures, const TrianglePlace& place);

// The material there; the pattern is evaluated at `local_position` and `local_normal`.
scene::Material material_at(const SurfaceDescription& surface, const scene::TextureStore* textures,
                            const TrianglePlace& place, vec3 local_position, vec3 local_normal);

// The unit `normal` (world space, like `tangent`) perturbed by the normal map, if there is one.
vec3 bumped_normal(const SurfaceDescription& surface, const scene::TextureStore* textures, const TrianglePlace& place,
                   const mat3& to_world, vec3 normal);

// Hash of the ray to [0, 1), for stochastic transparency.
float hole_threshold(vec3 origin, vec3 direction, std::uint32_t primitive, std::uint32_t salt);

} // namespace sunfleck::raytrace
