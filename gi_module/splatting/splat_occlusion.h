// What blocks the light of pixel lights: a small shadow map of each, made by rays with movers in them, or a factor of
// its flux (ambient occlusion, paper, sec. 3.6).
#pragma once

#include "engine/raytrace/ray_scene.h"
#include "engine/scene/scene_changes.h"
#include "gi_module/transport/pixel_light_shared.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sunfleck::gi {

// What may move in front of pixel lights: spheres around movers that cast shadows.
struct MovingSphere {
    vec3 centre{0.0f};
    float radius = 0.0f;
};
std::vector<MovingSphere> moving_spheres(const scene::SceneChanges& changes);

// Hemisphere maps (shadows/octahedral_map.h) of all lights of a frame. Of a light that stays, what static geometry
// shows is kept, and only where a mover may be are its texels traced again.
class PixelLightMaps {
public:
    // `side`: texels along the side of a map, a multiple of 4.
    void update(std::span<const shared::PixelLightRow> lights, std::uint32_t side, const raytrace::RayScene& rays,
                std::span<const MovingSphere> movers);
    void clear();

    // One map after the other in the order of the lights, 16 bits a texel. All rays of a map start at its light.
    std::span<const std::uint16_t> texels() const { return texels_; }
    std::uint32_t side() const { return side_; }
    std::uint64_t rays() const { return traced_; } // of the last update
    std::uint64_t memory_bytes() const { return (texels_.capacity() + fixed_.capacity()) * sizeof(std::uint16_t); }

private:
    struct Block { // of texels: a cone around its directions
        vec3 axis{0.0f, 0.0f, 1.0f};
        float cosine = 1.0f, sine = 0.0f; // of half its angle
    };
    using Key = std::array<float, 6>; // place and normal of a light

    static std::vector<Key> keys_of(std::span<const shared::PixelLightRow> lights);
    void make_blocks();
    // Into a map of `into`. `movers`: only blocks in which one of them may be; null: all. Returns the rays.
    std::uint64_t trace(const shared::PixelLightRow& light, std::uint16_t* into, const raytrace::RayScene& rays,
                        const std::span<const MovingSphere>* movers) const;

    std::uint32_t side_ = 0;
    std::vector<Block> blocks_;
    std::vector<Key> keys_;                     // of the lights of the last update
    std::vector<std::uint16_t> fixed_, texels_; // what static geometry shows; with movers
    std::uint64_t static_generation_ = 0, generation_ = 0, traced_ = 0;
};

// Share of the cosine-weighted hemisphere above a light that is blocked nearer than `reach`, units of the scene; by 16
// rays.
float ambient_occlusion(const shared::PixelLightRow& light, float reach, const raytrace::RayScene& rays);

// The largest side of maps, at most `wanted`, with which `lights` of them stay within the memory that is allowed for
// them.
std::uint32_t side_of_pixel_light_maps(std::uint32_t wanted, std::size_t lights);

} // namespace sunfleck::gi
