// Work for the kernels that sum samples into light maps: which patches, which samples are added or taken away.
#pragma once

#include "gi_module/many_light/light_maps_shared.h"
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/transport/light_row.h"
#include "gi_module/transport/light_sample.h"
#include "gi_module/visibility/visibility_database.h"

#include <span>
#include <vector>

namespace sunfleck::gi {

class LightMapJobs {
public:
    void clear();
    // A job for a patch's whole map: what is there is cleared or kept. Changes added next are its own.
    void add(const SurfacePatch& patch, const shared::NodeRow& row, bool clear) { add(job_of(patch, row), clear); }
    void add(shared::LightMapJob job, bool clear);
    static shared::LightMapJob job_of(const SurfacePatch& patch, const shared::NodeRow& row);
    void add_change(std::uint32_t change) {
        changes_.push_back(change);
        ++jobs_.back().change_count;
    }
    // After the last change: work groups of `invocations` at a time; large maps with many changes become several jobs.
    void split(std::uint32_t invocations);

    bool empty() const { return jobs_.empty(); }
    std::span<const shared::LightMapJob> jobs() const { return jobs_; }
    std::span<const std::uint32_t> changes() const { return changes_; }

private:
    std::vector<shared::LightMapJob> jobs_;
    std::vector<std::uint32_t> changes_;
};

// Whether light maps hold a sample's light: point and spot lights have no bound, directional ones need no map, and
// every change of those that move or vary would touch all maps that they reach.
inline bool held_by_light_maps(const LightSample& sample) {
    return sample.kind == SampleKind::surface && !sample.dynamic;
}

// Whether any of a sample's light comes to a patch.
inline bool reaches(PairState state) {
    return state == PairState::none || state == PairState::partial;
}

// Finds the held samples whose strength alone changed since `before`. False if something else changed, or the strengths
// of more samples than it pays to follow.
bool find_changed_intensities(std::span<const LightSample> samples, std::span<const shared::LightRow> before,
                        std::span<const shared::LightRow> now, std::vector<std::uint32_t>& changed);

} // namespace sunfleck::gi
