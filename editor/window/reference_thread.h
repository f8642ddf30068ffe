// The path tracer on a copy of the scene, in the background: it works only while the scene itself is at rest, and
// begins again with each edit and each movement of the camera.
#pragma once

#include "editor/window/scene_thread.h"

namespace sunfleck::editor {

class ReferenceThread {
public:
    // `busy`: whether the scene is being drawn for the user, who goes first. `wake`: there is a new picture.
    ReferenceThread(gpu::Device& device, std::function<bool()> busy, std::function<void()> wake);
    ~ReferenceThread();
    ReferenceThread(const ReferenceThread&) = delete;
    ReferenceThread& operator=(const ReferenceThread&) = delete;

    // All changes of the document; the first must be everything.
    void change(const SceneChange& change);
    // Camera, size and exposure count.
    void show(const ViewRequest& request);
    // The newest picture, with its pixels; null before the first one.
    std::shared_ptr<ScenePicture> picture() const;
    // Paths for each pixel of it.
    std::uint32_t samples() const { return samples_; }
    std::string error() const;

private:
    struct Copy;
    void run();
    bool has_news() const { return ends_ || news_; }
    Status trace(Copy& copy);
    Status publish(Copy& copy);

    gpu::Device& device_;
    const std::function<bool()> busy_;
    const std::function<void()> wake_;
    mutable std::mutex mutex_; // of all until the next comment
    std::condition_variable changed_;
    SceneChange next_;
    ViewRequest next_view_;
    std::shared_ptr<ScenePicture> newest_;
    std::string error_;

    std::atomic<bool> ends_{false}, news_{false};
    std::atomic<std::uint32_t> samples_{0};
    std::thread thread_;
};

} // namespace sunfleck::editor
