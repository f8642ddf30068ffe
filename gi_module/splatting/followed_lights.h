// Pixel lights that stay where they are on their surfaces while the emitter moves. The texels of the emitter's
// reflective shadow map are divided among them by distance, each light having the flux of its texels: as the emitter
// moves, flux passes from light to light little by little, and nothing jumps. Where the lights no longer fit, one that
// is hardly missed fades out and another fades in where light is far from all of them; a swap takes some updates.
#pragma once

#include "gi_module/light_sampling/importance_warping.h"
#include "gi_module/light_sampling/reflective_shadow_map.h"
#include "gi_module/splatting/nearest_places.h"

#include <span>
#include <vector>

namespace sunfleck::gi {

inline constexpr std::uint32_t splat_pattern_seed = 0x5b1a7; // of the places of lights in their emitter's view

struct FollowedLight {
    std::uint32_t texel = 0; // when it was placed
    ReflectiveTexel place;   // of it, where it is now
    // Since the last update:
    vec3 diffuse{0.0f}, glossy{0.0f}; // flux of its texels, W
    float area = 0.0f;                // m2
    // Fading: its distance to texels counts for more by this, m2, and what is added in an update, negative while it
    // fades in.
    float handicap = 0.0f, step = 0.0f;
    std::uint32_t age = 0; // updates since it was placed
};

class FollowedLights {
public:
    struct Request {
        const ReflectiveShadowMap& map;
        const ImportanceMap& importance; // zero: the texel has no light to give
        std::uint32_t count = 0;         // lights, at most
        std::uint32_t seed = 1;
        WarpMethod warp = WarpMethod::a; // of the places at the start
        std::uint32_t warp_levels = 6;
        const raytrace::RayScene& rays;
    };
    // Once a frame in which anything moves, and while is_fading().
    void update(const Request& request);
    std::span<const FollowedLight> lights() const { return lights_; }
    bool is_fading() const { return fading_; }
    // How often all lights were resampled: at first, and whenever the emitter has moved too far for them to follow.
    std::uint32_t starts() const { return starts_; }

private:
    // A texel that has light, in the space in which distances are taken: position and scaled normal.
    struct Texel {
        Place place;
        std::uint32_t index = 0; // in the map
        float importance = 0.0f;
    };
    // What a light is worth.
    struct Worth {
        double distance = 0.0; // of its texels to it, times importance
        double loss = 0.0;     // by how much that would grow without it
        float needed = 0.0f;   // handicap with which it would have no texel, m2
    };

    void list_texels(const Request& request);
    Place place_of(const ReflectiveTexel& texel) const;
    void place_anew(const Request& request);
    void move_to_medoids(const Request& request);
    void follow_movers(const raytrace::RayScene& rays);
    void assign();
    void add_up(const Request& request);
    double mean_distance() const;
    void fade();
    void swap(const Request& request);
    bool swap_at_once(const Request& request);
    std::uint32_t farthest_of(std::span<const std::uint32_t> texels) const;
    void place_new(const Request& request);
    void drop(std::size_t light);

    std::vector<FollowedLight> lights_;
    std::vector<Texel> texels_;
    std::vector<NearestPlaces> nearest_; // by texel
    std::vector<Worth> worth_;           // by light
    PlaceGrid grid_;
    float normal_length_ = 1.0f; // m: by which normals are scaled
    double last_distance_ = -1.0;
    std::uint32_t starts_ = 0, seed_ = 0;
    bool fading_ = false;
};

} // namespace sunfleck::gi
