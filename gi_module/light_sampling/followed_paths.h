// Reflected light samples (VPLs) of one source of light that moves or varies. They keep their places as long as the
// first segment of their path is unoccluded; the others are sampled again, a few a frame, where the source's light has
// the largest gap. After S. Laine et al., "Incremental Instant Radiosity for Real-Time Indirect Illumination", 2007,
// with paths of several bounces: a path is valid as a whole while its first segment is.
//
// Each sample carries the share of the source's flux that leaves nearer to its path's direction than to any other's:
// the Voronoi cell of the direction, measured with a fixed set of directions that are distributed like the light. Light
// of a source that has an extent tells little by its direction: there, the cells are those of where the light lands.
//
// Where paths lie depends on where the source has been. A source that rests can have them sampled again, a few a frame,
// as they would be if it had always been there (`settle`).
#pragma once

#include "engine/core/random.h"
#include "engine/raytrace/ray_scene.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/light_sampling/sampling_settings.h"

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace sunfleck::gi {

// What light leaves, now.
class PathSource {
public:
    virtual ~PathSource() = default;
    // Of light that leaves it; four numbers in [0, 1) decide where and whither.
    virtual EmittedRay ray(const float numbers[4]) const = 0;
    // Whether light leaves it in this direction from where a ray of `normal` starts.
    virtual bool emits_towards(vec3 normal, vec3 direction) const = 0;
    virtual ecs::Entity entity() const = 0;
    // Directions are kept relative to it.
    virtual const mat4& matrix() const = 0;
    // W, of all rays together, without what may not be reflected so often any more; and what these numbers' ray
    // carries, relative to the others.
    virtual vec3 flux(std::uint32_t reflections) const = 0;
    virtual vec3 weight(const float numbers[4]) const = 0;
    // Whether weights change while it lasts.
    virtual bool weights_vary() const = 0;
    // Whether it has an extent, so that cells are told apart by where the light lands.
    virtual bool is_extended() const = 0;
};

// What paths are traced in.
struct PathSpace {
    const SampleRequest& settings;
    const raytrace::RayScene& rays;
    std::uint32_t bounces = 0;      // of a path, at most
    std::uint32_t first_bounce = 1; // where it first meets a surface
    std::uint32_t& paths_made;      // so far; the random sequence of a path follows it
    std::span<std::uint8_t> moved;  // by sample: set when it is placed; may be empty
    // Of an extended source: whether something stands in a sample's path, so that it carries nothing; null: never.
    std::function<bool(const LightSample&)> blocked = {};
};

class FollowedPaths {
public:
    // `count` paths, none valid yet: fill_gaps and share_flux come next. `seed`: of the directions.
    void reset(const PathSource& source, std::uint32_t count, std::uint32_t seed);
    bool complete() const; // all paths are valid
    // Paths that are not those of a source that has always been where it is.
    std::uint32_t unsettled() const;
    std::uint32_t size() const { return std::uint32_t(paths_.size()); }

    // Of an extended source, before all else, whenever it has moved: where its light lands, and what is left of it at
    // the end of a walk from there, in the mean over many.
    void land(const PathSource& source, const PathSpace& space);
    // After the source moved: which first segments are still unoccluded, and their directions from the source.
    void validate(const PathSource& source, const raytrace::RayScene& rays);
    // Samples invalid paths again, at most `most` of them, in the middle of the largest gaps between the others. When
    // all are valid, but a gap is much larger than the rest, the path with the smallest cell moves there. The number of
    // paths sampled. `samples`: one for each path.
    std::uint32_t fill_gaps(const PathSource& source, std::uint32_t most, const PathSpace& space,
                            std::span<LightSample> samples);
    // In place of fill_gaps, while an extended source rests: samples at most `most` of the unsettled paths again, as
    // the first fill_gaps would have here.
    void settle(const PathSource& source, std::uint32_t most, const PathSpace& space, std::span<LightSample> samples);
    // Of the source as it is now: how much flux each sample carries, and where its path begins.
    // `blocked`: see PathSpace; the others carry as much as the mean over many walks.
    void share_flux(const PathSource& source, std::span<LightSample> samples,
                    const std::function<bool(const LightSample&)>& blocked = {});
    // Of one path then: the sample's flux for a source of 1 W in each channel, and how often it was reflected.
    vec3 carried(std::uint32_t path) const { return paths_[path].share * paths_[path].throughput; }
    std::uint32_t reflections(std::uint32_t path) const { return paths_[path].reflections; }

private:
    // How light goes its first segment.
    struct Segment {
        vec3 direction{0.0f}; // in the source's frame
        vec3 end{0.0f};       // far along the ray if it hit nothing
        vec3 normal{0.0f};    // of the surface there
        bool escaped = false; // it hit nothing
    };
    struct Path {
        std::uint32_t number = 0;     // of its ray in numbers_
        std::uint32_t first_seed = 0; // of its random numbers, in the first fill_gaps
        bool settled = false;         // as if sampled then, from where the source is now
        Segment first;
        vec3 throughput{0.0f}; // of the whole path; the source's flux is not in it
        vec3 share{0.0f};      // of the source's flux that goes this way
        std::uint32_t reflections = 0;
        bool valid = false;
    };
    struct Cells;
    vec3 arriving(const PathSource& source, vec3 total) const;
    void sample_path(const PathSource& source, std::uint32_t path, const PathSpace& space, std::uint32_t seed,
                     LightSample& sample);

    std::vector<Path> paths_;
    std::vector<vec3> directions_; // of the source's light, in its frame
    std::vector<vec3> weights_;
    std::vector<std::array<float, 4>> numbers_;
    struct Landing {
        Segment first;
        vec3 throughput{0.0f}; // of a whole walk; 0: blocked
        std::uint32_t reflections = 0;
    };
    std::vector<Landing> landings_; // of an extended source, for the same numbers
    bool filled_ = false;           // once
};

} // namespace sunfleck::gi
