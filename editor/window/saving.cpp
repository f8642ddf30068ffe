#include "editor/window/saving.h"

#include "engine/core/caught.h"

namespace sunfleck::editor {

Saving::Saving(std::shared_ptr<Document> document, std::filesystem::path path, std::function<void()> wake)
    : document_(std::move(document)), path_(std::move(path)), serial_(document_->history().serial()) {
    copy_.apply(ChangeCollector::everything(document_));
    thread_ = std::thread([this, wake = std::move(wake)] {
        result_ = caught([this] {
            return io::save_scene(path_, copy_.registry, copy_.meshes, copy_.textures,
                                  Document::save_options(copy_.settings, copy_.encoded.get(), copy_.link.get()));
        });
        finished_ = true;
        if (wake)
            wake();
    });
}

Saving::~Saving() {
    if (thread_.joinable())
        thread_.join();
}

Status Saving::take() {
    thread_.join();
    return std::move(result_);
}

} // namespace sunfleck::editor
