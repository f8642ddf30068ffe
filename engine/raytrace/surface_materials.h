// What rays find on a surface: the material at a point, with its textures, pattern and holes.
#pragma once

#include "engine/raytrace/ray_scene.h"

namespace sunfleck::raytrace {

// Everything about an instance that decides how it looks at a point.
struct SurfaceDescription {
    scene::Material material;
    scene::MaterialTextures textures;
    scene::SurfacePattern pattern{scene::PatternKind::none};
    bool has_textures = false;

    bool has_holes() const { return material.alpha_mode != scene::AlphaMode::opaque; }
};

// A place on a triangle.
struct TrianglePlace {
    const scene::Mesh& mesh;
    std::uint32_t primitive;
    float u, v; // weights of the second and third corner

    template <typename T>
    T interpolate(const std::vector<T>& values) const {
        const std::uint32_t* corner = &mesh.indices[std::size_t(primitive) * 3];
        return (1.0f - u - v) * values[corner[0]] + u * values[corner[1]] + v * values[corner[2]];
    }
};

// Share of light that the surface stops there.
float alpha_at(const SurfaceDescription& surface, const scene::TextureStore* textures, const TrianglePlace& place);

// The material there; `local_position` and `local_normal` place its pattern.
scene::Material material_at(const SurfaceDescription& surface, const scene::TextureStore* textures,
                            const TrianglePlace& place, vec3 local_position, vec3 local_normal);

// The unit `normal` (world space, as `tangent`) bent by the normal map, if there is one.
vec3 bumped_normal(const SurfaceDescription& surface, const scene::TextureStore* textures, const TrianglePlace& place,
                   const mat3& to_world, vec3 normal);

// A number in [0, 1) that depends on all of them; holes of blended surfaces are drawn by it.
float hole_threshold(vec3 origin, vec3 direction, std::uint32_t primitive, std::uint32_t salt);

} // namespace sunfleck::raytrace
