#include "gi_module/inspection/overlays.h"

#include "gi_module/light_sampling/sample_set.h"
#include "gi_module/visibility/visibility_database.h"

#include <cmath>

namespace sunfleck::gi {
namespace {

enum Code : std::uint32_t { by_flux, by_bounce, paths, patches };

constexpr Overlay overlays[] = {
    {"samples", "Light samples, the larger the more light they give",
     "the light's own colour; the line is the side that it shines to", "light samples", by_flux},
    {"sample_bounces", "Light samples by reflections since their light left the lamp",
     "white: direct, green: one, blue: two, violet: more; grey: nothing arrives", "light samples", by_bounce},
    {"sample_paths", "The way that the light of reflected samples has come; of the sample that was chosen, if one was",
     "the light's own colour", "light samples", paths},
    {"patches", "Surface patches of the visibility database; where a light sample was chosen, what stands between",
     "green: nothing, orange: something may, blue: all of it is hidden, grey: it faces away", "visibility", patches},
};

vec3 colour_of(const LightSample& sample) {
    const float brightest = std::max({sample.flux.x, sample.flux.y, sample.flux.z, 1e-30f});
    return glm::sqrt(glm::max(sample.flux, vec3(0.0f)) / brightest);
}

float strength(const LightSample& sample) {
    return std::max({sample.flux.x, sample.flux.y, sample.flux.z, 0.0f});
}

// A sphere of the median sample's flux has this radius; volumes go with the flux. Rooms are a few units large.
constexpr float usual_radius = 0.02f, least_radius = 0.006f, largest_radius = 0.08f;

float median_strength(const SampleSet& samples) {
    std::vector<float> all;
    all.reserve(samples.size());
    for (const LightSample& sample : samples.samples())
        all.push_back(strength(sample));
    if (all.empty())
        return 1.0f;
    std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(all.size() / 2), all.end());
    return std::max(all[all.size() / 2], 1e-30f);
}

void mark(const LightSample& sample, float radius, vec3 colour, OverlayLines& lines) {
    if (sample.kind == SampleKind::directional)
        return; // it has no place
    lines.box({sample.position - radius, sample.position + radius}, colour);
    if (sample.kind != SampleKind::point)
        lines.line(sample.position, sample.position + 4.0f * radius * sample.normal, colour);
}

void draw_by_flux(const SampleSet& samples, OverlayLines& lines) {
    const float median = median_strength(samples);
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const LightSample& sample = samples.samples()[i];
        const float radius =
            std::clamp(usual_radius * std::cbrt(strength(sample) / median), least_radius, largest_radius);
        mark(sample, lines.sample == i ? 2.0f * radius : radius,
             lines.sample && lines.sample != i ? 0.4f * colour_of(sample) : colour_of(sample), lines);
    }
}

void draw_by_bounce(const SampleSet& samples, OverlayLines& lines) {
    constexpr vec3 colours[] = {{1.0f, 1.0f, 1.0f}, {0.3f, 0.9f, 0.35f}, {0.3f, 0.55f, 1.0f}, {0.85f, 0.4f, 1.0f}};
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const LightSample& sample = samples.samples()[i];
        const bool dark = strength(sample) <= 0.0f || samples.is_blocked(i);
        mark(sample, usual_radius, dark ? vec3(0.4f) : colours[std::min(sample.bounce, 3u)], lines);
    }
}

void draw_paths(const SampleSet& samples, OverlayLines& lines) {
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const LightSample& sample = samples.samples()[i];
        if (lines.sample && lines.sample != i)
            continue;
        for (std::uint32_t v = 0; v < sample.path_vertex_count; ++v)
            lines.line(sample.path[v], v + 1 < sample.path_vertex_count ? sample.path[v + 1] : sample.position,
                       colour_of(sample));
    }
}

vec3 state_colour(PairState state) {
    switch (state) {
    case PairState::none:
        return {0.3f, 0.9f, 0.35f};
    case PairState::partial:
        return {1.0f, 0.6f, 0.2f};
    case PairState::full:
        return {0.3f, 0.5f, 1.0f};
    case PairState::unlit:
        break;
    }
    return vec3(0.45f);
}

void draw_patches(const VisibilityDatabase& database, OverlayLines& lines) {
    const std::vector<SurfacePatch>& nodes = database.patches().nodes();
    for (std::uint32_t node = 0; node < nodes.size(); ++node) {
        const SurfacePatch& patch = nodes[node];
        if (!patch.is_leaf())
            continue;
        const bool chosen = lines.sample && *lines.sample < database.sample_count();
        const vec3 colour = chosen ? state_colour(database.state(node, *lines.sample)) : vec3(0.85f, 0.8f, 0.5f);
        if (!patch.planar) {
            lines.box(patch.bounds, colour);
            continue;
        }
        // A little within the patch, so that neighbours' edges stand side by side.
        dvec3 middle(0.0);
        for (const dvec3& corner : patch.corners)
            middle += 0.25 * corner;
        const auto corner = [&](std::size_t i) {
            return vec3(glm::mix(patch.corners[i % 4], middle, 0.03) + 0.002 * patch.normal);
        };
        for (std::size_t i = 0; i < 4; ++i)
            lines.line(corner(i), corner(i + 1), colour);
    }
}

} // namespace

void OverlayLines::box(const Bounds& bounds, vec3 colour) {
    const auto corner = [&](int i) {
        return vec3((i & 1) != 0 ? bounds.maximum.x : bounds.minimum.x,
                    (i & 2) != 0 ? bounds.maximum.y : bounds.minimum.y,
                    (i & 4) != 0 ? bounds.maximum.z : bounds.minimum.z);
    };
    for (int i = 0; i < 8; ++i)
        for (const int bit : {1, 2, 4})
            if ((i & bit) == 0)
                line(corner(i), corner(i | bit), colour);
}

std::span<const Overlay> shared_overlays() {
    return overlays;
}

void draw_shared_overlay(std::uint32_t code, const SampleSet& samples, const VisibilityDatabase* visibility,
                         OverlayLines& lines) {
    if (code == by_flux)
        draw_by_flux(samples, lines);
    if (code == by_bounce)
        draw_by_bounce(samples, lines);
    if (code == paths)
        draw_paths(samples, lines);
    if (code == patches && visibility != nullptr)
        draw_patches(*visibility, lines);
}

} // namespace sunfleck::gi
