#include "editor/window/cost_thread.h"

#include "engine/core/caught.h"
#include "engine/core/memory_limit.h"
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
// Of copies: for fewer samples, clipped_centre's intervals at 95 % are too narrow. Two at least, one in each order.
constexpr std::size_t enough_pairs = 8, fewest_pairs = 2;
constexpr double building_share = 0.5; // of the whole time, for more pairs than that; or as long as has been measured
// By how much two equal scenes differ, as a share of the frame: the standard deviation over pairs of copies of
// four_pillars, with two cores. It counts where there are too few pairs to find it.
constexpr double pair_deviation = 0.02;
// Whether the interval is narrow enough is looked at after so many turns, and then each time that their number has
// grown by a quarter; it has to be so twice in a row. Who looks after every turn, or once, stops at the narrow ones
// among many, and those miss more often.
constexpr std::size_t fewest_parts = 16, first_look = 8;
constexpr double shortest_turn = 0.8, longest_share = 1.0 / 16; // s; of the whole time
constexpr double precise_share = 0.05;                          // of the frame: how wide the interval may be
constexpr double telling_interval = 0.5;                        // s: the GUI's own frames disturb what is measured
constexpr double two_sided_95 = 1.959964;

// Neighbours may have been disturbed alike. The centres of parts in a row know little of each other once a part is
// longer than what disturbs it: they are as few as an interval can be made of, so that they are as long as possible.
std::vector<double> centres_of_parts(const std::vector<double>& samples) {
    const std::size_t length = std::max(samples.size() / fewest_parts, std::size_t(1));
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

CostInterval cost_interval(const std::vector<double>& samples) {
    const std::vector<double> differences = centres_of_parts(samples);
    return {statistics::clipped_centre(differences, 0.0), statistics::clipped_centre(differences, two_sided_95),
            statistics::clipped_centre(differences, -two_sided_95)};
}

CostInterval cost_of_ratios(const std::vector<double>& log_ratios, double frame_ms) {
    const CostInterval ratio = cost_interval(log_ratios);
    const auto milliseconds = [frame_ms](double value) { return frame_ms * std::expm1(value); };
    return {milliseconds(ratio.estimate), milliseconds(ratio.low), milliseconds(ratio.high)};
}

CostInterval with_few_pairs(const CostInterval& interval, std::size_t pairs, double frame_ms) {
    const double more = two_sided_95 * pair_deviation * frame_ms / std::sqrt(double(std::max(pairs, std::size_t(1))));
    return {interval.estimate, interval.estimate - std::hypot(interval.estimate - interval.low, more),
            interval.estimate + std::hypot(interval.high - interval.estimate, more)};
}

std::string cost_text(const Cost& cost) {
    char text[160];
    if (!cost.error.empty())
        return cost.error;
    if (!std::isfinite(cost.frame.low) || !std::isfinite(cost.frame.high) || cost.rounds < 2)
        return cost.waits ? "waits until the scene is at rest ..." : "measuring ...";
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

// What a round found, of two frames with each value, or what a pair of copies did.
struct CostThread::Sample {
    double frame_ms = 0.0, log_ratio = 0.0; // with the first value; second to first
    std::map<std::string, double> passes;   // by how much longer they took, ms
};

struct CostThread::Samples {
    std::vector<double> frame_ms, log_ratios;
    std::map<std::string, std::vector<double>> passes; // those that were in all samples have as many

    void add(const Sample& sample) {
        for (const auto& [name, difference] : sample.passes)
            if (auto& differences = passes[name]; differences.size() == log_ratios.size())
                differences.push_back(difference);
        frame_ms.push_back(sample.frame_ms);
        log_ratios.push_back(sample.log_ratio);
    }
    std::size_t size() const { return log_ratios.size(); }
    Sample centre() const {
        Sample result{statistics::median(frame_ms), statistics::clipped_centre(log_ratios, 0.0), {}};
        for (const auto& [name, differences] : passes)
            if (differences.size() == size())
                result.passes[name] = statistics::clipped_centre(differences, 0.0);
        return result;
    }
};

// One comparison on its way.
struct CostThread::Work {
    SceneChange scene;
    std::string setting;
    gi::Settings from;
    ViewRequest view;
    std::string to_text;
    Samples rounds;             // all of them
    std::vector<Samples> pairs; // the same, by pair of copies
    std::size_t turns = 0, next_look = first_look;
    bool narrow = false;
    double built = 0.0, seconds = 0.0, told = 0.0; // s: that copies took, that rounds did, and when these were told

    // By pair, where there are enough; else by round.
    Samples samples() const {
        if (pairs.size() < enough_pairs)
            return rounds;
        Samples centres;
        for (const Samples& pair : pairs)
            centres.add(pair.centre());
        return centres;
    }
    CostInterval interval() const {
        const double frame = statistics::median(rounds.frame_ms);
        const CostInterval found = cost_of_ratios(samples().log_ratios, frame);
        return pairs.size() < enough_pairs ? with_few_pairs(found, pairs.size(), frame) : found;
    }
    bool makes_another_pair(double longest) const {
        const double next = pairs.empty() ? 0.0 : built / double(pairs.size());
        return pairs.size() < fewest_pairs || built + next <= std::max(building_share * longest, seconds);
    }
    bool is_precise() {
        if (++turns < next_look)
            return false;
        next_look += next_look / 4;
        const CostInterval now = interval();
        const bool was_narrow =
            std::exchange(narrow, now.high - now.low <= precise_share * statistics::median(rounds.frame_ms));
        return narrow && was_narrow;
    }
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
    Cost result = cost_;
    result.waits = waits_ && !result.finished;
    return result;
}

// Until the user's own picture is finished. False: there is nothing to wait for any more.
bool CostThread::wait_for_turn() const {
    while (!abandoned_ && busy_()) {
        waits_ = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    waits_ = false;
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
Result<std::optional<CostThread::Sample>> CostThread::round(const Copies& copies, const ViewRequest& view) {
    std::array<double, 2> log_ms{};                       // by value, the sum
    std::map<std::string, std::array<double, 2>> pass_ms; // likewise; a frame without the pass counts as none
    for (const std::size_t value : {0u, 1u, 1u, 0u}) {
        if (!wait_for_turn())
            return std::optional<Sample>();
        std::map<std::string, double> passes;
        SUNFLECK_ASSIGN(const double milliseconds, frame(*copies[value], view, passes));
        log_ms[value] += std::log(milliseconds);
        for (const auto& [name, time] : passes)
            pass_ms[name][value] += time;
    }
    Sample result{std::exp(0.5 * log_ms[0]), 0.5 * (log_ms[1] - log_ms[0]), {}};
    for (const auto& [name, times] : pass_ms)
        result.passes[name] = 0.5 * (times[1] - times[0]);
    return std::optional<Sample>(std::move(result));
}

void CostThread::publish(const Work& work, bool finished) {
    const std::scoped_lock lock(mutex_);
    if (abandoned_) // something else is asked for already, or nothing
        return;
    cost_.rounds = work.rounds.size();
    cost_.pairs = work.pairs.size();
    cost_.seconds = work.seconds;
    cost_.frame_ms = statistics::median(work.rounds.frame_ms);
    cost_.frame = work.interval();
    cost_.finished = finished;
    cost_.passes.clear();
    const Samples samples = work.samples();
    for (const auto& [name, differences] : samples.passes)
        if (const CostInterval interval = cost_interval(differences);
            differences.size() == samples.size() && !interval.includes_zero())
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
    const viewer::PictureSize size = viewer::small_picture({work.view.width, work.view.height});
    ViewRequest small = work.view; // what is kept does not depend on the picture
    small.width = size.width;
    small.height = size.height;
    SUNFLECK_TRY(viewer::prepare_lighting(copy->renderer(), request_of(small), options));
    std::map<std::string, double> unused;
    for (int i = 0; i < warm_up_frames && wait_for_turn(); ++i)
        SUNFLECK_TRY(frame(*copy, work.view, unused));
    return copy;
}

// By turns the one with the first value or the other is made first.
Result<CostThread::Copies> CostThread::prepared_copies(const Work& work) {
    Copies copies;
    const std::size_t first = work.pairs.size() % 2;
    for (const std::size_t i : {first, 1 - first}) {
        SUNFLECK_ASSIGN(copies[i], prepared_copy(work, i == 0 ? work.from : *work.scene.settings));
    }
    return copies;
}

// Rounds for so long, s, and two at least. False: abandoned.
Result<bool> CostThread::turn(const Copies& copies, Work& work, double length) {
    const auto began = CostClock::now();
    const double before = work.seconds;
    for (std::size_t rounds = 0; rounds < 2 || work.seconds - before < length; ++rounds) {
        SUNFLECK_ASSIGN(const std::optional<Sample> found, round(copies, work.view));
        if (!found)
            return false;
        work.pairs.back().add(*found);
        work.rounds.add(*found);
        work.seconds = before + seconds_of(CostClock::now() - began);
        if (work.seconds - work.told > telling_interval) {
            work.told = work.seconds;
            publish(work, false);
            wake_();
        }
    }
    return true;
}

Status CostThread::measure(Work& work) {
    Copies copies;
    const double longest_turn = longest_share * effort_.longest;
    for (bool precise = false; work.pairs.size() < fewest_pairs || (!precise && work.seconds < effort_.longest);) {
        if (work.makes_another_pair(effort_.longest)) {
            const auto began = CostClock::now();
            copies = {}; // the memory of these first
            SUNFLECK_ASSIGN(copies, prepared_copies(work));
            work.built += seconds_of(CostClock::now() - began);
            work.pairs.emplace_back();
        }
        const double quarter = 0.25 * work.built / double(work.pairs.size());
        SUNFLECK_ASSIGN(const bool whole, turn(copies, work, std::min(std::max(quarter, shortest_turn), longest_turn)));
        if (!whole)
            return {};
        precise = work.is_precise() && work.seconds >= effort_.shortest;
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
            if (!status && !abandoned_) {
                cost_.error = status.error().message;
                cost_.finished = true;
            }
        }
        work.reset();
        device_.pipelines().drop_unused(); // of what the settings were compared with
        return_free_memory();              // the copies'
        wake_();
    }
}

} // namespace sunfleck::editor
