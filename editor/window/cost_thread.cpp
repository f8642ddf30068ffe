#include "editor/window/cost_thread.h"

#include "engine/core/caught.h"
#include "engine/statistics/clipped_sum.h"
#include "engine/statistics/summary.h"
#include "viewer/preparation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace sunfleck::editor {
namespace {

using CostClock = std::chrono::steady_clock;

constexpr int warm_up_blocks = 3, frames_of_block = 3;
constexpr std::uint32_t small_width = 64, small_height = 36;
// Whether the interval is narrow enough is looked at when there are so many pairs, and then each time that their number
// has grown by half; it has to be so twice in a row. Who looks after every pair, or once, stops at the narrow ones
// among many, and those miss more often.
constexpr std::size_t fewest_pairs = 16;
constexpr double precise_share = 0.05;   // of the frame: how wide the interval may be
constexpr double telling_interval = 0.5; // s: the GUI's own frames disturb what is measured
constexpr double two_sided_95 = 1.959964;

viewer::FrameRequest request_of(const ViewRequest& view) {
    viewer::FrameRequest request;
    request.camera = view.camera;
    request.width = view.width;
    request.height = view.height;
    request.antialiasing = view.look.antialiasing;
    request.glare = view.look.glare;
    return request;
}

double seconds_of(CostClock::duration duration) {
    return std::chrono::duration<double>(duration).count();
}

} // namespace

CostInterval cost_interval(const std::vector<double>& differences) {
    return {statistics::clipped_centre(differences, 0.0), statistics::clipped_centre(differences, two_sided_95),
            statistics::clipped_centre(differences, -two_sided_95)};
}

CostInterval cost_of_ratios(const std::vector<double>& log_ratios, double frame_ms) {
    const CostInterval ratio = cost_interval(log_ratios);
    const auto milliseconds = [frame_ms](double value) { return frame_ms * std::expm1(value); };
    return {milliseconds(ratio.estimate), milliseconds(ratio.low), milliseconds(ratio.high)};
}

std::string cost_text(const Cost& cost) {
    char text[160];
    if (!cost.error.empty())
        return cost.error;
    if (!std::isfinite(cost.frame.low) || !std::isfinite(cost.frame.high) || cost.pairs < 2)
        return "measuring ...";
    const double most = std::max(std::abs(cost.frame.low), std::abs(cost.frame.high));
    if (!cost.frame.includes_zero())
        std::snprintf(text, sizeof text, "%+.2f ms (%.2f to %.2f) of %.1f ms over %s", cost.frame.estimate,
                      cost.frame.low, cost.frame.high, cost.frame_ms, cost.from.c_str());
    else if (most <= precise_share * cost.frame_ms)
        std::snprintf(text, sizeof text, "no measurable effect over %s (less than %.2f ms)", cost.from.c_str(), most);
    else
        std::snprintf(text, sizeof text, "not measurable over %s (%.2f to %.2f ms)", cost.from.c_str(), cost.frame.low,
                      cost.frame.high);
    return std::string(text) + (cost.finished ? "" : " ...");
}

// One comparison on its way.
struct CostThread::Work {
    SceneChange scene;
    std::string setting;
    gi::Settings from;
    ViewRequest view;
    std::vector<double> frame_ms, log_ratios; // with the first value; of a pair, second to first
    std::map<std::string, std::vector<double>> passes;
    std::string to_text;
    CostClock::time_point began; // of the first pair
};

CostThread::CostThread(gpu::Device& device, std::function<bool()> busy, std::function<void()> wake, CostEffort effort)
    : device_(device), busy_(std::move(busy)), wake_(std::move(wake)), effort_(effort), thread_([this] { run(); }) {}

CostThread::~CostThread() {
    {
        const std::scoped_lock lock(mutex_);
        ends_ = abandoned_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

void CostThread::measure(SceneChange scene, const std::string& setting, const gi::Settings& from,
                         const ViewRequest& view) {
    auto work = std::make_unique<Work>();
    work->to_text = scene.settings->get(setting);
    work->scene = std::move(scene);
    work->setting = setting;
    work->from = from;
    work->view = view;
    {
        const std::scoped_lock lock(mutex_);
        cost_ = {};
        cost_.setting = setting;
        cost_.from = from.get(setting);
        cost_.to = work->to_text;
        next_ = std::move(work);
        abandoned_ = true; // what is under way
    }
    changed_.notify_one();
}

void CostThread::stop() {
    const std::scoped_lock lock(mutex_);
    next_.reset();
    cost_ = {};
    abandoned_ = true;
}

Cost CostThread::cost() const {
    const std::scoped_lock lock(mutex_);
    return cost_;
}

// Until the user's own picture is finished. False: there is nothing to wait for any more.
bool CostThread::wait_for_turn() const {
    while (!abandoned_ && busy_())
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return !abandoned_;
}

Status CostThread::block(SceneCopy& copy, const ViewRequest& view, std::map<std::string, double>& times,
                         double& frame_ms) {
    viewer::FrameRequest request = request_of(view);
    request.progress = [this](float) { return !abandoned_; };
    double log_sum = 0.0;
    std::map<std::string, std::vector<double>> passes;
    for (int i = 0; i < frames_of_block; ++i) {
        SUNFLECK_TRY(copy.renderer().render_and_wait(request));
        const viewer::FrameStatistics& statistics = copy.renderer().statistics();
        log_sum += std::log(statistics.frame_ms);
        for (const auto& [name, time] : statistics.gpu_ms)
            passes[name].push_back(time);
        for (const auto& [name, time] : statistics.cpu_ms)
            passes[name + " (CPU)"].push_back(time);
    }
    frame_ms = std::exp(log_sum / frames_of_block);
    times.clear();
    for (const auto& [name, values] : passes)
        times[name] = statistics::median(values);
    return {};
}

void CostThread::publish(const Work& work, bool finished) {
    const std::scoped_lock lock(mutex_);
    if (abandoned_) // something else is asked for already, or nothing
        return;
    cost_.pairs = work.log_ratios.size();
    cost_.seconds = seconds_of(CostClock::now() - work.began);
    cost_.frame_ms = statistics::median(work.frame_ms);
    cost_.frame = cost_of_ratios(work.log_ratios, cost_.frame_ms);
    cost_.finished = finished;
    cost_.passes.clear();
    for (const auto& [name, differences] : work.passes)
        if (const CostInterval interval = cost_interval(differences);
            differences.size() == work.log_ratios.size() && !interval.includes_zero())
            cost_.passes.emplace_back(name, interval);
    std::sort(cost_.passes.begin(), cost_.passes.end(),
              [](const auto& a, const auto& b) { return std::abs(a.second.estimate) > std::abs(b.second.estimate); });
}

// With all of its light and shadow maps, so that making them is no part of what is measured.
Result<std::unique_ptr<SceneCopy>> CostThread::prepared_copy(const Work& work, const gi::Settings& settings) {
    SUNFLECK_ASSIGN(std::unique_ptr<SceneCopy> copy, SceneCopy::create(device_));
    SceneChange scene = work.scene;
    scene.settings = settings;
    SUNFLECK_TRY(copy->apply(scene));
    viewer::PreparationOptions options;
    options.progress = [this](float) { return wait_for_turn(); };
    ViewRequest small = work.view; // what is kept does not depend on the picture
    small.width = small_width;
    small.height = small_height;
    SUNFLECK_TRY(viewer::prepare_lighting(copy->renderer(), request_of(small), options));
    std::map<std::string, double> unused;
    double frame_ms = 0.0;
    for (int i = 0; i < warm_up_blocks && wait_for_turn(); ++i)
        SUNFLECK_TRY(block(*copy, work.view, unused, frame_ms));
    return copy;
}

Status CostThread::measure(Work& work) {
    std::unique_ptr<SceneCopy> copies[2];
    for (int i = 0; i < 2; ++i) {
        SUNFLECK_ASSIGN(copies[i], prepared_copy(work, i == 0 ? work.from : *work.scene.settings));
    }
    work.began = CostClock::now();
    CostClock::time_point told = work.began;
    std::size_t next_look = fewest_pairs;
    for (bool narrow = false, precise = false;
         !precise && seconds_of(CostClock::now() - work.began) < effort_.longest;) {
        std::map<std::string, double> times[2];
        double frame_ms[2] = {};
        const int first = int(work.log_ratios.size() % 2); // A B, then B A
        for (const int turn : {first, 1 - first}) {
            if (!wait_for_turn())
                return {};
            SUNFLECK_TRY(block(*copies[turn], work.view, times[turn], frame_ms[turn]));
        }
        work.frame_ms.push_back(frame_ms[0]);
        work.log_ratios.push_back(std::log(frame_ms[1] / frame_ms[0]));
        for (int i = 0; i < 2; ++i)
            for (const auto& [name, time] : times[i])
                work.passes[name].resize(work.log_ratios.size() - 1);
        for (auto& [name, differences] : work.passes)
            differences.push_back(times[1][name] - times[0][name]);
        const double usual_ms = statistics::median(work.frame_ms);
        const CostInterval interval = cost_of_ratios(work.log_ratios, usual_ms);
        if (work.log_ratios.size() >= next_look) {
            next_look += next_look / 2;
            const bool was_narrow = std::exchange(narrow, interval.high - interval.low <= precise_share * usual_ms);
            precise = narrow && was_narrow && seconds_of(CostClock::now() - work.began) >= effort_.shortest;
        }
        if (const auto now = CostClock::now(); !precise && seconds_of(now - told) > telling_interval) {
            told = now;
            publish(work, false);
            wake_();
        }
    }
    publish(work, true);
    return {};
}

void CostThread::run() {
    for (;;) {
        std::unique_ptr<Work> work;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return ends_ || next_ != nullptr; });
            if (ends_)
                return;
            work = std::move(next_);
            abandoned_ = false;
        }
        const Status status = caught([&] { return measure(*work); });
        {
            const std::scoped_lock lock(mutex_);
            if (!status && !abandoned_)
                cost_.error = status.error().message;
        }
        wake_();
    }
}

} // namespace sunfleck::editor
