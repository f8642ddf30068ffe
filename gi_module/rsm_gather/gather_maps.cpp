#include "gi_module/rsm_gather/gather_maps.h"

#include "engine/core/hash.h"
#include "engine/core/octahedral.h"
#include "engine/core/random.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t pattern_seed = 0x65a7e;

bool is_bright(vec3 flux) {
    return is_finite(flux) && luminance(flux) > 0.0f;
}

vec3 axis_of(const Emitter& emitter, int axis) {
    const vec3 direction(emitter.matrix[axis]);
    const float length = glm::length(direction);
    return length > 0.0f ? direction / length : vec3(0.0f, axis == 1 ? 1.0f : 0.0f, axis == 1 ? 0.0f : 1.0f);
}

float greatest(vec3 flux) {
    return std::max({flux.x, flux.y, flux.z});
}

} // namespace

shared::GatherMapRow projection_of(const Emitter& emitter) {
    shared::GatherMapRow row{};
    row.kind = shared::no_map_layout;
    vec3 x(1.0f, 0.0f, 0.0f), y(0.0f, 1.0f, 0.0f), z(0.0f, 0.0f, 1.0f), origin(emitter.matrix[3]);
    float scale = 0.0f;
    if (emitter.kind == EmitterKind::point) {
        row.kind = shared::sphere_map_layout;
    } else if (emitter.kind == EmitterKind::spot) {
        row.kind = shared::cone_map_layout;
        z = -axis_of(emitter, 2);
        orthonormal_basis(z, x, y);
        scale = 1.0f / std::max(1.0f - emitter.outer_cosine, 1e-6f);
    } else if (emitter.kind == EmitterKind::rectangle || emitter.kind == EmitterKind::disc) {
        row.kind = shared::cosine_map_layout;
        z = glm::normalize(glm::cross(axis_of(emitter, 0), axis_of(emitter, 1)));
    } else if (emitter.kind == EmitterKind::directional) {
        row.kind = shared::disc_map_layout;
        z = -axis_of(emitter, 2);
        orthonormal_basis(z, x, y);
        origin = emitter.scene_centre;
        scale = emitter.scene_radius > 0.0f ? 1.0f / emitter.scene_radius : 0.0f;
    }
    row.origin_flux = vec4(origin, 0.0f);
    row.axis_x = vec4(x, scale);
    row.axis_y = vec4(y, 0.0f);
    row.axis_z = vec4(z, 0.0f);
    return row;
}

void GatherMaps::clear() {
    maps_.clear();
    lit_.clear();
    rows_.clear();
    rays_ = 0;
}

void GatherMaps::update(const SceneView& scene, const SampleSet& samples, const GatherRequest& request) {
    request_ = request;
    rows_.clear();
    pattern_.clear();
    trace_all(scene, samples);
    const std::uint64_t hash = content_hash();
    const bool changed = hash != packed_hash_;
    if (changed) {
        packed_hash_ = hash;
        ++version_;
        places_.clear();
        lights_.clear();
    }
    double flux = 0.0, texels = 0.0;
    for (const Lit& lit : lit_) {
        flux += lit.map->flux;
        texels += double(lit.map->texels.texels.size());
    }
    const double budget = double(request.settings.gather_samples);
    for (const Lit& lit : lit_) {
        const double most = double(lit.map->texels.texels.size()), share = flux > 0.0 ? lit.map->flux / flux : 0.0;
        add_row(lit, std::uint32_t(budget >= texels ? most : std::clamp(std::round(share * budget), 1.0, most)));
        if (changed)
            pack(lit);
    }
}

void GatherMaps::trace_all(const SceneView& scene, const SampleSet& samples) {
    lit_.clear();
    rays_ = 0;
    for (auto& [key, map] : maps_)
        map.used = false;
    const bool movers =
        !request_.movers_are_static && std::any_of(scene.gpu_scene.draws().begin(), scene.gpu_scene.draws().end(),
                                                   [](const scene::DrawItem& item) { return !item.is_static; });
    const GatheredParts sampled = request_.sampled;
    std::span<const Emitter> dynamic, fixed;
    if (sampled.dynamic)
        dynamic = samples.dynamic_emitters();
    if (sampled.fixed || (sampled.dynamic && movers))
        fixed = samples.fixed_emitters();
    const std::uint32_t side = reflective_map_side(request_.settings.gather_rays, dynamic.size() + fixed.size());
    for (const Emitter& emitter : dynamic)
        trace(emitter, true, side, scene);
    for (const Emitter& emitter : fixed)
        trace(emitter, false, side, scene);
    std::erase_if(maps_, [](const auto& entry) { return !entry.second.used; });
}

std::uint64_t GatherMaps::content_hash() const {
    std::uint64_t hash = hash_start;
    const auto add = [&](const auto& value) { hash = hash_bytes(hash, &value, sizeof value); };
    add(request_.lit);
    add(request_.movers_are_static);
    add(request_.clamp_scale);
    for (const Lit& lit : lit_) {
        add(lit.map->texels.side);
        add(lit.map->emitter_hash);
        add(lit.map->geometry);
        add(lit.dynamic);
    }
    return hash;
}

void GatherMaps::trace(const Emitter& emitter, bool dynamic, std::uint32_t side, const SceneView& scene) {
    if (!is_bright(emitter.flux))
        return;
    Map& map = maps_[{emitter.entity.bits(), int(emitter.kind)}];
    map.used = true;
    const std::uint64_t hash = emitter_hash(emitter), geometry = scene.rays.generation();
    if (map.texels.side != side || map.emitter_hash != hash || map.geometry != geometry) {
        map.texels = trace_reflective_map(emitter, side, {}, scene.rays, scene.registry);
        map.emitter_hash = hash;
        map.geometry = geometry;
        map.flux = 0.0;
        rays_ += std::uint64_t(side) * side;
        for (const ReflectiveTexel& texel : map.texels.texels)
            if (const vec3 flux = reflected_flux(texel, false, false); texel.lit && is_bright(flux))
                map.flux += double(luminance(flux));
    }
    lit_.push_back({&map, &emitter, dynamic});
}

bool GatherMaps::counts(const Lit& lit, const ReflectiveTexel& texel) const {
    const bool dynamic = lit.dynamic || (texel.on_mover && !request_.movers_are_static);
    return texel.lit && (dynamic ? request_.lit.dynamic : request_.lit.fixed) &&
           is_bright(reflected_flux(texel, false, false));
}

// The brightest texel's flux, so that halves, which are shares of it, have their full precision.
void GatherMaps::add_row(const Lit& lit, std::uint32_t count) {
    shared::GatherMapRow row = projection_of(*lit.emitter);
    const ReflectiveShadowMap& map = lit.map->texels;
    for (const ReflectiveTexel& texel : map.texels)
        if (counts(lit, texel))
            row.origin_flux.w = std::max(row.origin_flux.w, greatest(reflected_flux(texel, false, false)));
    row.side = map.side;
    row.first_light = std::uint32_t(rows_.size()) * map.side * map.side;
    row.first_sample = std::uint32_t(pattern_.size());
    const RsmGatherSettings& settings = request_.settings;
    const std::vector<shared::GatherSample> samples = gather_pattern(
        count, map.side, settings.gather_radius, hash_combine(pattern_seed, request_.seed), settings.gather_softening);
    pattern_.insert(pattern_.end(), samples.begin(), samples.end());
    row.sample_count = std::uint32_t(samples.size());
    rows_.push_back(row);
}

void GatherMaps::pack(const Lit& lit) {
    const float most = rows_.back().origin_flux.w;
    for (const ReflectiveTexel& texel : lit.map->texels.texels) {
        const bool bright = counts(lit, texel);
        const PixelLight light = pixel_light_of(texel, 1.0f, false, false);
        const vec3 share = bright ? glm::max(light.flux, vec3(0.0f)) / most : vec3(0.0f);
        const float softness = bright ? pixel_light_softness(light.area, request_.clamp_scale) : 0.0f;
        places_.push_back(
            {std::bit_cast<std::uint32_t>(light.position.x), std::bit_cast<std::uint32_t>(light.position.y),
             std::bit_cast<std::uint32_t>(light.position.z), bright ? shared::pack_normal(light.normal) : 0u});
        lights_.push_back({glm::packHalf2x16(vec2(share)), glm::packHalf2x16(vec2(share.z, softness))});
    }
}

std::vector<PixelLight> GatherMaps::pixel_lights() const {
    std::vector<PixelLight> lights;
    for (const Lit& lit : lit_)
        for (const ReflectiveTexel& texel : lit.map->texels.texels)
            if (counts(lit, texel))
                lights.push_back(pixel_light_of(texel, 1.0f, false, false));
    return lights;
}

std::uint64_t GatherMaps::memory_bytes() const {
    std::uint64_t bytes = pattern_.capacity() * sizeof(shared::GatherSample);
    for (const auto& [key, map] : maps_)
        bytes += map.texels.texels.size() * sizeof(ReflectiveTexel);
    return bytes + places_.capacity() * (sizeof(PackedPlace) + sizeof(PackedLight));
}

} // namespace sunfleck::gi
