// Jobs for the kernels that sum samples (VPLs) into light maps: for which patches, and which samples are added or
// subtracted.
#pragma once

#include "gi_module/many_light/light_maps_shared.h"
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/transport/light_row.h"
#include "gi_module/transport/light_sample.h"
#include "gi_module/visibility/visibility_database.h"

#include <functional>
#include <span>
#include <vector>

namespace sunfleck::gi {

class LightMapJobs {
public:
    void clear();
    // A job for a patch's whole map, which is cleared first or kept. Changes added next belong to this job.
    void add(const SurfacePatch& patch, const shared::NodeRow& row, bool clear) { add(job_of(patch, row), clear); }
    void add(shared::LightMapJob job, bool clear);
    static shared::LightMapJob job_of(const SurfacePatch& patch, const shared::NodeRow& row);
    void add_change(std::uint32_t change) {
        changes_.push_back(change);
        ++jobs_.back().change_count;
    }
    // Calls add_one(jobs, index) for each index below `count`, concurrently for several, with jobs of the call's own;
    // all follow those that are there in the order of the indices.
    void add_all(std::size_t count, const std::function<void(LightMapJobs& jobs, std::uint32_t index)>& add_one);
    // Call after the last change: splits large maps with many changes into several jobs, for work groups of
    // `invocations`.
    void split(std::uint32_t invocations);

    // Of those jobs in order, in as few pieces as have at most so many bytes of jobs, and of changes, each: a shader
    // sees only so much of a buffer. A piece's jobs count changes from its own first; one job may be larger than that.
    struct Piece {
        std::vector<shared::LightMapJob> jobs;
        std::span<const std::uint32_t> changes; // of this list
    };
    std::vector<Piece> pieces(std::uint64_t most_bytes, std::span<const shared::LightMapJob> jobs) const;
    std::vector<Piece> pieces(std::uint64_t most_bytes) const { return pieces(most_bytes, jobs_); }
    // After split(): the end of those jobs from `first` on that together evaluate so many samples at texels, or one
    // job more.
    std::size_t end_of_portion(std::size_t first, std::uint64_t evaluations) const;

    bool empty() const { return jobs_.empty(); }
    std::span<const shared::LightMapJob> jobs() const { return jobs_; }
    std::span<const std::uint32_t> changes() const { return changes_; }

private:
    std::vector<shared::LightMapJob> jobs_;
    std::vector<std::uint32_t> changes_;
};

// Whether light maps contain a sample's light: point and spot lights have no bound, directional ones need no light map,
// and every change of a dynamic sample would affect all maps that it reaches.
inline bool held_by_light_maps(const LightSample& sample) {
    return sample.kind == SampleKind::surface && !sample.dynamic;
}

// Whether any of a sample's light reaches a patch.
inline bool reaches(PairState state) {
    return state == PairState::none || state == PairState::partial;
}

// To `rows`, which maps were summed with, the new rows of samples whose intensity changed, each before the one that it
// replaces.
void add_replacements(std::vector<shared::LightRow>& rows, std::span<const shared::LightRow> now,
                      std::span<const std::uint32_t> changed);
// The changes that replace one of them, the first, at the row `first`, with the flag given: one, or two where its
// shadow map lies elsewhere now.
void add_replacement(std::vector<std::uint32_t>& changes, std::span<const shared::LightRow> rows, std::uint32_t first,
                     std::uint32_t flag);

// Finds the samples in light maps of which only the intensity changed since `before`. False if anything else changed,
// or if so many intensities changed that summing from scratch is cheaper.
bool find_changed_intensities(std::span<const LightSample> samples, std::span<const shared::LightRow> before,
                              std::span<const shared::LightRow> now, std::vector<std::uint32_t>& changed);

} // namespace sunfleck::gi
