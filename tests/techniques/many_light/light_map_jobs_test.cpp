// Jobs of light maps in pieces that a shader can see.
#include "gi_module/many_light/light_map_jobs.h"

#include <gtest/gtest.h>

namespace sunfleck::gi {
namespace {

// Patches of 0 to 36 changes each; change numbers go on from one to the next.
LightMapJobs some_jobs(std::uint32_t patches, std::uint32_t side) {
    LightMapJobs jobs;
    std::uint32_t change = 0;
    for (std::uint32_t i = 0; i < patches; ++i) {
        shared::LightMapJob job{};
        job.columns = job.rows = side;
        job.first_texel = side * side * i;
        jobs.add(job, true);
        for (std::uint32_t k = 0; k < i * 7 % 37; ++k)
            jobs.add_change(change++);
    }
    return jobs;
}

// Each job with the changes that it means, one after another.
std::vector<std::uint32_t> meaning(std::span<const shared::LightMapJob> jobs, std::span<const std::uint32_t> changes) {
    std::vector<std::uint32_t> all;
    for (const shared::LightMapJob& job : jobs) {
        all.insert(all.end(), {job.first_texel, job.first, job.count, job.change_count});
        const auto own = changes.subspan(job.first_change, job.change_count);
        all.insert(all.end(), own.begin(), own.end());
    }
    return all;
}

TEST(LightMapJobs, PiecesFitAndMeanTheSame) {
    // Maps of 81 and of 40,000 texels: the latter are split, and the parts of a patch share its changes.
    for (const std::uint32_t side : {9u, 200u}) {
        LightMapJobs jobs = some_jobs(200, side);
        jobs.split(1);
        EXPECT_EQ(jobs.jobs().size() > 200, side == 200u);
        const auto expected = meaning(jobs.jobs(), jobs.changes());
        for (const std::uint64_t most : {std::uint64_t(1) << 30, std::uint64_t(4096), std::uint64_t(256)}) {
            std::vector<std::uint32_t> found;
            const auto pieces = jobs.pieces(most);
            for (const LightMapJobs::Piece& piece : pieces) {
                EXPECT_LE(piece.jobs.size() * sizeof(shared::LightMapJob), most);
                EXPECT_LE(piece.changes.size_bytes(), most);
                const auto part = meaning(piece.jobs, piece.changes);
                found.insert(found.end(), part.begin(), part.end());
            }
            EXPECT_EQ(found, expected) << most;
            EXPECT_EQ(pieces.size() == 1, most == std::uint64_t(1) << 30);
        }
    }
    EXPECT_TRUE(LightMapJobs().pieces(256).empty());
}

} // namespace
} // namespace sunfleck::gi
