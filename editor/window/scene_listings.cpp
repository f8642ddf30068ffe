// How the scene thread fills tables of what the lighting keeps, and does what is asked of their rows.
#include "editor/window/camera.h"
#include "editor/window/scene_thread.h"

namespace sunfleck::editor {

void SceneThread::act(RowAction action) {
    {
        const std::scoped_lock lock(mutex_);
        next_actions_.push_back(std::move(action));
    }
    changed_.notify_one();
}

std::shared_ptr<const ShownListing> SceneThread::listing() const {
    const std::scoped_lock lock(mutex_);
    return listing_;
}

void SceneThread::take_actions(const std::vector<RowAction>& actions) {
    for (const RowAction& action : actions)
        if (copy_ != nullptr)
            static_cast<void>(copy_->renderer().lighting().act(action.listing, action.action, action.key, action.on));
}

// The table as the newest picture has it, of the place that is looked into.
void SceneThread::fill_listing() {
    std::shared_ptr<ShownListing> filled;
    if (!view_.listing.empty()) {
        viewer::SceneRenderer& renderer = copy_->renderer();
        std::optional<gi::ListedPlace> place;
        if (inspection_ && inspection_->width > 0) {
            const vec2 size(float(inspection_->width), float(inspection_->height));
            place = viewer::place_in_view(
                renderer, inspection_->camera.position,
                ray_through(inspection_->camera, size, vec2(inspection_->x, inspection_->y) * size));
        }
        filled = std::make_shared<ShownListing>();
        filled->name = view_.listing;
        if (auto content = renderer.lighting().fill_listing(view_.listing, place ? &*place : nullptr))
            filled->content = std::move(*content);
        else
            filled->content.summary = content.error().message;
    }
    const std::scoped_lock lock(mutex_);
    listing_ = std::move(filled);
}

} // namespace sunfleck::editor
