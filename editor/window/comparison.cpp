#include "editor/window/comparison.h"

#include <algorithm>
#include <utility>

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

void Comparison::keep(const gi::Settings& settings) {
    kept_ = settings;
    second_.reset(); // it is told them when it begins
    differences_.reset();
}

// Begins and ends what makes the pictures.
void Comparison::follow(const std::optional<SceneChange>& change, const std::function<SceneChange()>& everything,
                        const ViewRequest& view) {
    if (with != CompareWith::reference)
        reference_.reset();
    if (!needs_second())
        second_.reset();
    if (!on() || std::exchange(sides_, std::pair(with, without_scene())) != std::pair(with, without_scene()))
        differences_.reset(); // they are of other pictures
    if (!on())
        return;
    if (differences_ == nullptr)
        differences_ = std::make_unique<DifferenceThread>(*device_, wake_);
    // The exposure of the picture that it is compared with.
    const std::shared_ptr<ScenePicture> now = scene_.picture();
    ViewRequest wanted = view;
    wanted.read_back = true;
    wanted.listing.clear();
    wanted.ev100 = now != nullptr ? std::optional<float>(now->ev100) : view.ev100;
    const bool view_changed = !same_view(wanted, view_);
    view_ = wanted;
    const auto tell = [&](auto& thread, bool is_new, auto&& adapt) {
        if (is_new || change)
            thread.change(adapt(is_new ? everything() : *change));
        if (is_new || view_changed)
            thread.show(wanted);
    };
    if (with == CompareWith::reference) {
        const bool is_new = reference_ == nullptr;
        if (is_new)
            reference_ = std::make_unique<ReferenceThread>(
                *device_, [this] { return scene_.busy(); }, wake_);
        tell(*reference_, is_new, [](SceneChange all) { return all; });
    }
    if (needs_second()) {
        const bool is_new = second_ == nullptr;
        if (is_new)
            second_ = std::make_unique<SceneThread>(*device_, wake_);
        tell(*second_, is_new, [this](SceneChange all) { return with_kept_settings(std::move(all)); });
    }
    const std::shared_ptr<ScenePicture> a = one(now), b = other();
    if (a != nullptr && b != nullptr)
        differences_->compare(a->pixels, b->pixels);
}

std::shared_ptr<ScenePicture> Comparison::one(const std::shared_ptr<ScenePicture>& now) const {
    return !without_scene() ? now : second_ != nullptr ? second_->picture() : nullptr;
}

std::shared_ptr<ScenePicture> Comparison::other() const {
    return reference_ != nullptr ? reference_->picture() : second_ != nullptr ? second_->picture() : nullptr;
}

std::shared_ptr<const Difference> Comparison::difference() const {
    return differences_ != nullptr ? differences_->difference() : nullptr;
}

std::string Comparison::state_of_second() const {
    if (second_ == nullptr)
        return "kept settings";
    const SceneStatus status = second_->status();
    return "kept settings, " + (!status.error.empty() ? status.error : status.busy ? "settling" : "settled");
}

std::string Comparison::name_of_one() const {
    return without_scene() ? state_of_second() : "scene";
}

std::string Comparison::name_of_other() const {
    if (with != CompareWith::reference)
        return state_of_second();
    if (reference_ == nullptr)
        return "reference";
    const std::string error = reference_->error();
    return "reference, " + (error.empty() ? std::to_string(samples()) + " paths a pixel" : error);
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
    const std::shared_ptr<ScenePicture> first = on() ? one(now) : nullptr, second = on() ? other() : nullptr;
    const std::shared_ptr<const Difference> errors = difference();
    if (first == nullptr || second == nullptr)
        show(now, 0.0f, 1.0f);
    else if (as == CompareAs::difference && errors != nullptr)
        show(errors->map, 0.0f, 1.0f);
    else if (as == CompareAs::heat && errors != nullptr)
        show(errors->heat, 0.0f, 1.0f);
    else if (as == CompareAs::flip)
        show(flipped ? second : first, 0.0f, 1.0f);
    else {
        show(first, 0.0f, split);
        show(second, split, 1.0f);
    }
    return result;
}

} // namespace sunfleck::editor
