#include "editor/window/cost_thread.h"

#include "engine/core/caught.h"
#include "engine/statistics/clipped_sum.h"
#include "engine/statistics/summary.h"
#include "viewer/preparation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace sunfleck::editor {
namespace {

using CostClock = std::chrono::steady_clock;

constexpr int warm_up_frames = 9;
constexpr std::uint32_t small_width = 64, small_height = 36;
// Whether the interval is narrow enough is looked at when there are so many rounds, and then each time that their
// number has grown by half; it has to be so twice in a row. Who looks after every round, or once, stops at the narrow
// ones among many, and those miss more often.
constexpr std::size_t fewest_rounds = 16;
constexpr double precise_share = 0.05;   // of the frame: how wide the interval may be
constexpr double telling_interval = 0.5; // s: the GUI's own frames disturb what is measured
constexpr double two_sided_95 = 1.959964;

// Neighbours may have been disturbed alike. The centres of parts in a row know little of each other once a part is
// longer than what disturbs it: they are as few as an interval can be made of, so that they are as long as possible.
std::vector<double> centres_of_parts(const std::vector<double>& samples) {
    const std::size_t length = std::max(samples.size() / fewest_rounds, std::size_t(1));
    std::vector<double> centres;
    for (std::size_t at = 0; at + length <= samples.size(); at += length)
        centres.push_back(statistics::clipped_centre(
            std::vector<double>(samples.begin() + std::ptrdiff_t(at), samples.begin() + std::ptrdiff_t(at + length)),
            0.0));
    return centres;
}

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

CostInterval cost_interval(const std::vector<double>& by_round) {
    const std::vector<double> differences = centres_of_parts(by_round);
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
    if (!std::isfinite(cost.frame.low) || !std::isfinite(cost.frame.high) || cost.rounds < 2)
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
    std::vector<double> frame_ms, log_ratios; // by round: with the first value; second to first
    std::map<std::string, std::vector<double>> passes;
    std::string to_text;
    CostClock::time_point began; // of the first round

    void add(const Round& round);
    CostInterval interval() const { return cost_of_ratios(log_ratios, statistics::median(frame_ms)); }
};

// What a round found: two frames with each value.
struct CostThread::Round {
    std::array<double, 2> log_ms{};                       // by value, the sum
    std::map<std::string, std::array<double, 2>> pass_ms; // likewise; a frame without the pass counts as none
};

void CostThread::Work::add(const Round& round) {
    for (const auto& [name, times] : round.pass_ms)
        if (auto& differences = passes[name]; differences.size() == log_ratios.size()) // was in all rounds so far
            differences.push_back(0.5 * (times[1] - times[0]));
    frame_ms.push_back(std::exp(0.5 * round.log_ms[0]));
    log_ratios.push_back(0.5 * (round.log_ms[1] - round.log_ms[0]));
}

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

// A frame, by its time, ms; and what its passes took.
Result<double> CostThread::frame(SceneCopy& copy, const ViewRequest& view, std::map<std::string, double>& passes) {
    viewer::FrameRequest request = request_of(view);
    request.progress = [this](float) { return !abandoned_; };
    SUNFLECK_TRY(copy.renderer().render_and_wait(request));
    const viewer::FrameStatistics& statistics = copy.renderer().statistics();
    passes.clear();
    for (const auto& [name, time] : statistics.gpu_ms)
        passes[name] = time;
    for (const auto& [name, time] : statistics.cpu_ms)
        passes[name + " (CPU)"] = time;
    return statistics.frame_ms;
}

// A B B A, frame by frame. Single frames: what disturbs one mostly disturbs the next, too, so that several of one value
// in a row say little more than one, and those of the two values are best close together.
Result<std::optional<CostThread::Round>> CostThread::round(const Copies& copies, const ViewRequest& view) {
    Round result;
    for (const std::size_t value : {0u, 1u, 1u, 0u}) {
        if (!wait_for_turn())
            return std::optional<Round>();
        std::map<std::string, double> passes;
        SUNFLECK_ASSIGN(const double milliseconds, frame(*copies[value], view, passes));
        result.log_ms[value] += std::log(milliseconds);
        for (const auto& [name, time] : passes)
            result.pass_ms[name][value] += time;
    }
    return std::optional<Round>(std::move(result));
}

void CostThread::publish(const Work& work, bool finished) {
    const std::scoped_lock lock(mutex_);
    if (abandoned_) // something else is asked for already, or nothing
        return;
    cost_.rounds = work.log_ratios.size();
    cost_.seconds = seconds_of(CostClock::now() - work.began);
    cost_.frame_ms = statistics::median(work.frame_ms);
    cost_.frame = work.interval();
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
    for (int i = 0; i < warm_up_frames && wait_for_turn(); ++i)
        SUNFLECK_TRY(frame(*copy, work.view, unused));
    return copy;
}

Status CostThread::measure(Work& work) {
    Copies copies;
    for (std::size_t i = 0; i < copies.size(); ++i) {
        SUNFLECK_ASSIGN(copies[i], prepared_copy(work, i == 0 ? work.from : *work.scene.settings));
    }
    work.began = CostClock::now();
    const auto elapsed = [&work] { return seconds_of(CostClock::now() - work.began); };
    double told = 0.0;
    std::size_t next_look = fewest_rounds;
    for (bool narrow = false, precise = false; !precise && elapsed() < effort_.longest;) {
        SUNFLECK_ASSIGN(const std::optional<Round> found, round(copies, work.view));
        if (!found)
            return {};
        work.add(*found);
        if (work.log_ratios.size() >= next_look) {
            next_look += next_look / 2;
            const CostInterval interval = work.interval();
            const double precise_ms = precise_share * statistics::median(work.frame_ms);
            const bool was_narrow = std::exchange(narrow, interval.high - interval.low <= precise_ms);
            precise = narrow && was_narrow && elapsed() >= effort_.shortest;
        }
        if (!precise && elapsed() - told > telling_interval) {
            told = elapsed();
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
