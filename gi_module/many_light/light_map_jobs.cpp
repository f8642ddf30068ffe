#include "gi_module/many_light/light_map_jobs.h"

#include "engine/core/divide_up.h"
#include "engine/core/jobs.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gi {
namespace {

// Loop iterations of an invocation in total: llvmpipe silently ends a shader's loops after 65,535.
constexpr std::uint32_t max_iterations = 40000;
constexpr std::size_t max_changed_intensities = 64; // with more, all samples are summed from scratch

} // namespace

void LightMapJobs::clear() {
    jobs_.clear();
    changes_.clear();
}

shared::LightMapJob LightMapJobs::job_of(const SurfacePatch& patch, const shared::NodeRow& row) {
    shared::LightMapJob job{};
    job.corner = vec4(vec3(patch.corners[0]), 1.0f);
    job.u_edge = vec4(vec3(patch.corners[1] - patch.corners[0]), 0.0f);
    job.v_edge = vec4(vec3(patch.corners[3] - patch.corners[0]), 0.0f);
    job.normal = vec4(vec3(patch.normal), 0.0f);
    job.first_point = shared::no_points;
    job.first_texel = row.first_texel;
    job.columns = row.columns;
    job.rows = row.rows;
    return job;
}

void LightMapJobs::add(shared::LightMapJob job, bool clear) {
    job.clear = clear;
    job.first_change = std::uint32_t(changes_.size());
    jobs_.push_back(job);
}

void LightMapJobs::add_all(std::size_t count,
                           const std::function<void(LightMapJobs& jobs, std::uint32_t index)>& add_one) {
    constexpr std::size_t at_once = 256;
    std::vector<LightMapJobs> parts(divide_up(count, at_once));
    parallel_for_chunks(count, at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t index = begin; index < end; ++index)
            add_one(parts[begin / at_once], std::uint32_t(index));
    });
    std::size_t jobs = jobs_.size(), changes = changes_.size();
    for (const LightMapJobs& part : parts) {
        jobs += part.jobs_.size();
        changes += part.changes_.size();
    }
    jobs_.reserve(jobs);
    changes_.reserve(changes);
    for (LightMapJobs& part : parts) {
        for (shared::LightMapJob job : part.jobs_) {
            job.first_change += std::uint32_t(changes_.size());
            jobs_.push_back(job);
        }
        changes_.insert(changes_.end(), part.changes_.begin(), part.changes_.end());
        part = {};
    }
}

// A job's invocations process its texels in turn, and all changes at every texel.
void LightMapJobs::split(std::uint32_t invocations) {
    std::vector<shared::LightMapJob> parts;
    for (shared::LightMapJob job : jobs_) {
        const std::uint32_t turns = std::max(max_iterations / (job.change_count + 1), 1u);
        const std::uint32_t all = job.columns * job.rows;
        for (job.first = 0; job.first < all; job.first += job.count) {
            job.count = std::min(turns * invocations, all - job.first);
            parts.push_back(job);
        }
    }
    jobs_ = std::move(parts);
}

std::size_t LightMapJobs::end_of_portion(std::size_t first, std::uint64_t evaluations) const {
    for (std::uint64_t done = 0; first < jobs_.size() && done < evaluations; ++first)
        done += std::uint64_t(jobs_[first].count) * jobs_[first].change_count;
    return first;
}

std::vector<LightMapJobs::Piece> LightMapJobs::pieces(std::uint64_t most_bytes,
                                                      std::span<const shared::LightMapJob> jobs) const {
    const std::uint64_t most_jobs = most_bytes / sizeof(shared::LightMapJob);
    const std::uint64_t most_changes = most_bytes / sizeof(std::uint32_t);
    std::vector<Piece> pieces;
    std::uint32_t first = 0; // of the piece's changes
    for (shared::LightMapJob job : jobs) {
        const std::uint64_t end = std::uint64_t(job.first_change) + job.change_count;
        if (pieces.empty() || end - first > most_changes || pieces.back().jobs.size() >= most_jobs) {
            pieces.emplace_back();
            first = job.first_change;
        }
        // Parts of one patch share their changes, so the end may be the same again.
        pieces.back().changes = std::span(changes_).subspan(first, std::size_t(end - first));
        job.first_change -= first;
        pieces.back().jobs.push_back(job);
    }
    return pieces;
}

void add_replacements(std::vector<shared::LightRow>& rows, std::span<const shared::LightRow> now,
                      std::span<const std::uint32_t> changed) {
    for (const std::uint32_t sample : changed) {
        rows.push_back(now[sample]);
        rows.push_back(shared::LightRow(rows[sample]));
    }
}

void add_replacement(std::vector<std::uint32_t>& changes, std::span<const shared::LightRow> rows, std::uint32_t first,
                     std::uint32_t flag) {
    if (rows[first].intensity_slot.w == rows[first + 1].intensity_slot.w) {
        changes.push_back(first | flag | shared::light_map_replace);
        return;
    }
    changes.push_back((first + 1) | flag | shared::light_map_subtract);
    changes.push_back(first | flag);
}

bool find_changed_intensities(std::span<const LightSample> samples, std::span<const shared::LightRow> before,
                              std::span<const shared::LightRow> now, std::vector<std::uint32_t>& changed) {
    if (now.size() != before.size())
        return false;
    for (std::uint32_t i = 0; i < now.size(); ++i) {
        if (!held_by_light_maps(samples[i]) || std::memcmp(&now[i], &before[i], sizeof now[i]) == 0)
            continue;
        shared::LightRow like = before[i];
        like.intensity_slot = now[i].intensity_slot;
        if (std::memcmp(&now[i], &like, sizeof like) != 0)
            return false;
        changed.push_back(i);
    }
    return changed.size() <= max_changed_intensities;
}

} // namespace sunfleck::gi
