// How two pictures differ, worked out in the background: the error map and the figures of `sunfleck compare`.
#pragma once

#include "editor/command_line/metrics.h"
#include "editor/window/scene_thread.h"

namespace sunfleck::editor {

struct Difference {
    std::shared_ptr<ScenePicture> map;  // eight times the difference, as display values
    std::shared_ptr<ScenePicture> heat; // heat_picture
    command_line::Metrics metrics;
    std::shared_ptr<const io::Picture> of; // the first of the two
};

class DifferenceThread {
public:
    DifferenceThread(gpu::Device& device, std::function<void()> wake);
    ~DifferenceThread();
    DifferenceThread(const DifferenceThread&) = delete;
    DifferenceThread& operator=(const DifferenceThread&) = delete;

    // Of two pictures of one size, if they are not those of the last call. `b`: the one that `a` is held against.
    void compare(std::shared_ptr<const io::Picture> a, std::shared_ptr<const io::Picture> b);
    // The newest; null before the first one.
    std::shared_ptr<const Difference> difference() const;
    // What was compared so far is of pictures that are no more.
    void forget();

private:
    void run();
    Result<std::shared_ptr<Difference>> make(const io::Picture& a, const io::Picture& b,
                                             std::unique_ptr<gpu::Submission>& submission) const;
    gpu::Device& device_;
    const std::function<void()> wake_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::shared_ptr<const io::Picture> a_, b_;
    std::shared_ptr<const Difference> newest_;
    std::uint64_t forgotten_ = 0; // so often
    bool news_ = false, ends_ = false;
    std::thread thread_;
};

} // namespace sunfleck::editor
