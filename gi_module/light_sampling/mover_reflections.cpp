#include "gi_module/light_sampling/mover_reflections.h"

#include "engine/core/divide_up.h"
#include "engine/core/hash.h"
#include "engine/core/jobs.h"
#include "gi_module/light_sampling/light_sampler.h"
#include "gi_module/light_sampling/mover_places.h"
#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <tuple>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t follow_frames = 5;           // within which all samples are where their movers have taken them
constexpr std::uint32_t max_resampled_per_mover = 4; // per mover and frame
constexpr std::uint32_t least_samples = 6;           // of a mover that has any
constexpr float path_share = 0.4f;                   // of a mover's samples

// What part of the arriving light leaves a mover in the end: the rest meets another part of it, which is lit alike.
// Boxes, which get what walls and movers send back besides (mover_exchange.cpp), hide nothing of themselves.
vec3 leaving_share(vec3 reflectance, float hidden) {
    return hidden < 1.0f ? reflectance * (1.0f - hidden) / (vec3(1.0f) - hidden * reflectance) : vec3(0.0f);
}

} // namespace

// Light leaves a mover from its samples, by Lambert's law.
class MoverReflections::Source final : public PathSource {
public:
    Source(const Mover& mover, std::span<const LightSample> samples, std::uint32_t bounces)
        : mover_(mover), samples_(samples), bounces_(bounces) {}

    EmittedRay ray(const float numbers[4]) const override {
        const LightSample& sample = chosen(numbers);
        EmittedRay ray;
        ray.origin = sample.position;
        ray.normal = sample.normal;
        ray.direction = sample_cosine_direction(sample.normal, numbers[2], numbers[3]);
        return ray;
    }
    bool emits_towards(vec3 normal, vec3 direction) const override { return glm::dot(normal, direction) > 0.0f; }
    ecs::Entity entity() const override { return mover_.entity; }
    const mat4& matrix() const override { return mover_.matrix; }
    vec3 flux(std::uint32_t reflections) const override {
        vec3 sum(0.0f);
        for (std::size_t b = 0; b < bounce_count && b + 1 + reflections <= bounces_; ++b)
            sum += mover_.flux[b];
        return sum;
    }
    vec3 weight(const float numbers[4]) const override { return chosen(numbers).flux; }
    bool weights_vary() const override { return true; }
    bool is_extended() const override { return true; }

private:
    const LightSample& chosen(const float numbers[4]) const {
        return samples_[std::min(std::size_t(numbers[0] * float(samples_.size())), samples_.size() - 1)];
    }

    const Mover& mover_;
    std::span<const LightSample> samples_;
    std::uint32_t bounces_;
};

std::vector<const scene::Drawable*> MoverReflections::reflecting(const scene::SceneChanges& changes) {
    std::vector<const scene::Drawable*> result;
    for (const scene::Drawable* drawable : changes.all)
        if (!drawable->is_static && !drawable->is_lamp && drawable->casts_shadow &&
            luminance(mean_reflectance(drawable->material)) > 0.0f)
            result.push_back(drawable);
    return result;
}

void MoverReflections::reset(const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                             const raytrace::RayScene& rays, std::uint32_t count, const SampleRequest& settings) {
    settings_ = settings;
    movers_.clear();
    samples_.clear();
    wanted_.clear();
    paths_made_ = 0;
    light_hash_ = 0;
    cursor_ = {};
    on_movers_ = 0;
    placed_ = false;
    std::vector<std::pair<double, const scene::Drawable*>> largest;
    for (const scene::Drawable* drawable : reflecting(changes))
        largest.emplace_back(double(luminance(mean_reflectance(drawable->material))) *
                                 surface_area(meshes[drawable->mesh], drawable->matrix),
                             drawable);
    std::erase_if(largest, [](const auto& one) { return !(one.first > 0.0); });
    std::stable_sort(largest.begin(), largest.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    largest.resize(std::min<std::size_t>(largest.size(), count / least_samples));
    if (largest.empty())
        return;
    std::vector<double> weights;
    weights.reserve(largest.size());
    for (const auto& [weight, drawable] : largest)
        weights.push_back(weight);
    const std::uint32_t spare = count - least_samples * std::uint32_t(largest.size());
    std::vector<std::uint32_t> counts(largest.size(), 0);
    if (spare >= largest.size())
        counts = apportion(weights, spare);
    for (std::size_t i = 0; i < largest.size(); ++i) {
        const scene::Drawable& drawable = *largest[i].second;
        const std::uint32_t all = counts[i] + least_samples,
                            direct = settings_.bounces > 1 ? all - std::uint32_t(float(all) * path_share) : all;
        const PlaceRequest request{direct, places_per_sample, hash_combine(settings_.seed, 0x3070u + std::uint32_t(i))};
        add_mover(drawable, choose_places(drawable, meshes[drawable.mesh], rays, request), all);
    }
    moved_.assign(samples_.size(), 1);
}

// `count`: samples on the mover, one for each part, and of its paths.
void MoverReflections::add_mover(const scene::Drawable& drawable, const std::vector<SurfacePart>& parts,
                                 std::uint32_t count) {
    Mover mover;
    mover.entity = drawable.entity;
    mover.matrix = drawable.matrix;
    mover.first = std::uint32_t(samples_.size());
    mover.direct = std::uint32_t(parts.size());
    mover.reflected = settings_.bounces > 1 && !parts.empty() ? count - mover.direct : 0;
    LightSample sample;
    sample.dynamic = true;
    sample.emitter = mover.entity;
    sample.position = vec3(drawable.matrix[3]);
    sample.bounce = 1;
    sample.on_mover = true;
    for (const SurfacePart& part : parts) {
        sample.radius = std::sqrt(part.area / pi);
        samples_.push_back(sample);
        for (const SurfacePlace& place : part.places)
            mover.places.push_back({place, part.area / float(part.places.size()), {}});
    }
    sample.on_mover = false;
    sample.radius = 0.0f;
    sample.bounce = 2;
    samples_.resize(samples_.size() + mover.reflected, sample);
    on_movers_ += mover.direct;
    wanted_.resize(samples_.size());
    movers_.push_back(std::move(mover));
}

void MoverReflections::update(std::span<const IncomingLight> light, const MoverLight& own, float far,
                              const scene::SceneChanges& changes, const raytrace::RayScene& rays) {
    moved_.assign(samples_.size(), 0);
    static_assert(sizeof(IncomingLight) == sizeof(shared::LightRow) + 12, "it is hashed, so it has no padding");
    const std::uint64_t hash = hash_bytes(hash_start, light.data(), light.size_bytes());
    const bool same_light = hash == light_hash_ && cursor_.follows(changes) && changes.drawables.empty();
    light_hash_ = hash;
    cursor_.saw(changes);
    for (Mover& mover : movers_) {
        mover.went = false;
        if (same_light)
            continue;
        for (const scene::Drawable* drawable : changes.all)
            if (drawable->entity == mover.entity) {
                mover.went = mover.matrix != drawable->matrix;
                mover.matrix = drawable->matrix;
            }
        find_places(mover, rays);
        light_places(mover, light, far, rays);
    }
    if (same_light && behind() == 0)
        return;
    move_samples();
    for (Mover& mover : movers_)
        follow_paths(mover, own, !same_light, rays);
    exchange(own, far, rays);
}

std::uint32_t MoverReflections::behind() const {
    std::uint32_t sum = samples_on_movers_behind();
    for (const Mover& mover : movers_)
        sum += mover.paths.unsettled();
    return sum;
}

std::uint32_t MoverReflections::samples_on_movers_behind() const {
    std::uint32_t sum = 0;
    for (const Mover& mover : movers_)
        sum += mover.behind;
    return sum;
}

// One that changes its shape goes elsewhere, too.
void MoverReflections::find_places(Mover& mover, const raytrace::RayScene& rays) {
    for (std::uint32_t i = 0; i < mover.direct; ++i) {
        const Place& place = mover.places[std::size_t(i) * places_per_sample]; // the first is the sample's own
        const auto point = rays.surface_on(mover.entity, place.where.triangle, place.where.u, place.where.v);
        if (!point) // it is gone; no light arrives there
            continue;
        const vec3 normal = place.where.side * point->geometric_normal;
        Wanted& wanted = wanted_[mover.first + i];
        const Wanted now{offset_from_surface(point->on_triangle, normal, rays, raytrace::Scope::everything), normal};
        mover.went = mover.went || now.position != wanted.position || now.normal != wanted.normal;
        wanted = now;
    }
}

// The brightest of those that are farthest behind, counted in the discs that they represent, come first. Those that are
// more than a disc away shine where their mover is not any more, and go at once.
void MoverReflections::move_samples() {
    struct Late {
        bool waits;
        float order;
        std::uint32_t sample;
        Mover* mover;
    };
    std::vector<Late> late;
    for (Mover& mover : movers_) {
        mover.behind = 0;
        mover.stepped = false;
        for (std::uint32_t i = mover.first; i < mover.first + mover.direct; ++i) {
            const LightSample& sample = samples_[i];
            const float distance = glm::length(wanted_[i].position - sample.position) / std::max(sample.radius, 1e-6f) +
                                   glm::length(wanted_[i].normal - sample.normal);
            if (distance > 0.0f)
                late.push_back({distance < 1.0f, -distance * luminance(sample.flux), i, &mover});
        }
    }
    std::sort(late.begin(), late.end(), [](const Late& a, const Late& b) {
        return std::tie(a.waits, a.order, a.sample) < std::tie(b.waits, b.order, b.sample);
    });
    const std::size_t most = placed_ ? divide_up(on_movers_, follow_frames) : late.size();
    placed_ = true;
    for (std::size_t k = 0; k < late.size(); ++k) {
        const std::uint32_t i = late[k].sample;
        if (k >= most && late[k].waits) {
            ++late[k].mover->behind;
            continue;
        }
        samples_[i].position = wanted_[i].position;
        samples_[i].normal = wanted_[i].normal;
        moved_[i] = 1;
        late[k].mover->stepped = true;
    }
}

void MoverReflections::light_places(Mover& mover, std::span<const IncomingLight> light, float far,
                                    const raytrace::RayScene& rays) {
    std::vector<std::optional<PlaceNow>> now;
    Bounds bounds;
    for (const Place& place : mover.places) {
        now.push_back(place_now(mover.entity, place.where, rays));
        if (now.back())
            bounds.add(now.back()->point);
    }
    const LightAtPoints arriving(light, bounds, far, rays);
    parallel_for_chunks(mover.places.size(), 2, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Place& place = mover.places[i];
            place.from_others = {};
            if (!now[i])
                continue;
            arriving.gather(now[i]->point, now[i]->normal, [&](std::size_t k, vec3 e) {
                place.from_others[std::min<std::size_t>(light[k].bounce, bounce_count - 1)] += e;
            });
            const vec3 leaving =
                place.area * leaving_share(now[i]->reflectance, hidden_share(mover.entity, *now[i], rays));
            for (vec3& flux : place.from_others)
                flux *= leaving;
        }
    });
}

// From places to the samples and the mover.
void MoverReflections::sum_flux(Mover& mover) {
    mover.flux = {};
    for (std::uint32_t i = 0; i < mover.direct; ++i) {
        LightSample& sample = samples_[mover.first + i];
        sample.flux = vec3(0.0f);
        for (std::uint32_t k = 0; k < places_per_sample; ++k)
            for (std::size_t b = 0; b < bounce_count; ++b) {
                const vec3 flux = mover.places[std::size_t(i) * places_per_sample + k].flux[b];
                sample.flux += flux;
                mover.flux[b] += flux;
            }
    }
}

void MoverReflections::follow_paths(Mover& mover, const MoverLight& own, bool lit, const raytrace::RayScene& rays) {
    for (Place& place : mover.places)
        place.flux = place.from_others;
    sum_flux(mover);
    if (mover.reflected == 0 || mover.direct == 0)
        return;
    const std::size_t first = mover.first + mover.direct;
    const std::span<LightSample> reflected = std::span(samples_).subspan(first, mover.reflected);
    const Source source(mover, std::span(samples_).subspan(mover.first, mover.direct), settings_.bounces);
    const PathSpace space{settings_,  rays,        settings_.bounces - 1,
                          2,          paths_made_, std::span(moved_).subspan(first, mover.reflected),
                          own.blocked};
    if (!mover.started)
        mover.paths.reset(source, mover.reflected, hash_combine(settings_.seed, 0x3a70u + mover.first));
    if (lit || mover.behind > 0 || mover.stepped)
        mover.paths.land(source, space);
    if (!mover.started) {
        mover.paths.fill_gaps(source, mover.reflected, space, reflected);
    } else if (mover.went || mover.behind > 0 || mover.stepped) {
        mover.paths.validate(source, rays);
        mover.paths.fill_gaps(source, max_resampled_per_mover, space, reflected);
    } else {
        mover.paths.settle(source, max_resampled_per_mover, space, reflected);
    }
    mover.started = true;
    mover.paths.share_flux(source, reflected, own.blocked);
}

void MoverReflections::share_flux(Mover& mover, const MoverLight& own) {
    sum_flux(mover);
    if (mover.reflected > 0 && mover.direct > 0)
        mover.paths.share_flux(Source(mover, std::span(samples_).subspan(mover.first, mover.direct), settings_.bounces),
                               std::span(samples_).subspan(mover.first + mover.direct, mover.reflected), own.blocked);
}

} // namespace sunfleck::gi
