// Two pictures of one scene side by side, by turns or as their difference: as it is lit now or with settings that were
// kept, against the path tracer or against those settings.
#pragma once

#include "editor/window/difference_thread.h"
#include "editor/window/reference_thread.h"
#include "engine/app/gui_screen.h"

namespace sunfleck::editor {

enum class CompareWhat { scene, kept_settings };
enum class CompareWith { nothing, reference, kept_settings };
enum class CompareAs { split, flip, difference, heat };

class Comparison {
public:
    // `wake`: there is something new to show.
    Comparison(gpu::Device& device, SceneThread& scene, std::function<void()> wake)
        : device_(&device), scene_(scene), wake_(std::move(wake)) {}
    // The device is lost: what lies on it goes, and begins again on the next one, which must be given before follow().
    void forget_device();
    void use_device(gpu::Device& device) { device_ = &device; }

    CompareWhat what = CompareWhat::scene; // kept settings are held against the reference alone
    CompareWith with = CompareWith::nothing;
    CompareAs as = CompareAs::split;
    float split = 0.5f;   // share of the width that shows what is compared
    bool flipped = false; // the other one is shown
    const std::optional<gi::Settings>& kept() const { return kept_; }
    void keep(const gi::Settings& settings);

    bool on() const { return with != CompareWith::nothing; }
    // Neither picture is of the scene as it is lit now.
    bool without_scene() const {
        return with == CompareWith::reference && what == CompareWhat::kept_settings && kept_.has_value();
    }
    // SceneThread::note_hand, for both; the reference waits, too.
    void note_hand();
    // Each frame of the GUI: `change` is what the scene thread is told, if anything, and `everything` makes all of it.
    void follow(const std::optional<SceneChange>& change, const std::function<SceneChange()>& everything,
                const ViewRequest& view);
    // What is shown in `area` of the window; `now`: the scene's own picture. Pictures that are shown go to `held`.
    std::vector<app::Backdrop> backdrops(const std::shared_ptr<ScenePicture>& now, VkRect2D area,
                                         std::vector<std::shared_ptr<ScenePicture>>& held);
    // What is compared, and what with; null until there is one. `now`: the scene's own picture.
    std::shared_ptr<ScenePicture> one(const std::shared_ptr<ScenePicture>& now) const;
    std::shared_ptr<ScenePicture> other() const;
    // Of the two that are shown now (as the reference refines, of its last picture but one at most); null: there is
    // none, as while the scene plays, or where debug views or overlays are shown, which the reference has not.
    std::shared_ptr<const Difference> difference() const;
    // Why there never will be one; empty: it comes.
    std::string why_without_difference() const;
    // Paths for each pixel of the reference.
    std::uint32_t samples() const { return reference_ != nullptr ? reference_->samples() : 0; }
    // What the two are, and how far: "kept settings, settling", "reference, 64 paths a pixel", or what went wrong.
    std::string name_of_one() const;
    std::string name_of_other() const;

private:
    bool needs_second() const { return kept_ && (with == CompareWith::kept_settings || without_scene()); }
    std::string state_of_second() const;
    bool is_current(const ScenePicture& picture) const;
    SceneChange with_kept_settings(SceneChange change) const;
    gpu::Device* device_;
    SceneThread& scene_;
    const std::function<void()> wake_;
    std::unique_ptr<ReferenceThread> reference_;
    std::unique_ptr<SceneThread> second_;
    std::unique_ptr<DifferenceThread> differences_;
    std::optional<gi::Settings> kept_;
    ViewRequest view_;
    std::uint64_t revision_ = 0, hiding_ = 0; // SceneChange::revision and hiding, as the threads were told
    std::pair<CompareWith, bool> sides_{CompareWith::nothing, false}; // what differences_ is of: with, without_scene()
};

// Whether two requests show the same.
bool same_view(const ViewRequest& a, const ViewRequest& b);

} // namespace sunfleck::editor
