#include "gi_module/splatting/visible_contribution.h"

#include "engine/core/jobs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t points_across = 8;          // of the picture, and as many down
constexpr std::size_t blocks_in_all = 256;          // of all maps together, about
constexpr std::uint32_t most_blocks_across = 16;    // of one map
constexpr float before_the_point = 1.0f - 0x1p-10f; // of the way to it, where nothing may be

// The brightest texel of a block, with the flux and the area of all.
struct Block {
    const ReflectiveTexel* brightest = nullptr;
    float flux = 0.0f, area = 0.0f; // luminance, W; m2
};

Block block_at(const ReflectiveShadowMap& map, std::uint32_t size, std::uint32_t x, std::uint32_t y) {
    Block block;
    float most = 0.0f;
    for (std::uint32_t i = 0; i < size * size; ++i) {
        const ReflectiveTexel& texel = map.texels[std::size_t(y * size + i / size) * map.side + x * size + i % size];
        const float flux = luminance(texel.diffuse + texel.glossy);
        if (!texel.lit || !(flux > 0.0f) || !std::isfinite(flux))
            continue;
        block.flux += flux;
        block.area += texel.area;
        if (flux > most) {
            most = flux;
            block.brightest = &texel;
        }
    }
    return block;
}

// Of 1 W from the block, at points first to first + 16.
void add_points(const Block& block, std::span<const SeenPoint> points, const raytrace::RayScene& rays,
                std::span<float> result) {
    raytrace::ShadowPacket packet;
    packet.active = 0;
    const float softness = pixel_light_softness(block.area, 2.0f);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const vec3 way = points[i].position - block.brightest->position;
        const float along = glm::dot(block.brightest->normal, way), facing = -glm::dot(points[i].normal, way);
        if (along <= 0.0f || facing <= 0.0f)
            continue;
        result[i] = shared::softened_term(along, facing, glm::dot(way, way), softness) / pi;
        packet.rays[i] = {block.brightest->position, way, 0.0f, before_the_point};
        packet.active |= 1u << i;
    }
    const std::uint32_t blocked = packet.active != 0 ? rays.occluded(packet) : 0u;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (blocked >> i & 1u)
            result[i] = 0.0f;
}

} // namespace

std::vector<SeenPoint> seen_points(const mat4& view_projection, const raytrace::RayScene& rays) {
    const mat4 inverse = glm::inverse(view_projection);
    const auto at = [&](vec2 place, float depth) {
        const vec4 point = inverse * vec4(place, depth, 1.0f);
        return vec3(point) / point.w;
    };
    std::vector<SeenPoint> points;
    for (std::uint32_t i = 0; i < points_across * points_across; ++i) {
        const std::uint32_t line = i / points_across;
        const vec2 place = (vec2(float(i % points_across), float(line)) + 0.5f) * (2.0f / float(points_across)) - 1.0f;
        const vec3 near = at(place, 1.0f), direction = at(place, 0.5f) - near;
        const raytrace::Ray ray{near, direction, 0.0f, 1e30f};
        const auto hit = is_finite(direction) ? rays.closest_hit(ray) : std::nullopt;
        if (!hit)
            continue;
        const raytrace::SurfacePoint surface = rays.surface(ray, *hit);
        const float side = glm::dot(surface.geometric_normal, direction) < 0.0f ? 1.0f : -1.0f;
        points.push_back({surface.position + side * rays.ray_offset_anywhere() * surface.geometric_normal,
                          side * surface.shading_normal});
    }
    return points;
}

std::uint32_t contribution_blocks(std::uint32_t side, std::size_t maps) {
    const double wanted = std::sqrt(double(blocks_in_all) / double(std::max<std::size_t>(maps, 1)));
    return std::min({std::max(std::bit_floor(std::uint32_t(wanted)), 2u), most_blocks_across, side});
}

BlockLight trace_block_light(const ReflectiveShadowMap& map, std::uint32_t blocks, std::span<const SeenPoint> points,
                             const raytrace::RayScene& rays) {
    BlockLight light;
    light.blocks = blocks;
    light.per_flux.assign(std::size_t(blocks) * blocks * points.size(), 0.0f);
    std::vector<float> fluxes(std::size_t(blocks) * blocks, 0.0f);
    parallel_for_chunks(fluxes.size(), 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Block block = block_at(map, map.side / blocks, std::uint32_t(i) % blocks, std::uint32_t(i) / blocks);
            fluxes[i] = block.flux;
            for (std::size_t first = 0; block.brightest != nullptr && first < points.size();
                 first += raytrace::packet_size) {
                const std::size_t count = std::min(raytrace::packet_size, points.size() - first);
                add_points(block, points.subspan(first, count), rays,
                           std::span(light.per_flux).subspan(i * points.size() + first, count));
            }
        }
    });
    light.at_points.assign(points.size(), 0.0f);
    for (std::size_t i = 0; i < fluxes.size(); ++i)
        for (std::size_t k = 0; k < points.size(); ++k)
            light.at_points[k] += fluxes[i] * light.per_flux[i * points.size() + k];
    return light;
}

std::vector<float> block_contributions(const BlockLight& light, std::span<const float> all) {
    const float mean = std::accumulate(all.begin(), all.end(), 0.0f) / float(std::max<std::size_t>(all.size(), 1));
    std::vector<float> result(std::size_t(light.blocks) * light.blocks, 0.0f);
    if (mean <= 0.0f)
        return result;
    for (std::size_t i = 0; i < result.size(); ++i) {
        for (std::size_t k = 0; k < all.size(); ++k)
            result[i] += light.per_flux[i * all.size() + k] / (all[k] + 0.1f * mean);
        result[i] /= float(all.size());
    }
    return result;
}

} // namespace sunfleck::gi
