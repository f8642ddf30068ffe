// A room whose lighting settings are measured as the Lighting panel measures them, without a window.
#pragma once

#include "editor/window/cost_thread.h"
#include "test_places.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

#include <chrono>
#include <filesystem>

namespace sunfleck::editor {

class CostFixture : public tests::GpuTest {
protected:
    CostFixture() {
        auto opened =
            Document::open(std::filesystem::path(SUNFLECK_TOOL).parent_path() / "../scenes/four_pillars.scene.json");
        EXPECT_TRUE(opened);
        if (opened)
            document_ = std::move(*opened);
        view_.width = tests::by_size(160u, 640u);
        view_.height = tests::by_size(90u, 360u);
        view_.camera = viewer::find_camera(document_->registry(), Bounds{vec3(-1.0f), vec3(1.0f)}, "bench_1").value();
    }
    // The scene with these settings over the document's own.
    SceneChange scene_with(const std::vector<std::pair<std::string, std::string>>& settings) const {
        SceneChange scene = ChangeCollector::everything(document_);
        for (const auto& [name, value] : settings)
            EXPECT_TRUE(scene.settings->set(name, value)) << name;
        return scene;
    }
    // What `setting` costs as the scene has it, over what `from` has.
    Cost measure(SceneChange scene, const std::string& setting, const gi::Settings& from, CostEffort effort) const {
        CostThread thread(
            tests::device(), [] { return false; }, [] {}, effort);
        thread.measure(std::move(scene), setting, from, view_);
        for (Cost cost = thread.cost();; cost = thread.cost()) {
            EXPECT_EQ(cost.error, "");
            if (cost.finished || !cost.error.empty())
                return cost;
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
    }
    static double width(const Cost& cost) { return cost.frame.high - cost.frame.low; }

    std::shared_ptr<Document> document_;
    ViewRequest view_;
};

} // namespace sunfleck::editor
