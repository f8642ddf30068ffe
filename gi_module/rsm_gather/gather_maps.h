// The reflective shadow maps that light is gathered from, as the kernel reads them.
#pragma once

#include "gi_module/light_sampling/reflective_shadow_map.h"
#include "gi_module/light_sampling/sample_set.h"
#include "gi_module/rsm_gather/gather_pattern.h"
#include "gi_module/rsm_gather/rsm_gather_settings.h"

#include <array>
#include <map>
#include <span>
#include <vector>

namespace sunfleck::gi {

// Light by its path: fixed: of emitters that stay, reflected by surfaces that stay. dynamic: all else.
struct GatheredParts {
    bool fixed = false, dynamic = false;
    bool operator==(const GatheredParts&) const = default;
};

struct GatherRequest {
    GatheredParts sampled; // the budget is divided among these
    GatheredParts lit;     // and of them, these are wanted
    bool movers_are_static = false;
    std::uint32_t seed = 1;
    float clamp_scale = 1.0f;
    RsmGatherSettings settings;
};

// A texel as a pixel light: its position, and its normal packed; and its flux as halves, as a share of the brightest of
// its map, with its softness (transport/pixel_light.h).
using PackedPlace = std::array<std::uint32_t, 4>;
using PackedLight = std::array<std::uint32_t, 2>;

// How points of the scene lie in the emitter's map.
shared::GatherMapRow projection_of(const Emitter& emitter);

class GatherMaps {
public:
    // Follows the scene; once a frame.
    void update(const SceneView& scene, const SampleSet& samples, const GatherRequest& request);
    void clear();

    std::span<const shared::GatherMapRow> rows() const { return rows_; }
    std::span<const shared::GatherSample> pattern() const { return pattern_; }
    // All lights, map after map, in the order of their texels. They change with each change of `version`.
    std::span<const PackedPlace> places() const { return places_; }
    std::span<const PackedLight> lights() const { return lights_; }
    std::uint64_t version() const { return version_; }
    // Traced in the last update.
    std::uint64_t rays() const { return rays_; }
    std::uint64_t memory_bytes() const;
    // The pixel lights of the texels that count, in no order that means anything: what is gathered from, for tests.
    std::vector<PixelLight> pixel_lights() const;

private:
    struct Map {
        ReflectiveShadowMap texels;
        std::uint64_t emitter_hash = 0, geometry = 0;
        double flux = 0.0; // luminance, of all texels
        bool used = false;
    };
    struct Lit {
        const Map* map;
        const Emitter* emitter;
        bool dynamic;
    };
    void trace_all(const SceneView& scene, const SampleSet& samples);
    // Of all that the lights depend on.
    std::uint64_t content_hash() const;
    void trace(const Emitter& emitter, bool dynamic, std::uint32_t side, const SceneView& scene);
    bool counts(const Lit& lit, const ReflectiveTexel& texel) const;
    void pack(const Lit& lit);
    void add_row(const Lit& lit, std::uint32_t count);

    std::map<std::pair<std::uint64_t, int>, Map> maps_; // by emitter's entity and kind
    std::vector<Lit> lit_;
    GatherRequest request_;
    std::vector<shared::GatherMapRow> rows_;
    std::vector<shared::GatherSample> pattern_;
    std::vector<PackedPlace> places_;
    std::vector<PackedLight> lights_;
    std::uint64_t version_ = 0, packed_hash_ = 0, rays_ = 0;
};

} // namespace sunfleck::gi
