// What the Lighting panel says a setting costs: the interval that it shows contains what a four times longer
// measurement finds, and the pass that takes more is named.
#include "editor/window/cost_thread.h"

#include "test_places.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"
#include "viewer/scene_renderer.h"

#include <chrono>
#include <cmath>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

struct Change {
    const char *setting, *value; // over the default
};

class EditorCost : public tests::GpuTest {
protected:
    EditorCost() {
        auto opened = Document::open(fs::path(SUNFLECK_TOOL).parent_path() / "../scenes/four_pillars.scene.json");
        EXPECT_TRUE(opened);
        if (opened)
            document = std::move(*opened);
        view.width = tests::by_size(160u, 640u);
        view.height = tests::by_size(90u, 360u);
        view.camera = viewer::find_camera(document->registry(), Bounds{vec3(-1.0f), vec3(1.0f)}, "bench_1").value();
    }
    // Over the default, with all else as the document has it.
    Cost measure(const Change& change, CostEffort effort) const {
        CostThread thread(
            tests::device(), [] { return false; }, [] {}, effort);
        SceneChange scene = ChangeCollector::everything(document);
        const gi::Settings usual = *scene.settings;
        EXPECT_TRUE(scene.settings->set(change.setting, change.value));
        thread.measure(std::move(scene), change.setting, usual, view);
        for (Cost cost = thread.cost();; cost = thread.cost()) {
            EXPECT_EQ(cost.error, "");
            if (cost.finished || !cost.error.empty())
                return cost;
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
    }
    static double width(const Cost& cost) { return cost.frame.high - cost.frame.low; }
    std::shared_ptr<Document> document;
    ViewRequest view;
};

// Ten settings, three of which need other samples (lights, bounces, direct_share), and one without effect here. The
// time for each by SUNFLECK_COST_SECONDS, 60 in the long size.
TEST_F(EditorCost, IntervalsContainWhatALongerMeasurementFinds) {
    const char* const seconds_text = std::getenv("SUNFLECK_COST_SECONDS");
    const double seconds = seconds_text != nullptr ? std::atof(seconds_text) : tests::by_size(1.0, 60.0);
    static constexpr Change all[] = {{"low_resolution", "2"},   {"lights", "500"},
                                     {"shadow_filter", "true"}, {"bounces", "1"},
                                     {"baked_light", "false"},  {"light_maps", "false"},
                                     {"visibility", "false"},   {"repair_angle", "2"},
                                     {"direct_share", "0.75"},  {"transfer_reflections", "0"}};
    const std::size_t count = tests::by_size(std::size_t(1), std::size(all));
    int contained = 0, precise = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Cost shown = measure(all[i], {0.0, seconds}), longer = measure(all[i], {4.0 * seconds, 4.0 * seconds});
        contained += longer.frame.estimate >= shown.frame.low && longer.frame.estimate <= shown.frame.high ? 1 : 0;
        precise += width(shown) <= 0.05 * shown.frame_ms ? 1 : 0;
        std::printf("%-20s %s; four times longer: %+.2f ms; the interval is %.1f %% of the frame\n", all[i].setting,
                    cost_text(shown).c_str(), longer.frame.estimate, 100.0 * width(shown) / shown.frame_ms);
    }
    // Shares of ten at full size. In the short one an interval of a second says little, but that all is in order.
    if (count == std::size(all)) {
        EXPECT_GE(contained, 8);
        EXPECT_EQ(precise, 10);
    }
}

// Five times as many light samples: that costs, and the pass is named. A setting of a technique that lights
// nothing here does not.
TEST_F(EditorCost, TheDearerPassIsNamed) {
    const Cost dear = measure({"lights", "1500"}, {0.0, tests::by_size(4.0, 60.0)});
    EXPECT_GT(dear.frame.low, 0.0) << cost_text(dear);
    EXPECT_TRUE(std::any_of(dear.passes.begin(), dear.passes.end(), [](const auto& pass) {
        return pass.first.find("light") != std::string::npos && pass.second.estimate > 0.0;
    })) << cost_text(dear);
    const Cost none = measure({"transfer_reflections", "0"}, {0.0, tests::by_size(2.0, 60.0)});
    EXPECT_LT(std::abs(none.frame.estimate), 0.1 * none.frame_ms) << cost_text(none);
}

} // namespace
} // namespace sunfleck::editor
