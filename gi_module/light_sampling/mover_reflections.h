// Light samples (VPLs) of the light that movers reflect. Random walks meet static geometry only, so that static samples
// need not be made again when something moves; what movers reflect comes from here.
//
// Each mover has some samples at fixed places of its surface, which it takes along: a few a frame, since a sample that
// is elsewhere needs a new shadow map. Their flux is what arrives there now from all other samples, by rays past
// everything that stands in the way, times what the surface reflects there. Where that light goes on to, walks from
// these samples follow: reflected samples that keep their places (followed_paths.h).
//
// Movers that block the paths of light (blocked_paths.h) also reflect what they get of this light, from other movers or
// back from the walls (mover_exchange.cpp). Paths go through all others as if they were not there, so that this light
// is not lost.
#pragma once

#include "engine/scene/scene_changes.h"
#include "gi_module/light_sampling/followed_paths.h"
#include "gi_module/light_sampling/light_at_points.h"
#include "gi_module/light_sampling/mover_places.h"

#include <functional>

namespace sunfleck::gi {

// How light of the samples on movers, and of their paths, arrives.
struct MoverLight {
    // Whether paths of light end at this mover.
    std::function<bool(ecs::Entity)> ends_paths;
    // Whether one stands in a sample's path.
    std::function<bool(const LightSample&)> blocked;
    // Of a sample that carries 1 W in each channel, by its index in samples().
    std::function<IncomingLight(const LightSample&, std::uint32_t)> arriving;
};

class MoverReflections {
public:
    // The movers that reflect: those that block light, but lamps.
    static std::vector<const scene::Drawable*> reflecting(const scene::SceneChanges& changes);

    // Chooses places for `count` samples, on the movers that reflect most. They carry no light before the next update.
    void reset(const scene::SceneChanges& changes, const scene::MeshStore& meshes, const raytrace::RayScene& rays,
               std::uint32_t count, const SampleRequest& settings);
    // Follows the movers and the light. A pure function of all updates since reset; once nothing is behind(), of the
    // scene as it is alone. `far`: beyond all geometry, m.
    void update(std::span<const IncomingLight> light, const MoverLight& own, float far,
                const scene::SceneChanges& changes, const raytrace::RayScene& rays);

    // All `dynamic` and reflected once or more; their number and kinds do not change until the next reset.
    const std::vector<LightSample>& samples() const { return samples_; }
    // By sample: whether position or direction changed in the last update. Flux may change with or without them.
    const std::vector<std::uint8_t>& moved() const { return moved_; }
    // Samples that are not yet where they would be if the movers had always been where they are.
    std::uint32_t behind() const;

private:
    // Light by how often it was reflected before, all above in the last.
    static constexpr std::size_t bounce_count = 8;
    static constexpr std::uint32_t places_per_sample = 2; // where arriving light is computed
    using LightByBounce = std::array<vec3, bounce_count>;

    struct Place {
        SurfacePlace where;
        float area = 0.0f;           // that it represents, m2
        LightByBounce from_others{}; // W, reflected there, of what does not come from movers
        LightByBounce flux{};        // and of all light
    };
    struct Mover {
        ecs::Entity entity;
        mat4 matrix{1.0f};
        std::uint32_t first = 0, direct = 0, reflected = 0; // samples on the mover; those of paths follow
        std::vector<Place> places;                          // as many for each sample on the mover, in their order
        LightByBounce flux{};                               // of all places
        std::uint32_t behind = 0;                           // samples on it that are not where they should be
        bool went = true;                                   // since the last update
        bool stepped = false;                               // some of its samples did
        FollowedPaths paths;
        bool started = false;
    };
    class Source;

    void add_mover(const scene::Drawable& drawable, const std::vector<SurfacePart>& parts, std::uint32_t count);
    void find_places(Mover& mover, const raytrace::RayScene& rays);
    std::uint32_t samples_on_movers_behind() const;
    void move_samples();
    void light_places(Mover& mover, std::span<const IncomingLight> light, float far, const raytrace::RayScene& rays);
    void sum_flux(Mover& mover);
    void share_flux(Mover& mover, const MoverLight& own); // from places to all of its samples
    struct Exchange;
    struct Receiver;
    std::vector<Exchange> exchanged_by(const MoverLight& own) const;
    std::vector<Receiver> receivers(const MoverLight& own, const raytrace::RayScene& rays);
    static void receive(std::vector<Receiver>& receivers, const std::vector<Exchange>& exchanged, float far,
                        const raytrace::RayScene& rays);
    vec3 exchanged_flux(const Exchange& one, std::size_t bounces) const;
    void exchange(const MoverLight& own, float far, const raytrace::RayScene& rays);
    // `lit`: what arrives, or stands in the way, may be other than before.
    void follow_paths(Mover& mover, const MoverLight& own, bool lit, const raytrace::RayScene& rays);

    SampleRequest settings_;
    std::vector<Mover> movers_;
    std::vector<LightSample> samples_;
    std::vector<std::uint8_t> moved_;
    struct Wanted {
        vec3 position{0.0f}, normal{0.0f};
    };
    std::vector<Wanted> wanted_;  // by sample on a mover: where it should be
    std::uint32_t on_movers_ = 0; // samples there
    bool placed_ = false;
    std::uint32_t paths_made_ = 0;
    std::uint64_t light_hash_ = 0;
    scene::ChangeCursor cursor_;
};

} // namespace sunfleck::gi
