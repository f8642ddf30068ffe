#include "editor/window/comparison.h"

#include <algorithm>

namespace sunfleck::editor {

bool same_view(const ViewRequest& a, const ViewRequest& b) {
    return a.camera.position == b.camera.position && a.camera.target == b.camera.target && a.camera.up == b.camera.up &&
           a.camera.vertical_field_of_view == b.camera.vertical_field_of_view && a.width == b.width &&
           a.height == b.height && a.view == b.view && a.lighting_view == b.lighting_view && a.overlays == b.overlays &&
           a.chosen_sample == b.chosen_sample && a.listing == b.listing && a.look.antialiasing == b.look.antialiasing &&
           a.look.glare == b.look.glare && a.ev100 == b.ev100 && a.playing == b.playing && a.paused == b.paused &&
           a.read_back == b.read_back;
}

void Comparison::forget_device() {
    differences_.reset();
    reference_.reset();
    second_.reset();
}

SceneChange Comparison::with_kept_settings(SceneChange change) const {
    if (change.settings)
        change.settings = kept_;
    return change;
}

void Comparison::follow(const std::optional<SceneChange>& change, const std::function<SceneChange()>& everything,
                        const ViewRequest& view) {
    if (with != CompareWith::reference)
        reference_.reset();
    if (with != CompareWith::kept_settings || !kept_)
        second_.reset();
    if (!on()) {
        differences_.reset();
        return;
    }
    if (differences_ == nullptr)
        differences_ = std::make_unique<DifferenceThread>(*device_, wake_);
    // The exposure of the picture that it is compared with.
    const std::shared_ptr<ScenePicture> now = scene_.picture();
    ViewRequest wanted = view;
    wanted.read_back = true;
    wanted.listing.clear();
    wanted.ev100 = now != nullptr ? std::optional<float>(now->ev100) : view.ev100;
    const bool is_new = with == CompareWith::reference ? reference_ == nullptr : second_ == nullptr;
    const bool view_changed = is_new || !same_view(wanted, view_);
    view_ = wanted;
    if (with == CompareWith::reference) {
        if (is_new)
            reference_ = std::make_unique<ReferenceThread>(
                *device_, [this] { return scene_.busy(); }, wake_);
        if (is_new || change)
            reference_->change(is_new ? everything() : *change);
        if (view_changed)
            reference_->show(wanted);
    } else if (kept_) {
        if (is_new)
            second_ = std::make_unique<SceneThread>(*device_, wake_);
        if (is_new || change)
            second_->change(with_kept_settings(is_new ? everything() : *change));
        if (view_changed)
            second_->show(wanted);
    }
    if (const std::shared_ptr<ScenePicture> compared = other(); compared != nullptr && now != nullptr)
        differences_->compare(now->pixels, compared->pixels);
}

std::shared_ptr<ScenePicture> Comparison::other() const {
    return reference_ != nullptr ? reference_->picture() : second_ != nullptr ? second_->picture() : nullptr;
}

std::shared_ptr<const Difference> Comparison::difference() const {
    return differences_ != nullptr ? differences_->difference() : nullptr;
}

std::string Comparison::state() const {
    if (reference_ != nullptr)
        return reference_->error().empty() ? std::to_string(reference_->samples()) + " paths a pixel"
                                           : reference_->error();
    if (second_ == nullptr)
        return "";
    const SceneStatus status = second_->status();
    return !status.error.empty() ? status.error : status.busy ? "settling" : "settled";
}

std::vector<app::Backdrop> Comparison::backdrops(const std::shared_ptr<ScenePicture>& now, VkRect2D area,
                                                 std::vector<std::shared_ptr<ScenePicture>>& held) {
    std::vector<app::Backdrop> result;
    const auto show = [&](const std::shared_ptr<ScenePicture>& picture, float from, float until) {
        if (picture == nullptr || until <= from)
            return;
        const auto cut = [&](std::uint32_t whole, float share) { return std::uint32_t(share * float(whole)); };
        const gpu::ImageDescription& size = picture->image.description();
        const std::uint32_t left = cut(area.extent.width, from), right = cut(area.extent.width, until);
        const std::uint32_t first = cut(size.width, from), last = cut(size.width, until);
        if (right <= left || last <= first)
            return;
        result.push_back({&picture->image,
                          {{area.offset.x + int(left), area.offset.y}, {right - left, area.extent.height}},
                          {{int(first), 0}, {last - first, size.height}}});
        held.push_back(picture);
    };
    const std::shared_ptr<ScenePicture> compared = on() ? other() : nullptr;
    const std::shared_ptr<const Difference> errors = difference();
    if (compared == nullptr)
        show(now, 0.0f, 1.0f);
    else if (as == CompareAs::difference && errors != nullptr)
        show(errors->map, 0.0f, 1.0f);
    else if (as == CompareAs::flip)
        show(flipped ? compared : now, 0.0f, 1.0f);
    else {
        show(now, 0.0f, split);
        show(compared, split, 1.0f);
    }
    return result;
}

} // namespace sunfleck::editor
