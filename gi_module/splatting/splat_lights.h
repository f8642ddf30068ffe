// The pixel lights of a frame: texels of the emitters' reflective shadow maps, chosen by importance warping. Paper,
// sec. 3.1 and 3.5; the maps are made by rays (sec. 3.7).
#pragma once

#include "gi_module/light_sampling/reflective_shadow_map.h"
#include "gi_module/light_sampling/sample_set.h"
#include "gi_module/splatting/followed_lights.h"
#include "gi_module/splatting/splatting_settings.h"
#include "gi_module/splatting/visible_contribution.h"

#include <map>
#include <span>
#include <vector>

namespace sunfleck::gi {

// Whose pixel lights. fixed: emitters that stay, reflected by surfaces that stay. dynamic: all else.
struct SplatParts {
    bool fixed = false, dynamic = false;
    bool any() const { return fixed || dynamic; }
};

struct SplatRequest {
    SplatParts sampled; // the budget is divided among these
    SplatParts lit;     // and of them, these are wanted
    bool movers_are_static = false;
    std::uint32_t seed = 1;
    SplattingSettings settings;
    std::optional<mat4> view_projection; // of the picture, for the contribution to it; none: flux decides
};

class SplatLights {
public:
    // Follows the scene; once a frame. Lights whose flux is zero are left out.
    void update(const SceneView& scene, const SampleSet& samples, const SplatRequest& request);

    std::span<const PixelLight> lights() const { return lights_; }
    // W/m2, of all lights together, in the mean over the static surface of the scene if all of it were to arrive there.
    float mean_irradiance() const { return mean_irradiance_; }
    // Texels of the maps in use that pixel lights are chosen from, at most about `most`, evenly from all of them.
    struct SeenTexel {
        vec3 position;
        vec3 flux;        // W
        float importance; // on the scale of the light with the greatest, 0 to 1
    };
    std::vector<SeenTexel> texels(std::size_t most) const;
    // Reflective shadow maps in use, and rays traced for them in the last update.
    std::size_t maps() const { return maps_.size(); }
    std::uint64_t rays() const { return rays_; }
    std::uint64_t memory_bytes() const;

private:
    // Which texels of a map count.
    struct Texels {
        bool fixed = false, movers = false;
    };
    // What one emitter sees.
    struct Map {
        ReflectiveShadowMap texels;
        ReflectiveShadowMap refracted; // what glass lets through; empty: nothing
        Refraction refraction = Refraction::off;
        std::uint64_t emitter_hash = 0, geometry = 0;
        std::uint32_t side = 0;
        bool used = false;
        bool is_new = false;               // made in this update
        std::vector<float> contributions;  // block_contributions, smoothed over frames; empty: flux decides
        FollowedLights followed[2];        // of fixed and dynamic light
        std::uint64_t follows[2] = {0, 0}; // hash of what they were chosen by

        // Of a texel's block; 0: there are none.
        float contribution(std::size_t texel) const;
    };
    // A part of a map's texels and of the light that they reflect, among which pixel lights are chosen.
    struct Source {
        Map* map = nullptr;
        const ReflectiveShadowMap* texels = nullptr; // of the map: reflecting ones, or those behind glass
        std::uint32_t random = 0;                    // seed
        bool dynamic = false;
        bool glossy = false; // what is reflected in a lobe, or passes glass
        ImportanceMap importance;
        double weight = 0.0;     // what the budget is divided by
        double share = 0.0;      // of the budget, in lights
        std::uint32_t count = 0; // of lights
    };

    // An emitter of this frame.
    struct Lit {
        Map* map;
        bool dynamic;
        std::uint32_t random;
    };
    void trace(const Emitter& emitter, bool dynamic, std::uint32_t side, const SceneView& scene,
               const SplatRequest& request);
    void find_contributions(const SceneView& scene, const SplatRequest& request);
    void add_sources_of(const Lit& lit, const SplatRequest& request);
    void find_mean_contribution();
    void trace_refracted(Map& map, const Emitter& emitter, const SceneView& scene, const SplatRequest& request);
    std::vector<float> importance_of(const Source& source, const Texels& texels, const SplatRequest& request) const;
    void add_sources(Map& map, bool dynamic, const Texels& texels, std::uint32_t random, const SplatRequest& request);
    void add_source(Source source, const Texels& texels, const SplatRequest& request);
    void divide(bool glossy, std::uint32_t count);
    void place(const Source& source, const SplatRequest& request);
    void place_followed(const Source& source, const SplatRequest& request, const raytrace::RayScene& rays);

    std::map<std::pair<std::uint64_t, int>, Map> maps_; // by emitter's entity and kind
    std::vector<Lit> lit_;
    std::vector<Source> sources_;
    std::vector<SeenPoint> seen_;    // where contributions were taken last
    float mean_contribution_ = 0.0f; // of all flux; 0: flux decides
    std::uint64_t seen_hash_ = 0;    // of the camera and the scene then
    std::vector<PixelLight> lights_;
    float mean_irradiance_ = 0.0f;
    std::uint64_t rays_ = 0;
};

} // namespace sunfleck::gi
