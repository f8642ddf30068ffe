// What movers reflect of each other's light, and of their own that walls send back. Light that was reflected b times on
// its way comes from light that was reflected less, so that one pass in the order of b finds all of it.
#include "engine/core/jobs.h"
#include "gi_module/light_sampling/mover_reflections.h"

#include <algorithm>

namespace sunfleck::gi {

// Light of one sample, as it arrives at other movers.
struct MoverReflections::Exchange {
    IncomingLight light;           // of 1 W
    std::uint32_t mover = 0;       // whose it is
    std::uint32_t place = 0;       // of a sample on a mover: its first one
    std::uint32_t reflections = 0; // since it left the mover: 0 for samples on it
    vec3 carried{1.0f};            // of all that left the mover
};

std::vector<MoverReflections::Exchange> MoverReflections::exchanged_by(const MoverLight& own) const {
    std::vector<Exchange> result;
    for (std::uint32_t m = 0; m < movers_.size(); ++m) {
        const Mover& mover = movers_[m];
        for (std::uint32_t k = 0; k < mover.direct + mover.reflected; ++k) {
            const bool on_mover = k < mover.direct;
            const LightSample& sample = samples_[mover.first + k];
            if (sample.flux == vec3(0.0f) || own.blocked(sample))
                continue;
            Exchange one{own.arriving(sample, mover.first + k), m};
            if (on_mover) {
                one.place = k * places_per_sample;
            } else {
                one.reflections = mover.paths.reflections(k - mover.direct);
                one.carried = mover.paths.carried(k - mover.direct);
            }
            result.push_back(one);
        }
    }
    return result;
}

// A place on a mover that blocks paths.
struct MoverReflections::Receiver {
    Mover* mover = nullptr;
    Place* place = nullptr;
    PlaceNow now;
    vec3 reflected{0.0f};     // W for 1 W/m2
    std::vector<float> light; // by exchanged sample: W/m2 for 1 W
};

std::vector<MoverReflections::Receiver> MoverReflections::receivers(const MoverLight& own,
                                                                    const raytrace::RayScene& rays) {
    std::vector<Receiver> result;
    for (Mover& mover : movers_)
        if (own.ends_paths(mover.entity))
            for (Place& place : mover.places)
                if (const auto now = place_now(mover.entity, place.where, rays))
                    result.push_back({&mover, &place, *now, place.area * now->reflectance, {}});
    return result;
}

// How much of each sample's light arrives at each place.
void MoverReflections::receive(std::vector<Receiver>& receivers, const std::vector<Exchange>& exchanged, float far,
                               const raytrace::RayScene& rays) {
    std::vector<IncomingLight> light;
    light.reserve(exchanged.size());
    for (const Exchange& one : exchanged)
        light.push_back(one.light);
    Bounds bounds;
    for (const Receiver& to : receivers)
        bounds.add(to.now.point);
    const LightAtPoints arriving(light, bounds, far, rays);
    parallel_for_chunks(receivers.size(), 2, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Receiver& to = receivers[i];
            to.light.assign(exchanged.size(), 0.0f);
            arriving.gather(to.now.point, to.now.normal, [&](std::size_t k, vec3 e) { to.light[k] += e.x; });
        }
    });
}

void MoverReflections::exchange(const MoverLight& own, float far, const raytrace::RayScene& rays) {
    std::vector<Receiver> all = receivers(own, rays);
    if (all.empty() || settings_.bounces < 2)
        return;
    const std::vector<Exchange> exchanged = exchanged_by(own);
    receive(all, exchanged, far, rays);
    std::vector<vec3> arriving(exchanged.size());
    for (std::size_t b = 1; b < std::min<std::size_t>(settings_.bounces, bounce_count); ++b) {
        for (std::size_t k = 0; k < exchanged.size(); ++k)
            arriving[k] = exchanged_flux(exchanged[k], b);
        for (Receiver& to : all)
            for (std::size_t k = 0; k < exchanged.size(); ++k) {
                const vec3 flux = to.reflected * (to.light[k] * arriving[k]);
                to.place->flux[b] += flux;
                to.mover->flux[b] += flux;
            }
    }
    for (Mover& mover : movers_)
        share_flux(mover, own);
}

// W, of the light that arrives after b reflections.
vec3 MoverReflections::exchanged_flux(const Exchange& one, std::size_t b) const {
    const Mover& from = movers_[one.mover];
    if (b < one.reflections + 1u)
        return vec3(0.0f);
    const std::size_t before = b - 1 - one.reflections;
    if (one.reflections > 0)
        return one.carried * from.flux[before];
    vec3 sum(0.0f);
    for (std::uint32_t k = 0; k < places_per_sample; ++k)
        sum += from.places[one.place + k].flux[before];
    return sum;
}

} // namespace sunfleck::gi
