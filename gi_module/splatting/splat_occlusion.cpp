#include "gi_module/splatting/splat_occlusion.h"

#include "engine/core/jobs.h"
#include "gi_module/shadows/octahedral_map.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t block = 4;                        // texels of a packet of rays, along a side
constexpr std::size_t most_texels = std::size_t(1) << 26; // of all maps: 128 MiB
static_assert(block * block == raytrace::packet_size);

vec2 texel_centre(std::uint32_t x, std::uint32_t y, std::uint32_t side) {
    return (vec2(float(x), float(y)) + 0.5f) * (2.0f / float(side)) - 1.0f;
}

// Rays through the centres of a block of texels. Their directions have w = 1, so that distances are w.
raytrace::ShadowPacket block_rays(const shared::LightRow& light, std::uint32_t first_x, std::uint32_t first_y,
                                  std::uint32_t side) {
    raytrace::ShadowPacket packet;
    for (std::uint32_t i = 0; i < raytrace::packet_size; ++i) {
        const vec3 local = shared::hemisphere_direction(texel_centre(first_x + i % block, first_y + i / block, side));
        packet.rays[i].origin = vec3(light.position_bound);
        packet.rays[i].direction =
            local.x * vec3(light.tangent_scale) + local.y * vec3(light.bitangent) + local.z * vec3(light.normal_offset);
    }
    return packet;
}

} // namespace

void trace_pixel_light_maps(std::span<const shared::PixelLightRow> lights, std::uint32_t side,
                            const raytrace::RayScene& rays, std::vector<std::uint16_t>& texels) {
    texels.resize(lights.size() * side * side);
    parallel_for_chunks(lights.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            for (std::uint32_t first = 0; first < side * side; first += block * block) {
                const std::uint32_t x = first / block % side, y = first / block / side * block;
                const auto distances =
                    rays.blockers(block_rays(lights[i].row, x, y, side), raytrace::Scope::everything);
                for (std::uint32_t k = 0; k < raytrace::packet_size; ++k)
                    texels[(i * side + y + k / block) * side + x + k % block] =
                        std::uint16_t(std::min(shared::shadow_near / distances[k], 1.0f) * 65535.0f + 0.5f);
            }
    });
}

float ambient_occlusion(const shared::PixelLightRow& light, float reach, const raytrace::RayScene& rays) {
    const raytrace::ShadowPacket packet = block_rays(light.row, 0, 0, block);
    const auto distances = rays.blockers(packet, raytrace::Scope::everything);
    float blocked = 0.0f, all = 0.0f;
    for (std::uint32_t i = 0; i < raytrace::packet_size; ++i) {
        // A texel's solid angle on a planar face falls with the cube of the distance of its centre.
        const float length = glm::length(packet.rays[i].direction);
        const float weight =
            glm::dot(packet.rays[i].direction, vec3(light.row.normal_offset)) / (length * length * length * length);
        all += weight;
        blocked += distances[i] * length < reach ? weight : 0.0f;
    }
    return blocked / all;
}

std::uint32_t side_of_pixel_light_maps(std::uint32_t wanted, std::size_t lights) {
    std::uint32_t side = wanted;
    while (side > block && std::size_t(side) * side * lights > most_texels)
        side /= 2;
    return side;
}

} // namespace sunfleck::gi
