// Other lighting for a scene that is shown: prepared on a thread of its own while frames go on with the present one.
//
//     LightingChanges changes(device);
//     changes.request(settings);                   // whenever the person changes something
//     each frame, with FrameRequest::keep_samples, before SceneRenderer::update:
//         auto changed = changes.advance(renderer); // true: from this frame on, the new lighting is in use
//     changes.renew(settings);                     // when the scene is left alone: as a start with it would make it
//
// The thread lights a copy of the scene with a renderer of its own, on the same device and queue. When its samples,
// visibility and shadow maps are there, it takes over what moved in the meantime, and the two renderers exchange their
// lighting between two frames. A further request cancels the one before; the frame never waits for either. While a
// change is prepared, the light's memory is there twice.
//
// When a change takes effect depends on how fast the machine is. Runs that must repeat (headless, tests, replays) set
// settings at once by gi::System::set_settings, and wait.
#pragma once

#include "viewer/preparation.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

namespace sunfleck::viewer {

// One change of lighting. All functions are for the thread that draws.
class LightingChange {
public:
    // Which lights vary: those that the renderer's lighting has seen change, or, as at a start, none.
    enum class Varying { known, none };
    // Copies the scene of `renderer`, which must be up to date, and begins. Device and renderer must outlive the
    // change.
    LightingChange(gpu::Device& device, SceneRenderer& renderer, const gi::Settings& settings, Varying varying);
    // Cancels and waits, which takes a fraction of a second, also for frames that use what it took over.
    ~LightingChange();
    LightingChange(const LightingChange&) = delete;
    LightingChange& operator=(const LightingChange&) = delete;

    // Does not wait: `ended` tells when nothing of it is left.
    void cancel();
    bool ended() const { return stage_ == Stage::ended; }
    // Between frames. True, once: `renderer` has the new lighting. An error ends the change.
    Result<bool> advance(SceneRenderer& renderer);
    // Fraction done, 0 to 1.
    float share() const { return share_; }

private:
    // `prepared` and `caught_up` wait for the drawing thread, the others for the change's own.
    enum class Stage { preparing, prepared, catching_up, caught_up, handed_over, releasing, ended };
    void run();
    Status prepare();
    Status light_copy();
    bool wait_while(Stage stage);
    void go_to(Stage stage);

    gpu::Device& device_;
    const gi::Settings settings_;
    const PictureSize picture_;
    std::set<ecs::Entity> varying_lights_;
    std::unique_ptr<SceneCopy> copy_; // for the thread, in `preparing` and `catching_up`
    std::unique_ptr<SceneRenderer> renderer_;
    // Once it is handed over: whose lighting it was, and the serial of the last frame that used what came back.
    SceneRenderer* shown_ = nullptr;
    std::uint64_t last_old_frame_ = 0;
    Status status_; // once it has ended
    std::atomic<float> share_{0.0f};
    std::atomic<bool> stop_{false};
    std::atomic<Stage> stage_{Stage::preparing};
    std::mutex mutex_;
    std::condition_variable changed_;
    std::thread thread_;
};

// The changes of a renderer's lighting, one after the other, of which only the last counts.
class LightingChanges {
public:
    explicit LightingChanges(gpu::Device& device) : device_(device) {}

    // Begins when the one before has gone, and when no other request came for `quiet_time`: who drags a slider gets the
    // light of where it comes to rest.
    void request(const gi::Settings& settings);
    // The same after `long_quiet_time`, and the new lighting forgets which lights vary (SampleSet::follows_changes):
    // who tunes a lamp sees its light follow each touch, and gets that of a start once the lamp is left alone.
    void renew(const gi::Settings& settings);
    // What is pending is a renewal.
    bool renews() const { return pending() && varying_ == LightingChange::Varying::none; }
    // Also without effect on what has been handed over.
    void cancel();
    // Between frames, once each. True: from now on `renderer` has the lighting that was requested last. Where the scene
    // itself has outgrown the lighting (frames with FrameRequest::keep_samples: a wall or the sun moved, a lamp changed
    // for the first time), a change begins of its own accord; the next one waits for its end, so that what moves all
    // the time is followed from time to time.
    Result<bool> advance(SceneRenderer& renderer);
    // Whether a request has not taken effect yet, and how far it is, 0 to 1.
    bool pending() const { return wanted_.has_value() || (change_ && !handed_over_ && !cancelled_); }
    float share() const { return change_ && !cancelled_ ? change_->share() : 0.0f; }
    // A change is on its way, and not only waited for.
    bool prepares() const { return change_ && !handed_over_ && !cancelled_; }

    static constexpr std::chrono::milliseconds quiet_time{150}, long_quiet_time{1000};

private:
    using Clock = std::chrono::steady_clock;
    gpu::Device& device_;
    std::optional<gi::Settings> wanted_;
    Clock::time_point begins_{};                                       // it does, not before
    LightingChange::Varying varying_ = LightingChange::Varying::known; // of the newest
    std::unique_ptr<LightingChange> change_;
    bool handed_over_ = false, cancelled_ = false; // of change_
};

} // namespace sunfleck::viewer
