// Two pictures of one scene side by side, by turns or as their difference: as it is lit now, against the path tracer or
// against other settings that were kept.
#pragma once

#include "editor/window/difference_thread.h"
#include "editor/window/reference_thread.h"
#include "engine/app/gui_screen.h"

namespace sunfleck::editor {

enum class CompareWith { nothing, reference, kept_settings };
enum class CompareAs { split, flip, difference };

class Comparison {
public:
    // `wake`: there is something new to show.
    Comparison(gpu::Device& device, SceneThread& scene, std::function<void()> wake)
        : device_(&device), scene_(scene), wake_(std::move(wake)) {}
    // The device is lost: what lies on it goes, and begins again on the next one, which must be given before follow().
    void forget_device();
    void use_device(gpu::Device& device) { device_ = &device; }

    CompareWith with = CompareWith::nothing;
    CompareAs as = CompareAs::split;
    float split = 0.5f;   // share of the width that shows the scene as it is lit now
    bool flipped = false; // the other one is shown
    const std::optional<gi::Settings>& kept() const { return kept_; }
    void keep(const gi::Settings& settings) {
        kept_ = settings;
        second_.reset(); // it is told them when it begins
    }

    bool on() const { return with != CompareWith::nothing; }
    // Each frame of the GUI: `change` is what the scene thread is told, if anything, and `everything` makes all of it.
    void follow(const std::optional<SceneChange>& change, const std::function<SceneChange()>& everything,
                const ViewRequest& view);
    // What is shown in `area` of the window; `now`: the scene's own picture. Pictures that are shown go to `held`.
    std::vector<app::Backdrop> backdrops(const std::shared_ptr<ScenePicture>& now, VkRect2D area,
                                         std::vector<std::shared_ptr<ScenePicture>>& held);
    std::shared_ptr<ScenePicture> other() const;
    std::shared_ptr<const Difference> difference() const;
    // "64 paths a pixel", "settling", or what went wrong.
    std::string state() const;

private:
    SceneChange with_kept_settings(SceneChange change) const;
    gpu::Device* device_;
    SceneThread& scene_;
    const std::function<void()> wake_;
    std::unique_ptr<ReferenceThread> reference_;
    std::unique_ptr<SceneThread> second_;
    std::unique_ptr<DifferenceThread> differences_;
    std::optional<gi::Settings> kept_;
    ViewRequest view_;
};

// Whether two requests show the same.
bool same_view(const ViewRequest& a, const ViewRequest& b);

} // namespace sunfleck::editor
