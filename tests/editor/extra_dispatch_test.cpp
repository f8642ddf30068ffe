// A dispatch that a technique adds is found by what the editor measures of settings: what it takes, and in which pass.
#include "engine/statistics/summary.h"
#include "tests/editor/cost_fixture.h"
#include "tests/techniques/constant_light.h"

#include <algorithm>

namespace sunfleck::editor {
namespace {

constexpr const char* setting = "constant_work"; // of the technique that only the tests know
constexpr const char* pass = "constant work";

class EditorExtraDispatch : public CostFixture {
protected:
    SceneChange scene(std::uint32_t turns) const {
        return scene_with({{"indirect", "constant_light"}, {setting, std::to_string(turns)}});
    }
    // Of a renderer of the test's own, ms: the dispatch, and the frame without it.
    struct Times {
        double dispatch = 0.0, rest = 0.0;
    };
    Times draw(std::uint32_t turns) const {
        const auto copy = SceneCopy::create(tests::device()).value();
        EXPECT_TRUE(copy->apply(scene(turns)));
        viewer::FrameRequest request;
        request.camera = view_.camera;
        request.width = view_.width;
        request.height = view_.height;
        request.antialiasing = view_.look.antialiasing;
        request.glare = view_.look.glare;
        constexpr int first = 10; // after those that make light and maps
        std::vector<double> dispatch, rest;
        for (int frame = 0; frame < first + tests::by_size(60, 200); ++frame) {
            EXPECT_TRUE(copy->renderer().render_and_wait(request));
            const viewer::FrameStatistics& statistics = copy->renderer().statistics();
            const auto found = statistics.gpu_ms.find(pass);
            if (frame < first || found == statistics.gpu_ms.end())
                continue;
            dispatch.push_back(found->second);
            rest.push_back(statistics.frame_ms - found->second);
        }
        EXPECT_FALSE(dispatch.empty());
        return dispatch.empty() ? Times{} : Times{statistics::median(dispatch), statistics::median(rest)};
    }
    // Over no turns.
    Cost measure(std::uint32_t turns) const {
        return CostFixture::measure(scene(turns), setting, *scene(0).settings, {0.0, tests::by_size(8.0, 60.0)});
    }
    // The interval is one of 95 %: made twice as wide, it misses the truth once in ten thousand runs.
    static bool contains(const CostInterval& interval, double truth) {
        const double more = 0.5 * (interval.high - interval.low);
        return truth >= interval.low - more && truth <= interval.high + more;
    }
};

TEST_F(EditorExtraDispatch, ATenthOfTheFrameIsFoundInItsPass) {
    constexpr std::uint32_t tried = 300;
    const Times trial = draw(tried);
    ASSERT_GT(trial.dispatch, 0.0);
    const std::uint32_t turns = std::max(std::uint32_t(0.1 * trial.rest / trial.dispatch * tried), 1u);
    const Times truth = draw(turns);
    const double share = truth.dispatch / truth.rest;
    EXPECT_GT(share, 0.07);
    EXPECT_LT(share, 0.14);

    const Cost cost = measure(turns);
    const auto found =
        std::find_if(cost.passes.begin(), cost.passes.end(), [](const auto& one) { return one.first == pass; });
    ASSERT_NE(found, cost.passes.end()) << cost_text(cost);
    const auto percent = [&](double milliseconds) { return 100.0 * milliseconds / cost.frame_ms; };
    std::printf(
        "%u turns are %.2f %% of the frame; found: %.2f %% (%.2f to %.2f), the pass %.2f %% (%.2f to %.2f), %s\n",
        turns, 100.0 * share, percent(cost.frame.estimate), percent(cost.frame.low), percent(cost.frame.high),
        percent(found->second.estimate), percent(found->second.low), percent(found->second.high),
        cost_text(cost).c_str());
    // Shares, since the machine may be faster now than it was then.
    EXPECT_TRUE(contains(cost.frame, share * cost.frame_ms));
    EXPECT_GT(cost.frame.low, 0.0);
    // Some seconds of a machine in use make it wide; the long size has the time that the panel takes.
    EXPECT_LE(cost.frame.high - cost.frame.low, tests::by_size(0.2, 0.05) * cost.frame_ms);
    // Where two scenes are drawn by turns, each pass finds less of its own in the caches.
    EXPECT_NEAR(found->second.estimate, share * cost.frame_ms, 0.4 * share * cost.frame_ms);
    EXPECT_GT(found->second.low, 0.0);
}

} // namespace
} // namespace sunfleck::editor

int main(int argc, char** argv) {
    sunfleck::gi::add_technique(sunfleck::tests::constant_light());
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
