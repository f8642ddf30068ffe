#include "gi_module/splatting/followed_lights.h"

#include "engine/core/hash.h"
#include "engine/core/jobs.h"
#include "engine/core/random.h"
#include "gi_module/light_sampling/light_sampler.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sunfleck::gi {
namespace {

constexpr int medoid_steps = 3;
constexpr int filling_steps = 4;
constexpr float fade_updates = 16.0f;
// From one update to the next, lights are this much farther from their texels where light has jumped.
constexpr double jump = 1.5;
// What a swap gains, as a share of the squared distances of a light whose texels get a second one: in a flat cell, a
// quarter. It is made where that is more than what it costs by a factor.
constexpr double gained = 0.25;
constexpr double worthwhile = 1.25;
constexpr int settling_steps = 8;
// Of the lights: swaps that begin in an update, and swaps that go on.
constexpr std::uint32_t swaps_per_update = 64, swaps_at_once = 8;

} // namespace

Place FollowedLights::place_of(const ReflectiveTexel& texel) const {
    return {texel.position, normal_length_ * texel.normal, 0.0f};
}

void FollowedLights::list_texels(const Request& request) {
    const std::vector<ReflectiveTexel>& all = request.map.texels;
    const std::span<const float> importance = request.importance.values();
    double area = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i)
        area += importance[i] > 0.0f ? double(all[i].area) : 0.0;
    normal_length_ = float(std::sqrt(area / double(std::max(request.count, 1u))));
    texels_.clear();
    for (std::size_t i = 0; i < all.size(); ++i)
        if (importance[i] > 0.0f)
            texels_.push_back({place_of(all[i]), std::uint32_t(i), importance[i]});
}

void FollowedLights::update(const Request& request) {
    list_texels(request);
    fading_ = false;
    if (texels_.empty() || request.count == 0) {
        lights_.clear();
        return;
    }
    follow_movers(request.rays);
    fade();
    if (lights_.size() > request.count + request.count / 8)
        lights_.clear(); // other settings
    if (!lights_.empty())
        assign();
    while (lights_.size() > request.count) {
        const auto least = std::min_element(worth_.begin(), worth_.end(),
                                            [](const Worth& a, const Worth& b) { return a.loss < b.loss; });
        drop(std::size_t(least - worth_.begin()));
        assign();
    }
    const std::size_t possible = std::min<std::size_t>(request.count, texels_.size());
    if (lights_.size() * 2 < possible || request.seed != seed_ || mean_distance() > jump * last_distance_)
        place_anew(request);
    last_distance_ = mean_distance();
    add_up(request);
    if (texels_.size() > lights_.size()) {
        swap(request);
        place_new(request);
    }
    for (const FollowedLight& light : lights_)
        fading_ |= light.step != 0.0f;
}

// Those on movers go with them, and are gone with them.
void FollowedLights::follow_movers(const raytrace::RayScene& rays) {
    for (std::size_t i = lights_.size(); i-- > 0;) {
        ReflectiveTexel& place = lights_[i].place;
        if (!place.on_mover)
            continue;
        const auto point = rays.surface_on(place.entity, place.primitive, place.u, place.v);
        if (!point) {
            lights_.erase(lights_.begin() + std::ptrdiff_t(i));
            continue;
        }
        const float side = place.on_front ? 1.0f : -1.0f;
        place.position =
            offset_from_surface(point->position, side * point->geometric_normal, rays, raytrace::Scope::everything);
        place.normal = side * point->shading_normal;
    }
}

void FollowedLights::fade() {
    for (std::size_t i = lights_.size(); i-- > 0;) {
        FollowedLight& light = lights_[i];
        ++light.age;
        if (light.step > 0.0f && light.area <= 0.0f) {
            lights_.erase(lights_.begin() + std::ptrdiff_t(i));
            continue;
        }
        light.handicap += light.step;
        if (light.handicap <= 0.0f)
            light.handicap = light.step = 0.0f;
    }
}

void FollowedLights::drop(std::size_t light) {
    lights_.erase(lights_.begin() + std::ptrdiff_t(light));
}

void FollowedLights::assign() {
    std::vector<Place> places;
    places.reserve(lights_.size());
    for (const FollowedLight& light : lights_) {
        places.push_back(place_of(light.place));
        places.back().handicap = light.handicap;
    }
    grid_.build(places, normal_length_);
    nearest_.resize(texels_.size());
    parallel_for_chunks(texels_.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            nearest_[i] = grid_.find(texels_[i].place);
    });
    worth_.assign(lights_.size(), {});
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        const NearestPlaces& nearest = nearest_[i];
        Worth& worth = worth_[nearest.index[0]];
        const double importance = double(texels_[i].importance);
        worth.distance += importance * double(nearest.first);
        worth.loss += importance * double(nearest.second - nearest.first);
        worth.needed = std::max(worth.needed, nearest.second - nearest.first + lights_[nearest.index[0]].handicap);
    }
}

double FollowedLights::mean_distance() const {
    double distance = 0.0, importance = 0.0;
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        distance += double(texels_[i].importance) * double(nearest_[i].first - lights_[nearest_[i].index[0]].handicap);
        importance += double(texels_[i].importance);
    }
    return distance / importance;
}

void FollowedLights::add_up(const Request& request) {
    for (FollowedLight& light : lights_) {
        light.diffuse = light.glossy = vec3(0.0f);
        light.area = 0.0f;
    }
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        const ReflectiveTexel& texel = request.map.texels[texels_[i].index];
        for (std::uint32_t k = 0; k < nearest_[i].count; ++k) {
            FollowedLight& light = lights_[nearest_[i].index[k]];
            light.diffuse += nearest_[i].share[k] * texel.diffuse;
            light.glossy += nearest_[i].share[k] * texel.glossy;
            light.area += nearest_[i].share[k] * texel.area;
        }
    }
}

void FollowedLights::place_anew(const Request& request) {
    ++starts_;
    seed_ = request.seed;
    lights_.clear();
    std::vector<bool> taken(request.map.texels.size(), false);
    for (std::uint32_t i = 0; i < request.count; ++i) {
        const RandomSequence random(SequenceKind::sobol, hash_combine(splat_pattern_seed, request.seed), i);
        const WarpedPoint point =
            request.importance.warp(vec2(random.at(0), random.at(1)), request.warp, request.warp_levels);
        const std::size_t index = request.map.index(point.place);
        if (taken[index] || request.importance.values()[index] <= 0.0f)
            continue;
        taken[index] = true;
        lights_.push_back({std::uint32_t(index), request.map.texels[index]});
    }
    if (lights_.empty())
        lights_.push_back({texels_.front().index, request.map.texels[texels_.front().index]});
    assign();
    for (int step = 0; step < filling_steps && lights_.size() < std::min<std::size_t>(request.count, texels_.size());
         ++step) {
        place_new(request);
        for (FollowedLight& light : lights_)
            light.handicap = light.step = 0.0f;
        assign();
    }
    for (int step = 0; step < settling_steps && swap_at_once(request); ++step)
        ;
    for (int step = 0; step < medoid_steps; ++step) {
        move_to_medoids(request);
        assign();
    }
}

// Swaps that need not fade, as nobody has seen the lights yet. False: there is none to make.
bool FollowedLights::swap_at_once(const Request& request) {
    swap(request);
    const std::size_t before = lights_.size();
    std::erase_if(lights_, [](const FollowedLight& light) { return light.step > 0.0f; });
    const bool any = lights_.size() < before;
    if (any) {
        assign();
        place_new(request);
        for (FollowedLight& light : lights_)
            light.handicap = light.step = 0.0f;
        assign();
    }
    return any;
}

// Each light to that of its texels which is nearest to their mean.
void FollowedLights::move_to_medoids(const Request& request) {
    struct Mean {
        glm::dvec3 position{0.0}, normal{0.0};
        double importance = 0.0;
        float distance = 1e30f;
        std::uint32_t texel = 0;
    };
    std::vector<Mean> means(lights_.size());
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        Mean& mean = means[nearest_[i].index[0]];
        mean.position += double(texels_[i].importance) * glm::dvec3(texels_[i].place.position);
        mean.normal += double(texels_[i].importance) * glm::dvec3(texels_[i].place.normal);
        mean.importance += double(texels_[i].importance);
    }
    for (std::size_t i = 0; i < texels_.size(); ++i) {
        Mean& mean = means[nearest_[i].index[0]];
        const Place centre{vec3(mean.position / mean.importance), vec3(mean.normal / mean.importance), 0.0f};
        const float distance = squared_distance(texels_[i].place, centre);
        if (distance < mean.distance) {
            mean.distance = distance;
            mean.texel = texels_[i].index;
        }
    }
    for (std::size_t i = 0; i < lights_.size(); ++i)
        if (means[i].importance > 0.0)
            lights_[i] = {means[i].texel, request.map.texels[means[i].texel]};
}

// Lights that are missed least begin to fade out where others would be worth more.
void FollowedLights::swap(const Request& request) {
    const std::size_t going = std::size_t(
        std::count_if(lights_.begin(), lights_.end(), [](const FollowedLight& light) { return light.step != 0.0f; }));
    if (lights_.size() < request.count || going * swaps_at_once >= lights_.size())
        return;
    std::vector<std::uint32_t> cheap(lights_.size()), poor;
    std::iota(cheap.begin(), cheap.end(), 0u);
    poor = cheap;
    const std::size_t swaps = std::min<std::size_t>(lights_.size() / swaps_per_update + 1, lights_.size() / 2);
    std::partial_sort(cheap.begin(), cheap.begin() + std::ptrdiff_t(swaps), cheap.end(),
                      [&](std::uint32_t a, std::uint32_t b) {
                          const double x = lights_[a].step != 0.0f ? 1e300 : worth_[a].loss,
                                       y = lights_[b].step != 0.0f ? 1e300 : worth_[b].loss;
                          return x != y ? x < y : a < b;
                      });
    std::partial_sort(
        poor.begin(), poor.begin() + std::ptrdiff_t(swaps), poor.end(), [&](std::uint32_t a, std::uint32_t b) {
            return worth_[a].distance != worth_[b].distance ? worth_[a].distance > worth_[b].distance : a < b;
        });
    for (std::size_t i = 0; i < swaps; ++i) {
        FollowedLight& light = lights_[cheap[i]];
        if (light.step != 0.0f || gained * worth_[poor[i]].distance <= worthwhile * worth_[cheap[i]].loss)
            break;
        light.step = std::max(worth_[cheap[i]].needed, std::numeric_limits<float>::min()) / fade_updates;
    }
}

// Of a light's texels, in the middle of those that are farthest from it.
std::uint32_t FollowedLights::farthest_of(std::span<const std::uint32_t> mine) const {
    // From the texel that is worst off to the mean of those that are nearer to it than to their light.
    const auto distance_of = [&](std::uint32_t i) { return texels_[i].importance * nearest_[i].first; };
    const std::uint32_t farthest = *std::max_element(
        mine.begin(), mine.end(), [&](std::uint32_t a, std::uint32_t b) { return distance_of(a) < distance_of(b); });
    glm::dvec3 mean(0.0);
    double total = 0.0;
    for (const std::uint32_t i : mine)
        if (squared_distance(texels_[i].place, texels_[farthest].place) <= nearest_[i].first) {
            mean += double(texels_[i].importance) * glm::dvec3(texels_[i].place.position);
            total += double(texels_[i].importance);
        }
    const vec3 centre = total > 0.0 ? vec3(mean / total) : texels_[farthest].place.position;
    std::uint32_t chosen = farthest;
    float least = std::numeric_limits<float>::max();
    for (const std::uint32_t i : mine) {
        const vec3 d = texels_[i].place.position - centre;
        if (nearest_[i].first > 0.0f && glm::dot(d, d) < least) {
            least = glm::dot(d, d);
            chosen = i;
        }
    }
    return chosen;
}

// Lights that there is room for begin to fade in where texels are farthest from theirs.
void FollowedLights::place_new(const Request& request) {
    const std::size_t room = request.count > lights_.size() ? request.count - lights_.size() : 0;
    if (room == 0)
        return;
    const std::size_t hosts = lights_.size(), placed = std::min(room, hosts);
    std::vector<std::vector<std::uint32_t>> owned(hosts);
    for (std::size_t i = 0; i < texels_.size(); ++i)
        owned[nearest_[i].index[0]].push_back(std::uint32_t(i));
    std::vector<std::uint32_t> poor(hosts);
    std::iota(poor.begin(), poor.end(), 0u);
    std::partial_sort(
        poor.begin(), poor.begin() + std::ptrdiff_t(placed), poor.end(), [&](std::uint32_t a, std::uint32_t b) {
            return worth_[a].distance != worth_[b].distance ? worth_[a].distance > worth_[b].distance : a < b;
        });
    for (std::size_t k = 0; k < placed; ++k) {
        const std::vector<std::uint32_t>& mine = owned[poor[k]];
        if (mine.size() < 2)
            continue;
        const std::uint32_t chosen = farthest_of(mine);
        FollowedLight light{texels_[chosen].index, request.map.texels[texels_[chosen].index]};
        for (const std::uint32_t i : mine)
            light.handicap = std::max(light.handicap, nearest_[i].first + 0.5f * nearest_[i].second -
                                                          squared_distance(texels_[i].place, texels_[chosen].place));
        light.step = -light.handicap / fade_updates;
        lights_.push_back(light);
    }
}

} // namespace sunfleck::gi
