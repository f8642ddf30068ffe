#include "editor/window/difference_thread.h"

#include "editor/window/heat_map.h"
#include "editor/window/picture_upload.h"
#include "engine/core/caught.h"
#include "engine/core/log.h"

namespace sunfleck::editor {

DifferenceThread::DifferenceThread(gpu::Device& device, std::function<void()> wake)
    : device_(device), wake_(std::move(wake)), thread_([this] { run(); }) {}

DifferenceThread::~DifferenceThread() {
    {
        const std::scoped_lock lock(mutex_);
        ends_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

void DifferenceThread::compare(std::shared_ptr<const io::Picture> a, std::shared_ptr<const io::Picture> b) {
    if (a == nullptr || b == nullptr || a->width != b->width || a->height != b->height)
        return;
    {
        const std::scoped_lock lock(mutex_);
        if (a == a_ && b == b_)
            return;
        a_ = std::move(a);
        b_ = std::move(b);
        news_ = true;
    }
    changed_.notify_one();
}

std::shared_ptr<const Difference> DifferenceThread::difference() const {
    const std::scoped_lock lock(mutex_);
    return newest_;
}

void DifferenceThread::forget() {
    const std::scoped_lock lock(mutex_);
    newest_.reset();
    a_.reset();
    b_.reset();
    news_ = false;
    ++forgotten_;
}

Result<std::shared_ptr<Difference>> DifferenceThread::make(const io::Picture& a, const io::Picture& b,
                                                           std::unique_ptr<gpu::Submission>& submission) const {
    if (submission == nullptr) {
        SUNFLECK_ASSIGN(submission, gpu::Submission::create(device_, 1));
    }
    auto result = std::make_shared<Difference>();
    result->metrics = command_line::compare_pictures(a, b, false);
    SUNFLECK_ASSIGN(result->map, upload_picture(device_, *submission, command_line::difference_picture(a, b, false)));
    SUNFLECK_ASSIGN(result->heat, upload_picture(device_, *submission, heat_picture(a, b)));
    return result;
}

void DifferenceThread::run() {
    std::unique_ptr<gpu::Submission> submission;
    for (;;) {
        std::shared_ptr<const io::Picture> a, b;
        std::uint64_t forgotten = 0;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return ends_ || news_; });
            if (ends_)
                return;
            news_ = false;
            a = a_;
            b = b_;
            forgotten = forgotten_;
        }
        auto made = caught([&] { return make(*a, *b, submission); });
        if (!made) {
            log_warning("pictures could not be compared: " + made.error().message);
            continue;
        }
        {
            const std::scoped_lock lock(mutex_);
            if (forgotten != forgotten_)
                continue;
            (*made)->of = std::move(a);
            newest_ = std::move(*made);
        }
        wake_();
    }
}

} // namespace sunfleck::editor
