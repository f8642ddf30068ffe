#include "gi_module/splatting/splat_occlusion.h"

#include "engine/core/jobs.h"
#include "gi_module/shadows/octahedral_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

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

std::vector<MovingSphere> moving_spheres(const scene::SceneChanges& changes) {
    std::vector<MovingSphere> spheres;
    for (const scene::Drawable* drawable : changes.all)
        if (!drawable->is_static && drawable->casts_shadow)
            spheres.push_back({drawable->bounds.centre(), 0.5f * glm::length(drawable->bounds.extent())});
    return spheres;
}

void PixelLightMaps::clear() {
    keys_.clear();
    fixed_.clear();
    texels_.clear();
    traced_ = 0;
}

// The cone of a block holds the corners of its texels, and so all that lies between them.
void PixelLightMaps::make_blocks() {
    blocks_.clear();
    for (std::uint32_t first = 0; first < side_ * side_; first += block * block) {
        const std::uint32_t x = first / block % side_, y = first / block / side_ * block;
        const auto corner = [&](std::uint32_t i, std::uint32_t k) {
            const vec2 place = vec2(float(x + i * block), float(y + k * block)) * (2.0f / float(side_)) - 1.0f;
            return glm::normalize(shared::hemisphere_direction(place));
        };
        const vec3 corners[] = {corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)};
        Block cone;
        cone.axis = glm::normalize(corners[0] + corners[1] + corners[2] + corners[3]);
        for (const vec3& direction : corners)
            cone.cosine = std::min(cone.cosine, glm::dot(cone.axis, direction));
        cone.sine = std::sqrt(std::max(1.0f - cone.cosine * cone.cosine, 0.0f));
        blocks_.push_back(cone);
    }
}

std::uint64_t PixelLightMaps::trace(const shared::PixelLightRow& light, std::uint16_t* into,
                                    const raytrace::RayScene& rays, const std::span<const MovingSphere>* movers) const {
    struct Cone {
        vec3 axis;
        float cosine, sine;
    };
    std::vector<Cone> cones; // from the light, around movers, in its map's directions
    bool all = movers == nullptr;
    for (std::size_t i = 0; movers != nullptr && i < movers->size(); ++i) {
        const vec3 way = (*movers)[i].centre - vec3(light.row.position_bound);
        const float distance = glm::length(way), sine = (*movers)[i].radius / std::max(distance, 1e-30f);
        all |= sine >= 1.0f;
        const vec3 local(glm::dot(way, vec3(light.row.tangent_scale)), glm::dot(way, vec3(light.row.bitangent)),
                         glm::dot(way, vec3(light.row.normal_offset)));
        cones.push_back({local / distance, std::sqrt(std::max(1.0f - sine * sine, 0.0f)), sine});
    }
    const auto may_meet = [&](const Block& one) {
        return all || std::any_of(cones.begin(), cones.end(), [&](const Cone& cone) {
                   return glm::dot(one.axis, cone.axis) >= one.cosine * cone.cosine - one.sine * cone.sine;
               });
    };
    const raytrace::Scope scope = movers == nullptr ? raytrace::Scope::static_only : raytrace::Scope::everything;
    std::uint64_t traced = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        if (!may_meet(blocks_[i]))
            continue;
        const std::uint32_t first = std::uint32_t(i) * block * block;
        const std::uint32_t x = first / block % side_, y = first / block / side_ * block;
        const auto distances = rays.blockers(block_rays(light.row, x, y, side_), scope);
        traced += raytrace::packet_size;
        for (std::uint32_t k = 0; k < raytrace::packet_size; ++k)
            into[(y + k / block) * side_ + x + k % block] =
                std::uint16_t(std::floor(std::min(shared::shadow_near / distances[k], 1.0f) * 65535.0f + 0.5f));
    }
    return traced;
}

std::vector<PixelLightMaps::Key> PixelLightMaps::keys_of(std::span<const shared::PixelLightRow> lights) {
    std::vector<Key> keys;
    for (const shared::PixelLightRow& light : lights) {
        const vec4 place = light.row.position_bound, normal = light.row.normal_offset;
        keys.push_back({place.x, place.y, place.z, normal.x, normal.y, normal.z});
    }
    return keys;
}

void PixelLightMaps::update(std::span<const shared::PixelLightRow> lights, std::uint32_t side,
                            const raytrace::RayScene& rays, std::span<const MovingSphere> movers) {
    traced_ = 0;
    std::vector<Key> keys = keys_of(lights);
    if (keys == keys_ && side == side_ && generation_ == rays.generation())
        return;
    if (side != side_ || static_generation_ != rays.static_generation()) {
        clear();
        side_ = side;
        make_blocks();
    }
    static_generation_ = rays.static_generation();
    generation_ = rays.generation();
    std::map<Key, std::size_t> before;
    for (std::size_t i = 0; i < keys_.size(); ++i)
        before.emplace(keys_[i], i);
    const std::size_t size = std::size_t(side) * side;
    std::vector<std::uint16_t> fixed(lights.size() * size);
    texels_.resize(fixed.size());
    std::vector<std::uint64_t> traced(lights.size(), 0);
    parallel_for_chunks(lights.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto kept = before.find(keys[i]);
            if (kept != before.end())
                std::copy_n(fixed_.begin() + std::ptrdiff_t(kept->second * size), size,
                            fixed.begin() + std::ptrdiff_t(i * size));
            else
                traced[i] += trace(lights[i], &fixed[i * size], rays, nullptr);
            std::copy_n(fixed.begin() + std::ptrdiff_t(i * size), size, texels_.begin() + std::ptrdiff_t(i * size));
            traced[i] += trace(lights[i], &texels_[i * size], rays, &movers);
        }
    });
    traced_ = std::accumulate(traced.begin(), traced.end(), std::uint64_t(0));
    fixed_ = std::move(fixed);
    keys_ = std::move(keys);
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
