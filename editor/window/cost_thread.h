// What a setting costs: two copies of the scene, with one value and with the other, are drawn by turns, in rounds of
// four frames (A B B A), so that whatever else the machine does meets both alike. The addresses of a copy's allocations
// bias its frame time by 2 % and more, for as long as the copy exists: both copies are created again now and then, in
// alternating order. The difference and its interval are those of engine/statistics/clipped_sum.h, one implementation
// with the frame-time gate; samples are what each pair of copies has found, or, where creating them takes so long that
// there are few, the rounds, and the interval allows for what copies differ by.
#pragma once

#include "editor/window/scene_thread.h"

#include <array>

namespace sunfleck::editor {

// Of a difference, ms: the estimate and its interval at 95 %.
struct CostInterval {
    double estimate = 0.0, low = 0.0, high = 0.0;
    bool includes_zero() const { return low <= 0.0 && high >= 0.0; }
};

struct Cost {
    std::string setting, from, to;
    double frame_ms = 0.0; // with the first value, median
    CostInterval frame;
    std::vector<std::pair<std::string, CostInterval>> passes; // whose time changed, the most changed first
    std::size_t rounds = 0, pairs = 0;                        // of two frames with each value; of copies
    double seconds = 0.0;                                     // that the rounds took
    bool finished = false;                                    // also by an error
    bool waits = false;                                       // for the picture of the scene, which is not at rest
    std::string error;

    // Whether it is what a setting's value costs over an old one.
    bool is_of(std::string_view name, std::string_view value, std::string_view old_value) const {
        return setting == name && to == value && from == old_value;
    }
};

// The difference by pairs of copies, or by rounds, in the order in which they were drawn: centre and interval.
CostInterval cost_interval(const std::vector<double>& samples);
// The same where a sample is the logarithm of how many times longer the second value's frames took, as in the gate: a
// machine that is slow for a while slows both down by the same factor, and not by the same time.
CostInterval cost_of_ratios(const std::vector<double>& log_ratios, double frame_ms);
// An interval of what was found with so many pairs of copies, which allows for what these may differ by.
CostInterval with_few_pairs(const CostInterval& interval, std::size_t pairs, double frame_ms);
// "+3.2 ms (2.9 to 3.5)", "no measurable effect (less than 0.4 ms)", or what is under way.
std::string cost_text(const Cost& cost);

// How long is measured: until the interval is precise, but for as long as the first, and at most as the second, s.
struct CostEffort {
    double shortest = 0.0, longest = 60.0;
};

class CostThread {
public:
    // `busy`: whether the scene is being drawn for the user, who goes first. `wake`: there is something new.
    CostThread(gpu::Device& device, std::function<bool()> busy, std::function<void()> wake, CostEffort effort = {});
    ~CostThread();
    CostThread(const CostThread&) = delete;
    CostThread& operator=(const CostThread&) = delete;

    // Begins to measure, in place of what is being measured. `scene`: everything; its settings are the second ones.
    void measure(SceneChange scene, const std::string& setting, const gi::Settings& from, const ViewRequest& view);
    // Gives up what is being measured, and forgets what was found.
    void stop();
    Cost cost() const;

private:
    struct Work;
    struct Sample;
    struct Samples;
    using Copies = std::array<std::unique_ptr<SceneCopy>, 2>; // with the first value and the second
    void run();
    Status measure(Work& work);
    Result<std::unique_ptr<SceneCopy>> prepared_copy(const Work& work, const gi::Settings& settings);
    Result<Copies> prepared_copies(const Work& work);
    Result<double> frame(SceneCopy& copy, const ViewRequest& view, std::map<std::string, double>& passes);
    Result<std::optional<Sample>> round(const Copies& copies, const ViewRequest& view);
    Result<bool> turn(const Copies& copies, Work& work, double length);
    bool wait_for_turn() const;
    void publish(const Work& work, bool finished);

    gpu::Device& device_;
    const std::function<bool()> busy_;
    const std::function<void()> wake_;
    const CostEffort effort_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::unique_ptr<Work> next_;
    Cost cost_;
    std::atomic<bool> ends_{false}, abandoned_{false};
    mutable std::atomic<bool> waits_{false};
    std::thread thread_;
};

} // namespace sunfleck::editor
