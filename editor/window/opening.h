// A file that loads on a thread of its own.
#pragma once

#include "editor/document/document.h"

#include <atomic>
#include <thread>

namespace sunfleck::editor {

class Opening {
public:
    using Load = std::function<Result<std::unique_ptr<Document>>(const std::function<bool(float)>& progress)>;
    // `wake` is called from the thread when there is something to show.
    // `allow_outside`: io::ImportOptions::allow_outside.
    Opening(std::filesystem::path path, bool allow_outside, std::function<void()> wake);
    // The same by another way than Document::open.
    Opening(std::filesystem::path path, Load load, std::function<void()> wake);
    // Cancels it.
    ~Opening();
    Opening(const Opening&) = delete;
    Opening& operator=(const Opening&) = delete;

    const std::filesystem::path& path() const { return path_; }
    float share() const { return share_; } // done, 0 to 1
    bool finished() const { return finished_; }
    // Once, after finished().
    Result<std::unique_ptr<Document>> take();

private:
    const std::filesystem::path path_;
    std::atomic<float> share_{0.0f};
    std::atomic<bool> finished_{false}, stop_{false};
    std::optional<Result<std::unique_ptr<Document>>> result_;
    std::thread thread_;
};

// Whether a file belongs to the program: it is not to be written to.
bool is_built_in(const std::filesystem::path& path);

} // namespace sunfleck::editor
