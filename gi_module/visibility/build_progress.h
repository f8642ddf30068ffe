// How far the visibility database is with its work, from many threads to one function of the host's.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>

namespace sunfleck::gi {

// Calls the host's function with the share of all work, from whichever thread gets there, and keeps its answer.
class BuildProgress {
public:
    // `levels`: steps, at most, of about the same length.
    BuildProgress(const std::function<bool(float)>& progress, std::uint32_t levels)
        : progress_(progress), levels_(levels) {}
    void begin_level(std::size_t parts) {
        parts_ = parts;
        done_ = 0;
    }
    void end_level() { ++level_; }
    void add(std::size_t parts) {
        done_ += parts;
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!progress_ || !lock.owns_lock() || stopped_)
            return;
        const float share = float(done_) / float(std::max<std::size_t>(parts_, 1));
        stopped_ = !progress_((float(level_) + share) / float(levels_));
    }
    bool stopped() const { return stopped_; }

private:
    const std::function<bool(float)>& progress_;
    std::uint32_t levels_, level_ = 0;
    std::size_t parts_ = 0;
    std::atomic<std::size_t> done_{0};
    std::atomic<bool> stopped_{false};
    std::mutex mutex_;
};

} // namespace sunfleck::gi
