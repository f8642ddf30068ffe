#include "gi_module/splatting/splat_lights.h"

#include "engine/core/hash.h"
#include "engine/core/random.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sunfleck::gi {
namespace {

constexpr float least_cosine_across = 0.5f; // between normals of neighbours on one surface
constexpr std::uint32_t division_seed = 0x5b1a8;
constexpr float newest_share = 0.25f; // of contributions, in the mean over frames
constexpr float unseen_share = 0.01f; // of all importance, for light that nobody sees

bool is_bright(vec3 flux) {
    return is_finite(flux) && luminance(flux) > 0.0f;
}

// From the texels beside it. `texels`: along a side of the square of texels that the light stands for.
void set_footprint(const ReflectiveShadowMap& map, std::size_t index, float texels, PixelLight& light) {
    const std::int32_t side = std::int32_t(map.side), at[2] = {std::int32_t(index) % side, std::int32_t(index) / side};
    for (int axis = 0; axis < 2; ++axis) {
        const ReflectiveTexel* ends[2];
        int steps = 0;
        for (int end = 0; end < 2; ++end) {
            std::int32_t place[2] = {at[0], at[1]};
            place[axis] = std::clamp(place[axis] + 2 * end - 1, 0, side - 1);
            ends[end] = &map.texels[std::size_t(place[1]) * map.side + std::size_t(place[0])];
            // Over an edge there is another surface.
            if (!ends[end]->lit || ends[end]->glass_surfaces != map.texels[index].glass_surfaces ||
                ends[end]->entity != map.texels[index].entity ||
                glm::dot(ends[end]->normal, light.normal) < least_cosine_across || place[axis] == at[axis])
                ends[end] = &map.texels[index];
            else
                ++steps;
        }
        if (steps == 0)
            continue;
        light.wide[axis] = texels / float(steps) * (ends[1]->position - ends[0]->position);
        light.turned[axis] = texels / float(steps) * (ends[1]->mirror - ends[0]->mirror);
    }
}

} // namespace

void SplatLights::update(const SceneView& scene, const SampleSet& samples, const SplatRequest& request) {
    lit_.clear();
    sources_.clear();
    lights_.clear();
    rays_ = 0;
    for (auto& [key, map] : maps_)
        map.used = false;
    const bool movers = !request.movers_are_static && !scene.gpu_scene.draws().empty() &&
                        std::any_of(scene.gpu_scene.draws().begin(), scene.gpu_scene.draws().end(),
                                    [](const scene::DrawItem& item) { return !item.is_static; });
    const bool follows_fixed = request.sampled.fixed || (request.sampled.dynamic && movers);
    const std::size_t emitters = samples.dynamic_emitters().size() * (request.sampled.dynamic ? 1 : 0) +
                                 samples.fixed_emitters().size() * (follows_fixed ? 1 : 0);
    const std::uint32_t side = reflective_map_side(request.settings.splat_rays, emitters);
    if (request.sampled.dynamic)
        for (const Emitter& emitter : samples.dynamic_emitters())
            trace(emitter, true, side, scene, request);
    if (follows_fixed)
        for (const Emitter& emitter : samples.fixed_emitters())
            trace(emitter, false, side, scene, request);
    std::erase_if(maps_, [](const auto& entry) { return !entry.second.used; });
    find_contributions(scene, request);
    find_mean_contribution();
    for (const Lit& lit : lit_)
        add_sources_of(lit, request);
    divide(false, request.settings.splats);
    divide(true, request.settings.glossy_splats);
    for (const bool glossy : {false, true})
        for (const Source& source : sources_)
            if (source.glossy == glossy && (source.dynamic ? request.lit.dynamic : request.lit.fixed))
                source.glossy || request.settings.splat_pattern == SplatPattern::fixed
                    ? place(source, request)
                    : place_followed(source, request, scene.rays);
    vec3 flux(0.0f);
    for (const PixelLight& light : lights_)
        flux += light.flux;
    mean_irradiance_ = scene.rays.static_area() > 0.0f ? luminance(flux) / scene.rays.static_area() : 0.0f;
}

// A map lasts while its emitter and all that it may see stay as they are.
void SplatLights::trace(const Emitter& emitter, bool dynamic, std::uint32_t side, const SceneView& scene,
                        const SplatRequest& request) {
    if (!is_bright(emitter.flux))
        return;
    Map& map = maps_[{emitter.entity.bits(), int(emitter.kind)}];
    map.used = true;
    const std::uint64_t hash = emitter_hash(emitter);
    map.is_new = map.side != side || map.emitter_hash != hash || map.geometry != scene.rays.generation();
    if (map.is_new) {
        map.texels = trace_reflective_map(emitter, side, {}, scene.rays, scene.registry);
        rays_ += std::uint64_t(side) * side;
        map.side = side;
        map.emitter_hash = hash;
        map.geometry = scene.rays.generation();
    }
    trace_refracted(map, emitter, scene, request);
    lit_.push_back(
        {&map, dynamic, hash_combine(request.seed, emitter.entity.index * 16 + std::uint32_t(emitter.kind))});
}

void SplatLights::trace_refracted(Map& map, const Emitter& emitter, const SceneView& scene,
                                  const SplatRequest& request) {
    const std::vector<ReflectiveTexel>& texels = map.texels.texels;
    const Refraction wanted = request.settings.glossy_splats > 0 ? request.settings.splat_refraction : Refraction::off;
    if (!map.is_new && map.refraction == wanted)
        return;
    map.refraction = wanted;
    map.refracted = {};
    const auto glass =
        std::count_if(texels.begin(), texels.end(), [](const ReflectiveTexel& texel) { return texel.is_glass; });
    if (wanted == Refraction::off || glass == 0)
        return;
    map.refracted = trace_refracted_map(emitter, map.texels, wanted, scene.rays, scene.registry);
    rays_ += std::uint64_t(glass);
}

// Of the blocks of all maps, smoothed over frames: they say where lights are, not what they give, and may lag behind.
void SplatLights::find_contributions(const SceneView& scene, const SplatRequest& request) {
    if (request.settings.splat_importance != SplatImportance::contribution || !request.view_projection) {
        for (const Lit& lit : lit_)
            lit.map->contributions.clear();
        seen_hash_ = 0;
        return;
    }
    std::uint64_t hash = hash_bytes(hash_start, &*request.view_projection, sizeof(mat4));
    const std::uint64_t generation = scene.rays.generation();
    hash = hash_bytes(hash, &generation, sizeof generation);
    const bool settled = std::none_of(lit_.begin(), lit_.end(),
                                      [](const Lit& lit) { return lit.map->is_new || lit.map->contributions.empty(); });
    if (settled && hash == seen_hash_)
        return;
    seen_hash_ = hash;
    seen_ = seen_points(*request.view_projection, scene.rays);
    std::vector<BlockLight> lights;
    std::vector<float> all(seen_.size(), 0.0f);
    for (const Lit& lit : lit_) {
        const ReflectiveShadowMap& map = lit.map->texels;
        lights.push_back(trace_block_light(map, contribution_blocks(map.side, lit_.size()), seen_, scene.rays));
        for (std::size_t k = 0; k < all.size(); ++k)
            all[k] += lights.back().at_points[k];
    }
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        const std::vector<float> now = block_contributions(lights[i], all);
        std::vector<float>& kept = lit_[i].map->contributions;
        if (kept.size() != now.size())
            kept = now;
        for (std::size_t k = 0; k < now.size(); ++k)
            kept[k] += newest_share * (now[k] - kept[k]);
    }
}

float SplatLights::Map::contribution(std::size_t texel) const {
    if (contributions.empty())
        return 0.0f;
    const std::size_t blocks = std::size_t(std::lround(std::sqrt(double(contributions.size()))));
    return contributions[texel / side * blocks / side * blocks + texel % side * blocks / side];
}

// Of the flux of all maps.
void SplatLights::find_mean_contribution() {
    double flux = 0.0, seen = 0.0;
    for (const Lit& lit : lit_) {
        const Map& map = *lit.map;
        for (std::size_t i = 0; i < map.texels.texels.size() && !map.contributions.empty(); ++i)
            if (const vec3 now = map.texels.texels[i].diffuse; is_bright(now)) {
                flux += double(luminance(now));
                seen += double(luminance(now) * map.contribution(i));
            }
    }
    mean_contribution_ = flux > 0.0 ? float(seen / flux) : 0.0f;
}

void SplatLights::add_sources_of(const Lit& lit, const SplatRequest& request) {
    if (lit.dynamic) {
        add_sources(*lit.map, true, {true, true}, lit.random, request);
        return;
    }
    if (request.sampled.fixed)
        add_sources(*lit.map, false, {true, request.movers_are_static}, lit.random, request);
    if (request.sampled.dynamic && !request.movers_are_static)
        add_sources(*lit.map, true, {false, true}, hash_combine(lit.random, 1), request);
}

// Of the texels that count: their flux, or what it does for the picture. Lobes are chosen by their peak: flux times
// exponent. Light that nobody sees keeps a hundredth of the importance, so that it is not lost. What light behind glass
// does is not known.
std::vector<float> SplatLights::importance_of(const Source& source, const Texels& texels,
                                              const SplatRequest& request) const {
    const bool by_contribution = mean_contribution_ > 0.0f && source.texels == &source.map->texels;
    std::vector<float> values(source.texels->texels.size(), 0.0f);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const ReflectiveTexel& texel = source.texels->texels[i];
        const vec3 flux = reflected_flux(texel, source.glossy, request.settings.glossy_splats > 0);
        if (!texel.lit || !(texel.on_mover ? texels.movers : texels.fixed) || !is_bright(flux))
            continue;
        values[i] = luminance(flux) * (source.glossy ? texel.exponent : 1.0f);
        if (by_contribution)
            values[i] *= source.map->contribution(i) / mean_contribution_ + unseen_share;
    }
    return values;
}

void SplatLights::add_sources(Map& map, bool dynamic, const Texels& texels, std::uint32_t random,
                              const SplatRequest& request) {
    add_source({&map, &map.texels, hash_combine(random, 3), dynamic, false, {}, 0.0, 0.0, 0}, texels, request);
    if (request.settings.glossy_splats == 0)
        return;
    add_source({&map, &map.texels, hash_combine(random, 2), dynamic, true, {}, 0.0, 0.0, 0}, texels, request);
    add_source({&map, &map.refracted, hash_combine(random, 4), dynamic, true, {}, 0.0, 0.0, 0}, texels, request);
}

void SplatLights::add_source(Source source, const Texels& texels, const SplatRequest& request) {
    std::vector<float> values = importance_of(source, texels, request);
    source.weight = std::accumulate(values.begin(), values.end(), 0.0);
    if (source.weight <= 0.0)
        return;
    if (request.settings.splat_importance == SplatImportance::none)
        for (float& value : values)
            value = value > 0.0f ? 1.0f : 0.0f;
    source.importance = ImportanceMap(values, source.texels->side);
    sources_.push_back(std::move(source));
}

// In proportion to what the sources reflect, each a run of a sequence of `count` equal shares: sources with at least a
// share each have a light, and of fainter ones as many as add up.
void SplatLights::divide(bool glossy, std::uint32_t count) {
    double total = 0.0;
    for (const Source& source : sources_)
        total += source.glossy == glossy ? source.weight : 0.0;
    double before = double(to_unit_float(hash_combine(division_seed, count)));
    for (Source& source : sources_) {
        if (source.glossy != glossy)
            continue;
        const double share = source.weight / total * double(count), after = before + share;
        source.count = std::uint32_t(std::floor(after)) - std::uint32_t(std::floor(before));
        source.share = share;
        before = after;
    }
}

// A fixed pattern of points in the emitter's view, moved to where the importance is.
void SplatLights::place(const Source& source, const SplatRequest& request) {
    const SplattingSettings& settings = request.settings;
    const std::uint32_t levels =
        std::min(settings.splat_importance == SplatImportance::none ? std::uint32_t(0) : settings.splat_warp_levels,
                 source.importance.levels());
    // Of the flux that a texel has; a source that has a light by chance only has the share that it stands for.
    const float texels = float(source.map->side) * float(source.map->side);
    const float scale = texels / float(source.share >= 1.0 ? double(source.count) : source.share);
    for (std::uint32_t i = 0; i < source.count; ++i) {
        const RandomSequence random(SequenceKind::sobol, hash_combine(splat_pattern_seed, source.random), i);
        const WarpedPoint point = source.importance.warp(vec2(random.at(0), random.at(1)), settings.splat_warp, levels);
        const std::size_t index = source.texels->index(point.place);
        if (source.importance.values()[index] <= 0.0f)
            continue;
        const ReflectiveTexel& texel = source.texels->texels[index];
        PixelLight light = pixel_light_of(texel, scale * point.weight, source.glossy, settings.glossy_splats > 0);
        if (source.glossy && settings.splat_footprints)
            set_footprint(*source.texels, index, std::sqrt(scale * point.weight), light);
        light.dynamic = source.dynamic;
        lights_.push_back(light);
    }
}

void SplatLights::place_followed(const Source& source, const SplatRequest& request, const raytrace::RayScene& rays) {
    const SplattingSettings& settings = request.settings;
    FollowedLights& followed = source.map->followed[source.dynamic];
    const std::uint32_t levels =
        std::min(settings.splat_importance == SplatImportance::none ? std::uint32_t(0) : settings.splat_warp_levels,
                 source.importance.levels());
    // Where nothing has happened, they stay as they were.
    std::uint64_t hash = hash_start;
    const auto add = [&](const auto& value) { hash = hash_bytes(hash, &value, sizeof value); };
    add(source.count);
    add(source.random);
    add(settings.splat_importance);
    hash = hash_bytes(hash, source.importance.values().data(), source.importance.values().size_bytes());
    if (std::uint64_t& before = source.map->follows[source.dynamic];
        source.map->is_new || followed.is_fading() || before != hash) {
        followed.update(
            {source.map->texels, source.importance, source.count, source.random, settings.splat_warp, levels, rays});
        before = hash;
    }
    // A source that has a light by chance only has the share that it stands for.
    const float scale = source.share >= 1.0 ? 1.0f : float(1.0 / source.share);
    for (const FollowedLight& from : followed.lights()) {
        PixelLight light;
        light.position = from.place.position;
        light.normal = light.axis = from.place.normal;
        light.flux = scale * (settings.glossy_splats > 0 ? from.diffuse : from.diffuse + from.glossy);
        light.area = scale * from.area;
        light.dynamic = source.dynamic;
        if (is_bright(light.flux))
            lights_.push_back(light);
    }
}

std::vector<SplatLights::SeenTexel> SplatLights::texels(std::size_t most) const {
    std::size_t all = 0;
    float greatest = 0.0f;
    for (const Source& source : sources_)
        for (const float value : source.importance.values()) {
            all += value > 0.0f;
            greatest = std::max(greatest, value);
        }
    const std::size_t stride = std::max<std::size_t>(all / std::max<std::size_t>(most, 1), 1);
    std::vector<SeenTexel> result;
    std::size_t counted = 0;
    for (const Source& source : sources_)
        for (std::size_t i = 0; i < source.importance.values().size(); ++i)
            if (const float value = source.importance.values()[i]; value > 0.0f && counted++ % stride == 0) {
                const ReflectiveTexel& texel = source.texels->texels[i];
                result.push_back({texel.position, texel.diffuse + texel.glossy, value / greatest});
            }
    return result;
}

std::uint64_t SplatLights::memory_bytes() const {
    std::uint64_t bytes = lights_.capacity() * sizeof(PixelLight);
    for (const auto& [key, map] : maps_)
        bytes += (map.texels.texels.size() + map.refracted.texels.size()) * sizeof(ReflectiveTexel);
    return bytes;
}

} // namespace sunfleck::gi
