#include "gi_module/splatting/splat_lights.h"

#include "engine/core/hash.h"
#include "engine/core/random.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t least_side = 4, greatest_side = 1024; // texels of a map
constexpr std::uint32_t pattern_seed = 0x5b1a7, division_seed = 0x5b1a8;

// Of everything about an emitter that its map depends on.
std::uint64_t hash_of(const Emitter& emitter) {
    std::uint64_t hash = hash_start;
    const auto add = [&](const auto& value) { hash = hash_bytes(hash, &value, sizeof value); };
    add(emitter.matrix);
    add(emitter.flux);
    add(emitter.width);
    add(emitter.height);
    add(emitter.radius);
    add(emitter.area);
    add(emitter.inner_cosine);
    add(emitter.outer_cosine);
    add(emitter.scene_radius);
    add(emitter.scene_centre);
    add(emitter.map.rotation);
    return hash_bytes(hash, emitter.corners.data(), emitter.corners.size() * sizeof(vec3));
}

std::uint32_t side_of_maps(std::uint32_t rays, std::size_t emitters) {
    const double texels = double(rays) / double(std::max<std::size_t>(emitters, 1));
    return std::clamp(std::bit_floor(std::uint32_t(std::sqrt(texels))), least_side, greatest_side);
}

bool is_bright(vec3 flux) {
    return is_finite(flux) && luminance(flux) > 0.0f;
}

// Of a texel, in a lobe or diffusely; `gloss_apart`: gloss is not diffuse.
vec3 reflected_flux(const ReflectiveTexel& texel, bool glossy, bool gloss_apart) {
    if (glossy)
        return texel.glossy;
    return gloss_apart ? texel.diffuse : texel.diffuse + texel.glossy;
}

} // namespace

void SplatLights::update(const SceneView& scene, const SampleSet& samples, const SplatRequest& request) {
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
    const std::uint32_t side = side_of_maps(request.settings.splat_rays, emitters);
    if (request.sampled.dynamic)
        for (const Emitter& emitter : samples.dynamic_emitters())
            follow(emitter, true, side, scene, request);
    if (follows_fixed)
        for (const Emitter& emitter : samples.fixed_emitters())
            follow(emitter, false, side, scene, request);
    std::erase_if(maps_, [](const auto& entry) { return !entry.second.used; });
    divide(false, request.settings.splats);
    divide(true, request.settings.glossy_splats);
    for (const bool glossy : {false, true})
        for (const Source& source : sources_)
            if (source.glossy == glossy && (source.dynamic ? request.lit.dynamic : request.lit.fixed))
                place(source, request);
    vec3 flux(0.0f);
    for (const PixelLight& light : lights_)
        flux += light.flux;
    mean_irradiance_ = scene.rays.static_area() > 0.0f ? luminance(flux) / scene.rays.static_area() : 0.0f;
}

// A map lasts while its emitter and all that it may see stay as they are.
void SplatLights::follow(const Emitter& emitter, bool dynamic, std::uint32_t side, const SceneView& scene,
                         const SplatRequest& request) {
    if (!is_bright(emitter.flux))
        return;
    Map& map = maps_[{emitter.entity.bits(), int(emitter.kind)}];
    map.used = true;
    const std::uint64_t hash = hash_of(emitter);
    if (map.side != side || map.emitter_hash != hash || map.geometry != scene.rays.generation()) {
        map.texels = trace_reflective_map(emitter, side, {}, scene.rays, scene.registry);
        rays_ += std::uint64_t(side) * side;
        map.side = side;
        map.emitter_hash = hash;
        map.geometry = scene.rays.generation();
    }
    const std::uint32_t random = hash_combine(request.seed, emitter.entity.index * 16 + std::uint32_t(emitter.kind));
    if (dynamic) {
        add_sources(map, true, {true, true}, random, request);
        return;
    }
    if (request.sampled.fixed)
        add_sources(map, false, {true, request.movers_are_static}, random, request);
    if (request.sampled.dynamic && !request.movers_are_static)
        add_sources(map, true, {false, true}, hash_combine(random, 1), request);
}

// Lobes are chosen by their peak: flux times exponent.
void SplatLights::add_sources(const Map& map, bool dynamic, const Texels& texels, std::uint32_t random,
                              const SplatRequest& request) {
    const bool gloss_apart = request.settings.glossy_splats > 0;
    for (const bool glossy : {false, true}) {
        std::vector<float> values(map.texels.texels.size(), 0.0f);
        Source source{&map, hash_combine(random, glossy ? 2 : 3), dynamic, glossy, {}, 0.0, 0.0, 0};
        for (std::size_t i = 0; i < values.size(); ++i) {
            const ReflectiveTexel& texel = map.texels.texels[i];
            const vec3 flux = reflected_flux(texel, glossy, gloss_apart);
            if (!texel.lit || !(texel.on_mover ? texels.movers : texels.fixed) || !is_bright(flux))
                continue;
            const float weight = luminance(flux) * (glossy ? texel.exponent : 1.0f);
            source.weight += double(weight);
            values[i] = request.settings.splat_importance == SplatImportance::none ? 1.0f : weight;
        }
        if (source.weight <= 0.0 || (glossy && !gloss_apart))
            continue;
        source.importance = ImportanceMap(values, map.side);
        sources_.push_back(std::move(source));
    }
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
        const RandomSequence random(SequenceKind::sobol, hash_combine(pattern_seed, source.random), i);
        const WarpedPoint point = source.importance.warp(vec2(random.at(0), random.at(1)), settings.splat_warp, levels);
        const std::size_t index = source.map->texels.index(point.place);
        if (source.importance.values()[index] <= 0.0f)
            continue;
        const ReflectiveTexel& texel = source.map->texels.texels[index];
        PixelLight light;
        light.position = texel.position;
        light.normal = texel.normal;
        light.axis = source.glossy ? texel.mirror : texel.normal;
        light.exponent = source.glossy ? texel.exponent : 1.0f;
        light.flux = scale * point.weight * reflected_flux(texel, source.glossy, settings.glossy_splats > 0);
        light.area = scale * point.weight * texel.area;
        light.dynamic = source.dynamic;
        lights_.push_back(light);
    }
}

std::uint64_t SplatLights::memory_bytes() const {
    std::uint64_t bytes = lights_.capacity() * sizeof(PixelLight);
    for (const auto& [key, map] : maps_)
        bytes += map.texels.texels.size() * sizeof(ReflectiveTexel);
    return bytes;
}

} // namespace sunfleck::gi
