#include "gi_module/gloss/gloss_lights.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

namespace sunfleck::gi {
namespace {

// Reflected light comes from few samples: a lobe narrower than that of a roughness of 0.3 would show them one by one.
constexpr float least_alpha_of_reflected = 0.3f * 0.3f;

float radius_of_area(float area) {
    return std::sqrt(std::max(area, 0.0f) / pi);
}

float share_of(vec3 part, vec3 whole) {
    const float all = luminance(whole);
    return all > 0.0f ? std::min(luminance(part) / all, 1.0f) : 0.0f;
}

shared::LightRow row_of(const LightBatch& batch, std::uint32_t i) {
    shared::LightRow row;
    std::memcpy(&row, batch.rows.data + sizeof row * i, sizeof row);
    return row;
}

void set_row(LightBatch& batch, std::uint32_t i, const shared::LightRow& row) {
    std::memcpy(batch.rows.data + sizeof row * i, &row, sizeof row);
}

// Straight from an emitter.
float size_of_direct(const LightSample& sample, const Emitter& emitter) {
    if (emitter.is_delta())
        return 0.0f;
    if (emitter.kind != EmitterKind::environment)
        return sample.radius > 0.0f ? sample.radius
                                    : radius_of_area(emitter.area * share_of(sample.flux, emitter.flux));
    const float radiance = luminance(emitter.environment_radiance(-sample.normal));
    const float solid_angle = radiance > 0.0f ? luminance(sample.flux) / radiance : 0.0f;
    return std::tan(std::min(radius_of_area(solid_angle), 1.0f));
}

// By the bound of its geometry term, unless the sample has a disc of its own (transport/clamping.h).
float size_of_reflected(const LightSample& sample, float bound) {
    if (sample.radius > 0.0f)
        return sample.radius;
    return bound > 0.0f ? 1.0f / std::sqrt(bound) : 0.0f;
}

} // namespace

std::vector<float> sizes_of_samples(const SampleSet& samples) {
    std::unordered_map<ecs::Entity, const Emitter*> emitters;
    for (const auto list : {samples.fixed_emitters(), samples.dynamic_emitters()})
        for (const Emitter& emitter : list)
            emitters[emitter.entity] = &emitter;
    std::vector<float> sizes(samples.size(), 0.0f);
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const LightSample& sample = samples.samples()[i];
        if (sample.bounce > 0)
            sizes[i] = size_of_reflected(sample, samples.geometry_bound());
        else if (const auto found = emitters.find(sample.emitter); found != emitters.end())
            sizes[i] = size_of_direct(sample, *found->second);
    }
    return sizes;
}

void write_sizes(const SampleSet& samples, std::span<const float> sizes, LightBatch& batch) {
    for (std::uint32_t i = 0; i < batch.count; ++i) {
        shared::LightRow row = row_of(batch, i);
        const std::uint32_t sample = batch.first + i;
        if (batch.light_class == shared::light_class_surface) {
            const bool reflected = samples.samples()[sample].bounce > 0;
            row.tangent_scale.w = sizes[sample];
            row.normal_offset.w = reflected ? least_alpha_of_reflected * least_alpha_of_reflected : 0.0f;
        } else if (batch.light_class == shared::light_class_point && row.position_bound.w == 0.0f) {
            row.position_bound.w = -sizes[sample]; // positive is the scale of a cone's map
        } else if (batch.light_class == shared::light_class_directional) {
            row.position_bound.w = sizes[sample];
        }
        set_row(batch, i, row);
    }
}

void thin_out(const SampleSet& samples, std::uint32_t stride, LightBatch& batch) {
    std::vector<shared::LightRow> left;
    left.reserve(batch.count);
    std::vector<std::uint8_t> reflected;
    reflected.reserve(batch.count);
    vec3 all(0.0f), kept(0.0f);
    std::uint32_t seen = 0;
    for (std::uint32_t i = 0; i < batch.count; ++i) {
        const shared::LightRow row = row_of(batch, i);
        const bool is_reflected = samples.samples()[batch.first + i].bounce > 0;
        if (is_reflected)
            all += vec3(row.intensity_slot);
        if (is_reflected && seen++ % stride != 0)
            continue;
        if (is_reflected)
            kept += vec3(row.intensity_slot);
        left.push_back(row);
        reflected.push_back(is_reflected);
    }
    const float brighter = luminance(kept) > 0.0f ? luminance(all) / luminance(kept) : 0.0f;
    batch.count = std::uint32_t(left.size());
    for (std::uint32_t i = 0; i < batch.count; ++i) {
        if (reflected[i] != 0) {
            left[i].intensity_slot *= vec4(vec3(brighter), 1.0f);
            left[i].tangent_scale.w *= std::sqrt(float(stride));
        }
        set_row(batch, i, left[i]);
    }
}

} // namespace sunfleck::gi
