// A save on a thread of its own, of a copy: the document can be edited meanwhile, and is unsaved until it is done.
#pragma once

#include "editor/window/scene_copy.h"

#include <atomic>
#include <thread>

namespace sunfleck::editor {

class Saving {
public:
    // Of the document as it is now. `wake` is called from the thread at the end.
    Saving(std::shared_ptr<Document> document, std::filesystem::path path, std::function<void()> wake);
    // Waits for it.
    ~Saving();
    Saving(const Saving&) = delete;
    Saving& operator=(const Saving&) = delete;

    const std::shared_ptr<Document>& document() const { return document_; }
    const std::filesystem::path& path() const { return path_; }
    // Of the document's history, when the copy was made.
    std::uint64_t serial() const { return serial_; }
    bool finished() const { return finished_; }
    // Waits for it.
    Status take();

private:
    const std::shared_ptr<Document> document_; // for the thread that edits
    const std::filesystem::path path_;
    const std::uint64_t serial_;
    PlainCopy copy_;
    std::atomic<bool> finished_{false};
    Status result_;
    std::thread thread_;
};

} // namespace sunfleck::editor
