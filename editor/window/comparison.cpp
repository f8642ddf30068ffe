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

void Comparison::note_hand() {
    scene_.note_hand();
    if (second_ != nullptr)
        second_->note_hand();
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
    if (change)
        revision_ = change->revision, hiding_ = change->hiding;
    if (change || view_changed)
        differences_->forget();
    const auto tell = [&](auto& thread, bool is_new, auto&& adapt) {
        SceneChange told;
        if (is_new || change) {
            told = is_new ? everything() : *change;
            revision_ = told.revision, hiding_ = told.hiding;
            thread.change(adapt(std::move(told)));
        }
        if (is_new || view_changed)
            thread.show(wanted);
    };
    if (with == CompareWith::reference) {
        const bool is_new = reference_ == nullptr;
        if (is_new)
            reference_ = std::make_unique<ReferenceThread>(
                *device_, [this] { return scene_.busy() || !scene_.hand_rests(); }, wake_);
        tell(*reference_, is_new, [](SceneChange all) { return all; });
    }
    if (needs_second()) {
        const bool is_new = second_ == nullptr || second_->wants_everything();
        if (second_ == nullptr)
            second_ = std::make_unique<SceneThread>(*device_, wake_);
        tell(*second_, is_new, [this](SceneChange all) { return with_kept_settings(std::move(all)); });
    }
    const std::shared_ptr<ScenePicture> a = one(now), b = other();
    const bool b_is_current = b != nullptr && (with == CompareWith::reference || is_current(*b));
    if (a != nullptr && is_current(*a) && b_is_current && why_without_difference().empty())
        differences_->compare(a->pixels, b->pixels);
}

// It shows what was told last. The reference forgets its picture by itself.
bool Comparison::is_current(const ScenePicture& picture) const {
    return picture.revision == revision_ && picture.hiding == hiding_ &&
           picture.camera.position == view_.camera.position && picture.camera.target == view_.camera.target &&
           picture.camera.up == view_.camera.up &&
           picture.camera.vertical_field_of_view == view_.camera.vertical_field_of_view;
}

std::string Comparison::why_without_difference() const {
    if (view_.playing)
        return "No figures while the scene plays";
    const bool final_view = view_.view == shared::view_final && view_.lighting_view.empty() && view_.overlays.empty();
    if (with == CompareWith::reference && !final_view)
        return "No figures: the reference has no debug views and no overlays";
    return {};
}

std::shared_ptr<ScenePicture> Comparison::one(const std::shared_ptr<ScenePicture>& now) const {
    return !without_scene() ? now : second_ != nullptr ? second_->picture() : nullptr;
}

std::shared_ptr<ScenePicture> Comparison::other() const {
    return reference_ != nullptr ? reference_->picture() : second_ != nullptr ? second_->picture() : nullptr;
}

std::shared_ptr<const Difference> Comparison::difference() const {
    const std::shared_ptr<const Difference> found = differences_ != nullptr ? differences_->difference() : nullptr;
    const std::shared_ptr<ScenePicture> a = found != nullptr ? one(scene_.picture()) : nullptr;
    const bool shown = a != nullptr && a->pixels == found->of && why_without_difference().empty();
    return shown ? found : nullptr;
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
    return "reference, " + (!error.empty()  ? error
                            : view_.playing ? "which waits until play ends"
                                            : std::to_string(samples()) + " paths a pixel");
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
