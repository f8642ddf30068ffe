#include "engine/raytrace/surface_materials.h"

#include "engine/core/random.h"
#include "engine/scene/pattern_shared.h"

#include <bit>

namespace sunfleck::raytrace {
namespace {

// White if there is no such texture.
vec4 look_up(const scene::TextureStore* textures, const scene::TextureUse& use, const TrianglePlace& place) {
    if (!use || textures == nullptr || std::uint32_t(use.texture) >= textures->size() ||
        place.mesh.texture_coordinates.empty())
        return vec4(1.0f);
    return (*textures)[std::uint32_t(use.texture)].sample(
        use.coordinates(place.interpolate(place.mesh.texture_coordinates)));
}

} // namespace

float alpha_at(const SurfaceDescription& surface, const scene::TextureStore* textures, const TrianglePlace& place) {
    float alpha = surface.material.alpha * look_up(textures, surface.textures.base_colour, place).a;
    if (!place.mesh.colours.empty())
        alpha *= place.interpolate(place.mesh.colours).a;
    return alpha;
}

scene::Material material_at(const SurfaceDescription& surface, const scene::TextureStore* textures,
                            const TrianglePlace& place, vec3 local_position, vec3 local_normal) {
    scene::Material material = surface.material;
    if (surface.pattern.kind != scene::PatternKind::none)
        material.base_colour = glm::mix(material.base_colour, surface.pattern.colour,
                                        shared::pattern_share(std::uint32_t(surface.pattern.kind),
                                                              surface.pattern.scale, local_position, local_normal));
    if (!place.mesh.colours.empty())
        material.base_colour *= vec3(place.interpolate(place.mesh.colours));
    if (!surface.has_textures)
        return material;
    material.base_colour *= vec3(look_up(textures, surface.textures.base_colour, place));
    material.emission *= vec3(look_up(textures, surface.textures.emission, place));
    const vec4 packed = look_up(textures, surface.textures.metallic_roughness, place);
    material.roughness *= packed.g;
    material.metallic *= packed.b;
    material.transmission *= look_up(textures, surface.textures.transmission, place).r;
    return material;
}

vec3 bumped_normal(const SurfaceDescription& surface, const scene::TextureStore* textures, const TrianglePlace& place,
                   const mat3& to_world, vec3 normal) {
    if (!surface.textures.normal || place.mesh.tangents.empty())
        return normal;
    vec3 bump = vec3(look_up(textures, surface.textures.normal, place)) * 2.0f - 1.0f;
    bump *= vec3(surface.textures.normal_scale, surface.textures.normal_scale, 1.0f);
    const vec4 packed = place.interpolate(place.mesh.tangents);
    vec3 tangent = to_world * vec3(packed);
    tangent -= glm::dot(tangent, normal) * normal;
    const float length = glm::length(tangent);
    if (!(length > 1e-12f))
        return normal;
    tangent /= length;
    const vec3 bitangent = glm::cross(normal, tangent) * (packed.w < 0.0f ? -1.0f : 1.0f);
    return glm::normalize(bump.x * tangent + bump.y * bitangent + std::max(bump.z, 0.05f) * normal);
}

float hole_threshold(vec3 origin, vec3 direction, std::uint32_t primitive, std::uint32_t salt) {
    std::uint32_t hash = hash_combine(primitive, salt);
    for (int c = 0; c < 3; ++c) {
        hash = hash_combine(hash, std::bit_cast<std::uint32_t>(origin[c]));
        hash = hash_combine(hash, std::bit_cast<std::uint32_t>(direction[c]));
    }
    return float(pcg_hash(hash) >> 8) * (1.0f / 16777216.0f);
}

} // namespace sunfleck::raytrace
