// Draws the scene on a thread of its own, so that the GUI never waits for it: a copy of the document, its lighting and
// the pictures of the viewport. Frames are drawn only where something asks for them; where nothing changes any more,
// the thread sleeps.
//
// Where light takes long to make, edits that need new light (a wall moves, another number of samples) show at once in
// the old one, while the new one is prepared behind the frames (lighting_change.h); a further edit cancels that. While
// a hand drags, shadows of what stands still wait, too: they follow when it rests. Samples that have followed lamps are
// renewed once the scene is left alone, so that what was edited looks as it will when it is opened. Light is refined
// while nobody does anything: frames that do so keep the device busy, and the GUI draws with it.
//
// All functions may be called from the GUI thread; none of them waits for a frame.
#pragma once

#include "editor/document/played_places.h"
#include "editor/window/scene_copy.h"
#include "editor/window/scene_play.h"
#include "editor/window/shader_watch.h"
#include "viewer/lighting_change.h"
#include "viewer/picture_settings.h"
#include "viewer/pixel_report.h"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace sunfleck::editor {

// What the viewport shows.
struct ViewRequest {
    scene::CameraView camera;
    std::uint32_t width = 0, height = 0; // pixels; 0: nothing is drawn
    std::uint32_t view = shared::view_final;
    std::string lighting_view;         // FrameRequest::lighting_view
    std::vector<std::string> overlays; // FrameRequest::overlays
    std::optional<std::uint32_t> chosen_sample;
    std::string listing; // of gi::all_listings(): is filled with each picture; empty: none
    viewer::PictureSettings look;
    std::optional<float> ev100;  // in place of the scene's, or of what the picture asks for
    std::uint32_t exposures = 0; // raised: it is exposed again by its picture
    bool playing = false;        // the scene is in motion; when it ends, all stands as edited
    bool paused = false;         // then: steps are made by step() alone
    bool read_back = false;      // settled pictures have their pixels on the CPU, too
};

// A place of the picture that is looked into, as a ray in the world: it stays where it is when the camera moves.
struct InspectRequest {
    scene::CameraView camera; // that it was chosen from
    std::uint32_t width = 0, height = 0;
    float x = 0.5f, y = 0.5f; // in the picture, shares of its width and height
    std::uint64_t serial = 0; // another for every request
};

// What is there, once the picture has settled.
struct InspectedPixel {
    viewer::PixelReport report;
    vec3 shown{0.0f};           // irradiance in the picture, W/m2
    std::uint64_t serial = 0;   // of the request
    std::uint64_t revision = 0; // of the document
};

// A table of what the lighting keeps, as of the newest picture.
struct ShownListing {
    std::string name;
    gi::ListingContent content;
};
// What is asked of one of its rows.
struct RowAction {
    std::string listing;
    std::uint32_t action = 0, key = 0;
    bool on = false;
};

// A finished picture, in its blit-source state. Its memory is used again when nobody holds it.
struct ScenePicture {
    gpu::Image image;
    scene::CameraView camera;
    std::uint64_t revision = 0; // of the document
    std::uint64_t hiding = 0;   // SceneChange::hiding
    std::uint64_t number = 0;   // of the frame
    std::uint64_t step = 0;     // of the simulation
    bool settled = false;       // nothing more comes unless something changes
    float ev100 = 0.0f;
    double frame_ms = 0.0;
    viewer::FrameStatistics statistics;
    std::shared_ptr<const io::Picture> pixels;  // display values, of settled pictures where they were asked for
    std::shared_ptr<const PlayedPlaces> played; // where everything stands in it; null: as edited
};

// What the thread does, for the status bar and --report.
struct SceneStatus {
    bool busy = false;      // it draws, or has something to draw
    bool building = false;  // lighting that takes long, in a frame or behind the frames
    float share = 0.0f;     // of that, done
    std::string error;      // why there is no picture; empty: there is
    std::string bad_shader; // why the shader that came last is not in use; empty: it is
    // Pictures; lighting that took long, done; such that was under way when an edit made it useless.
    std::uint64_t frames = 0, builds = 0, cancelled = 0;
    double longest_frame_ms = 0.0;
};

// When a frame was finished, for --report.
struct FrameNote {
    double at = 0.0; // s on the system's clock
    double milliseconds = 0.0;
};
inline double seconds_now() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class SceneThread {
public:
    // `wake` is called from the thread whenever there is something new to show. The device must outlive this.
    SceneThread(gpu::Device& device, std::function<void()> wake);
    // Cancels what it does.
    ~SceneThread();
    // The device is lost: cancels, and lets go of all that lies on it. Nothing is drawn until use_device.
    void forget_device();
    // Another device, which must outlive this. The thread must be told everything again; shaders stay replaced.
    void use_device(gpu::Device& device);
    SceneThread(const SceneThread&) = delete;
    SceneThread& operator=(const SceneThread&) = delete;

    void change(SceneChange change);
    void show(const ViewRequest& request);
    // While the view plays: so many steps of simulation, once.
    void step(std::uint32_t steps);
    // Answered now and whenever the settled picture changes; nothing is asked: no longer.
    void inspect(std::optional<InspectRequest> request);
    // The newest answer; null: there is none.
    std::shared_ptr<const InspectedPixel> inspected() const;
    // Of the listing that was asked for; null: there is none yet.
    std::shared_ptr<const ShownListing> listing() const;
    // From the next frame on.
    void act(RowAction action);
    // From the next frame on. Where its pipeline cannot be made, status() says so and the old shader stays.
    void replace_shader(CompiledShader shader);
    // The newest picture; null before the first one.
    std::shared_ptr<ScenePicture> picture() const;
    SceneStatus status() const;
    // Of the first thousands of frames.
    std::vector<FrameNote> frame_notes() const;
    // Somebody points, types or flies: what goes on by itself waits until the hand rests, so that the window answers at
    // once.
    void note_hand() { hand_rests_at_ = Clock::now() + hand_pause; }
    bool hand_rests() const { return Clock::now() >= hand_rests_at_.load(); } // from any thread
    // SceneStatus::busy, at once and from any thread.
    bool busy() const { return busy_; }
    // The document has outgrown the copy, which is to be told everything: true once each time.
    bool wants_everything() { return wants_everything_.exchange(false); }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds hand_pause{300}; // longer than between the movements of one gesture
    static constexpr double patience = 0.3; // s: lighting that takes longer is cancelled by the next edit
    // As many as `sunfleck render` draws, so that both show the same.
    static constexpr int frames_after_edit = 4;
    static double seconds_since(Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    }
    void run();
    Status work();
    void end();
    bool moves() const { return view_.playing && !view_.paused; }
    bool draws_frame() const { return frames_left_ > 0 || moves() || (refining_ && hand_rests()); }
    bool light_comes() const { return light_pending_ || refining_; }
    std::uint64_t steps() const { return play_ != nullptr ? play_->steps() : 0; }
    void follow_play();
    bool has_work() const;
    bool take_work();
    Status apply_change();
    void frame();
    Status draw(const viewer::FrameRequest& request, ScenePicture* picture);
    Status expose(viewer::FrameRequest& request);
    Status draw_picture();
    Status look_into_pixel();
    void follow_inspection();
    void take_actions(const std::vector<RowAction>& actions);
    void fill_listing();
    viewer::FrameRequest frame_request();
    bool go_on(float share);
    Result<std::shared_ptr<ScenePicture>> free_picture();
    void publish(std::shared_ptr<ScenePicture> picture);
    void fail(const Error& error);
    void follow_light();
    // What a hand moves lets light be until it rests.
    bool hand_moves() const { return dragged_ && frames_left_ > 1; }
    void use_shaders(const std::vector<CompiledShader>& shaders);
    void note_light();
    void put_light_off();

    gpu::Device* device_;
    const std::function<void()> wake_;

    mutable std::mutex mutex_; // of all until the next comment
    std::condition_variable changed_;
    SceneChange next_change_;
    ViewRequest next_view_;
    bool view_changed_ = false;
    std::vector<CompiledShader> next_shaders_;
    std::uint32_t steps_ = 0;
    std::optional<InspectRequest> next_inspection_;
    bool inspection_changed_ = false;
    std::shared_ptr<const InspectedPixel> inspected_;
    std::vector<RowAction> next_actions_;
    std::shared_ptr<const ShownListing> listing_;
    std::shared_ptr<ScenePicture> newest_;
    SceneStatus status_;
    std::vector<FrameNote> frame_notes_;

    std::atomic<Clock::time_point> hand_rests_at_{};
    std::atomic<bool> stop_{false}, change_waits_{false}, busy_{false}, wants_everything_{false};
    // Of the thread alone.
    std::unique_ptr<SceneCopy> copy_;
    std::unique_ptr<viewer::LightingChanges> light_; // of copy_, which it does not outlive
    std::unique_ptr<ScenePlay> play_;                // of copy_; null: it stands as edited
    bool light_pending_ = false;                     // the picture has not got all of its light yet
    bool refining_ = false;                          // its light is refined by the frames that follow
    bool dragged_ = false;                           // the gesture of the last change has not ended
    std::vector<CompiledShader> shaders_;            // in place of those of the program
    std::vector<CompiledShader> new_shaders_;        // not in use yet
    SceneChange change_;                             // not applied yet
    std::vector<RowAction> actions_;                 // likewise
    ViewRequest view_;
    std::optional<InspectRequest> inspection_;
    // What the newest answer is of: request, document, step, lightings made so far.
    std::array<std::uint64_t, 5> inspected_state_{};
    std::vector<std::shared_ptr<ScenePicture>> pictures_;
    Clock::time_point build_began_, last_frame_, played_until_;
    std::uint64_t revision_ = 0, hiding_ = 0, number_ = 0;
    std::uint32_t asked_steps_ = 0; // by step()
    double owed_steps_ = 0.0;
    int frames_left_ = 0;
    bool failed_ = false, exposure_is_old_ = true;
    bool is_other_scene_ = false; // than at the last rest
    // Light of its scene takes so long to make that it is made behind the frames; else the frame makes it. Once it is
    // so, it stays: a frame that makes light is one that the window waits for.
    bool light_is_slow_ = false;
    double longest_frame_ms_ = 0.0; // of the pictures of copy_
    std::atomic<bool> cancelled_{false};
    double told_ = 0.0; // s after the build began
    float automatic_ev100_ = 0.0f;
    std::uint32_t exposures_ = 0; // ViewRequest::exposures of these
    std::thread thread_;
};

} // namespace sunfleck::editor
