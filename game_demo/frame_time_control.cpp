#include "game_demo/frame_time_control.h"

#include "engine/statistics/summary.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sunfleck::demo {
namespace {

// Of the target, for the median and the 95th percentile of what was seen. They leave room for what comes round the next
// corner; that the median is then low costs no evenness, since short frames wait.
constexpr double usual_share = 0.85, high_share = 0.88;
constexpr double low_load = 0.85;                              // below it, the picture may become larger
constexpr double first_look = 0.6;                             // s after the start until the first choice of a size
constexpr double maps_regained = 0.01;                         // of the usual number, in a frame with time to spare
constexpr double maps_lost = 0.02;                             // of those drawn, where the size can't become less
constexpr std::uint32_t settling = 2;                          // frames after a change that do not count
constexpr std::size_t fewest = 6, most = 60, remembered = 100; // frames that a choice looks at
constexpr std::size_t sure = 30;                               // frames after which what is out of reach is said
constexpr double back_time = 1.1;                              // of the target: what was out of reach is back below it

} // namespace

void FrameTimeControl::set(double target_ms, const FrameQuality& usual) {
    if (target_ms == target_ && usual == usual_)
        return; // nothing is new
    *this = FrameTimeControl();
    target_ = target_ms;
    usual_ = quality_ = usual;
    maps_ = usual.maps;
}

double FrameTimeControl::usual() const {
    return statistics::median({times_.begin(), times_.end()});
}

double FrameTimeControl::high() const {
    return statistics::percentile({history_.begin(), history_.end()}, 0.95);
}

double FrameTimeControl::load() const {
    return std::max(usual() / (usual_share * target_), high() / (high_share * target_));
}

bool FrameTimeControl::has_least() const {
    return quality_.render_scale <= least_scale && maps_ <= std::min(double(usual_.maps), double(least_maps));
}

void FrameTimeControl::remember(double work_ms) {
    const auto add = [&](std::deque<double>& to, std::size_t limit) {
        to.push_back(work_ms);
        if (to.size() > limit)
            to.pop_front();
    };
    add(times_, most);
    add(history_, remembered);
}

FrameQuality FrameTimeControl::next(double work_ms, double now, bool moves) {
    if (!on())
        return usual_;
    if (!started_) {
        started_ = true;
        changed_ = now - scale_interval + first_look;
        return quality_;
    }
    if (skipped_ < settling) {
        ++skipped_;
    } else {
        remember(work_ms);
        choose_maps(work_ms);
    }
    if (history_.size() >= sure && times_.size() >= fewest)
        out_of_reach_ = has_least() && high() > (out_of_reach_ ? back_time : most_time) * target_;
    if (times_.size() >= fewest && now - changed_ >= scale_interval && moves)
        choose_scale(now);
    return quality_;
}

// What the last change of the size did to the time tells how much of a frame does not depend on it.
void FrameTimeControl::learn() {
    if (before_ms_ <= 0.0)
        return;
    const double pixels = std::pow(double(quality_.render_scale / before_scale_), 2.0);
    if (std::abs(1.0 - pixels) > 0.1) {
        const double seen = (usual() / before_ms_ - pixels) / (1.0 - pixels);
        fixed_ = 0.5 * (fixed_ + std::clamp(seen, 0.1, 0.8));
    }
    before_ms_ = 0.0;
}

void FrameTimeControl::choose_scale(double now) {
    learn();
    const double load = this->load();
    if (load <= 1.0 && load > low_load)
        return;
    const double pixels = std::clamp((0.97 / load - fixed_) / (1.0 - fixed_), 0.2, 2.0);
    float scale = quality_.render_scale * float(std::sqrt(pixels));
    scale = scale_step * std::floor(scale / scale_step + 0.25f);
    scale = std::clamp(scale, least_scale, 1.0f);
    if (std::abs(scale - usual_.render_scale) <= scale_step) // which the picture is drawn best at
        scale = usual_.render_scale;
    if (scale == quality_.render_scale || (scale > quality_.render_scale) != (load < 1.0))
        return;
    before_ms_ = usual();
    before_scale_ = quality_.render_scale;
    // What frames before would have taken at the new size.
    const double ratio = fixed_ + (1.0 - fixed_) * std::pow(double(scale / before_scale_), 2.0);
    for (double& time : history_)
        time *= ratio;
    quality_.render_scale = scale;
    changed_ = now;
    times_.clear();
    skipped_ = 0;
}

// Two long frames in a row take maps away; a single one may have any cause. So do too many single ones, where the size
// is the least.
void FrameTimeControl::choose_maps(double work_ms) {
    const double full = usual_.maps;
    const bool too_small = quality_.render_scale <= least_scale && times_.size() >= fewest && load() > 1.0;
    const double shorter = std::min(work_ms, std::exchange(last_ms_, work_ms));
    if (shorter > target_)
        maps_ *= std::max(0.5, usual_share * target_ / shorter);
    else if (too_small)
        maps_ -= maps_lost * maps_;
    else if (work_ms < usual_share * target_)
        maps_ += maps_regained * full;
    maps_ = std::clamp(maps_, std::min(full, double(least_maps)), full);
    quality_.maps = std::uint32_t(std::lround(maps_));
    const double share = full > 0.0 ? maps_ / full : 1.0;
    quality_.strength_budget = std::max(std::min(usual_.strength_budget, least_strength_budget),
                                        std::uint32_t(std::lround(share * usual_.strength_budget)));
}

} // namespace sunfleck::demo
