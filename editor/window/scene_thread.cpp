#include "editor/window/scene_thread.h"

#include "engine/core/caught.h"
#include "engine/core/memory_limit.h"
#include "engine/simulation/path_movers.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sunfleck::editor {
namespace {

// After a movement of the camera one for the picture, and one for what is told a frame later.
constexpr int frames_after_view = 2;
constexpr double longest_silence = 3.0; // s: edits do not cancel lighting while the picture has been old for so long
constexpr double most_steps = 12.0;     // of simulation in a frame
constexpr double progress_interval = 0.1;
constexpr std::chrono::milliseconds light_interval{10}; // between looks at light that is being prepared
constexpr std::chrono::seconds rest{1};                 // without anything to draw

} // namespace

SceneThread::SceneThread(gpu::Device& device, std::function<void()> wake)
    : device_(&device), wake_(std::move(wake)), thread_([this] { run(); }) {}

SceneThread::~SceneThread() {
    end();
    const bool has_device = copy_ != nullptr;
    forget_device();
    if (has_device)
        device_->pipelines().drop_unused();
}

void SceneThread::end() {
    if (!thread_.joinable())
        return;
    {
        const std::scoped_lock lock(mutex_);
        stop_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

void SceneThread::forget_device() {
    end();
    light_.reset();
    play_.reset();
    copy_.reset();
    pictures_.clear();
    newest_.reset();
    inspected_.reset();
    listing_.reset();
    inspected_state_ = {};
    change_ = next_change_ = {};
    light_pending_ = refining_ = change_waits_ = false;
    status_.busy = busy_ = status_.building = false;
    status_.error.clear();
}

void SceneThread::use_device(gpu::Device& device) {
    device_ = &device;
    stop_ = false;
    view_changed_ = true;
    inspection_changed_ = true;
    thread_ = std::thread([this] { run(); });
}

void SceneThread::change(SceneChange change) {
    {
        const std::scoped_lock lock(mutex_);
        next_change_.add(std::move(change));
        change_waits_ = true;
    }
    changed_.notify_one();
}

void SceneThread::show(const ViewRequest& request) {
    {
        const std::scoped_lock lock(mutex_);
        next_view_ = request;
        view_changed_ = true;
    }
    changed_.notify_one();
}

void SceneThread::step(std::uint32_t steps) {
    {
        const std::scoped_lock lock(mutex_);
        steps_ += steps;
    }
    changed_.notify_one();
}

void SceneThread::replace_shader(CompiledShader shader) {
    {
        const std::scoped_lock lock(mutex_);
        next_shaders_.push_back(std::move(shader));
    }
    changed_.notify_one();
}

void SceneThread::inspect(std::optional<InspectRequest> request) {
    {
        const std::scoped_lock lock(mutex_);
        next_inspection_ = request;
        inspection_changed_ = true;
        inspected_.reset();
    }
    changed_.notify_one();
}

std::shared_ptr<const InspectedPixel> SceneThread::inspected() const {
    const std::scoped_lock lock(mutex_);
    return inspected_;
}

std::shared_ptr<ScenePicture> SceneThread::picture() const {
    const std::scoped_lock lock(mutex_);
    return newest_;
}

std::vector<FrameNote> SceneThread::frame_notes() const {
    const std::scoped_lock lock(mutex_);
    return frame_notes_;
}

SceneStatus SceneThread::status() const {
    const std::scoped_lock lock(mutex_);
    return status_;
}

bool SceneThread::has_work() const {
    const bool draws = copy_ != nullptr && !failed_ && view_.width > 0 && view_.height > 0;
    return next_change_.source != nullptr || view_changed_ || steps_ > 0 || !next_shaders_.empty() ||
           inspection_changed_ || !next_actions_.empty() || (draws && draws_frame());
}

// What the GUI asked for becomes the thread's own. False: the thread ends.
bool SceneThread::take_work() {
    std::unique_lock lock(mutex_);
    if (!has_work() && !light_comes() && !stop_ && status_.busy) {
        status_.busy = busy_ = false;
        lock.unlock();
        wake_();
        lock.lock();
    }
    const auto wakes = [this] { return stop_ || has_work(); };
    if (light_comes())
        changed_.wait_for(lock, light_interval, wakes);
    else if (!changed_.wait_for(lock, rest, wakes)) {
        lock.unlock();
        if (std::exchange(is_other_scene_, false))
            device_->pipelines().drop_unused(); // kernels that only the scene before needed
        device_->memory().free_spares();
        return_free_memory(); // of old lighting, large geometry, the widest picture
        lock.lock();
        changed_.wait(lock, wakes);
    }
    if (stop_)
        return false;
    status_.busy = busy_ = true;
    failed_ = false;
    if (next_change_.source != nullptr) {
        change_.add(std::exchange(next_change_, {}));
        change_waits_ = false;
        frames_left_ = std::max(frames_left_, frames_after_edit);
    }
    new_shaders_ = std::exchange(next_shaders_, {});
    inspection_ = next_inspection_;
    if (std::exchange(inspection_changed_, false) && !view_.listing.empty())
        frames_left_ = std::max(frames_left_, 1);
    actions_ = std::exchange(next_actions_, {});
    if (!actions_.empty())
        frames_left_ = std::max(frames_left_, frames_after_view);
    if (std::exchange(view_changed_, false)) {
        const bool other_motion = next_view_.playing != view_.playing || next_view_.paused != view_.paused;
        if (other_motion)
            played_until_ = Clock::now();
        view_ = next_view_;
        frames_left_ = std::max(frames_left_, other_motion ? frames_after_edit : frames_after_view);
    }
    asked_steps_ += std::exchange(steps_, 0u);
    if (asked_steps_ > 0)
        frames_left_ = std::max(frames_left_, frames_after_edit);
    return true;
}

void SceneThread::run() {
    while (take_work())
        if (const Status done = caught([this] { return work(); }); !done)
            fail(done.error());
}

Status SceneThread::work() {
    if (change_.source != nullptr)
        SUNFLECK_TRY(apply_change());
    use_shaders(std::exchange(new_shaders_, {}));
    if (copy_ == nullptr || failed_ || view_.width == 0 || view_.height == 0)
        return {};
    follow_play();
    follow_light();
    take_actions(std::exchange(actions_, {}));
    if (draws_frame())
        frame();
    follow_inspection();
    return {};
}

// Also by renderers and lightings that come later.
void SceneThread::use_shaders(const std::vector<CompiledShader>& shaders) {
    for (const CompiledShader& shader : shaders) {
        const Status replaced = copy_ ? copy_->renderer().replace_shader(shader.path, shader.words) : Status();
        const std::scoped_lock lock(mutex_);
        status_.bad_shader = replaced ? "" : replaced.error().message;
        if (!replaced)
            continue;
        std::erase_if(shaders_, [&](const CompiledShader& known) { return known.path == shader.path; });
        shaders_.push_back(shader);
    }
    if (!shaders.empty())
        frames_left_ = std::max(frames_left_, frames_after_edit);
}

// New light that is ready is in use from the next frame on.
void SceneThread::follow_light() {
    if (light_->pending() && hand_moves())
        put_light_off();
    const Result<bool> changed = light_->advance(copy_->renderer());
    if (!changed)
        return fail(Error{"the lighting could not be made: " + changed.error().message});
    if (*changed) {
        use_shaders(std::vector(shaders_));
        frames_left_ = std::max(frames_left_, frames_after_edit);
    }
    note_light();
}

// What is being prepared is of the scene before.
void SceneThread::put_light_off() {
    if (light_->prepares()) {
        const std::scoped_lock lock(mutex_);
        ++status_.cancelled;
    }
    const gi::Settings& settings = copy_->renderer().lighting().settings();
    if (light_->renews())
        light_->renew(settings);
    else
        light_->request(settings);
}

void SceneThread::note_light() {
    const gi::System& lighting = copy_->renderer().lighting();
    const bool outdated = lighting.outdated();
    // Begun by the scene's own accord, it would be at once, while a hand still drags.
    if (outdated && (!light_->pending() || light_->renews()))
        light_->request(lighting.settings());
    else if (!light_->pending() && play_ == nullptr && lighting.sample_set().follows_changes())
        light_->renew(lighting.settings());
    const bool pending = light_->pending() || outdated || copy_->renderer().geometry_outdated();
    bool tell = false;
    {
        const std::scoped_lock lock(mutex_);
        tell = pending != light_pending_ || (pending && light_->share() > status_.share + 0.02f);
        status_.builds += light_pending_ && !pending ? 1 : 0;
        if (pending || light_pending_)
            status_.building = pending;
        if (tell)
            status_.share = light_->share();
        light_pending_ = pending;
    }
    if (tell)
        wake_();
}

Status SceneThread::apply_change() {
    const SceneChange change = std::exchange(change_, {});
    // Handles that the copy has no room for: the picture stays as it is until everything is told.
    if (copy_ != nullptr && !change.everything && !copy_->takes(change)) {
        failed_ = true;
        wants_everything_ = true;
        wake_();
        return {};
    }
    if (change.everything) {
        light_.reset();
        play_.reset();
        copy_.reset();
        exposure_is_old_ = is_other_scene_ = true;
        SUNFLECK_ASSIGN(copy_, SceneCopy::create(*device_));
        light_ = std::make_unique<viewer::LightingChanges>(*device_);
        light_is_slow_ = false;
        longest_frame_ms_ = 0.0;
    }
    if (play_ != nullptr) {
        SUNFLECK_TRY(play_->edit(copy_->renderer().registry(), copy_->renderer().meshes(), change.updates,
                                 [&] { return copy_->apply(change); }));
    } else {
        SUNFLECK_TRY(copy_->apply(change));
    }
    if (change.everything)
        use_shaders(std::vector(shaders_));
    revision_ = change.revision;
    hiding_ = change.hiding;
    dragged_ = change.dragged;
    if (light_pending_ && !change.is_empty())
        put_light_off();
    return {};
}

bool SceneThread::go_on(float share) {
    if (stop_)
        return false;
    const double elapsed = seconds_since(build_began_);
    if (change_waits_ && elapsed > patience && seconds_since(last_frame_) < longest_silence) {
        cancelled_ = true;
        return false;
    }
    bool tell = false;
    {
        const std::scoped_lock lock(mutex_);
        status_.building = elapsed > patience;
        status_.share = share;
        tell = status_.building && elapsed > told_ + progress_interval;
    }
    if (tell) {
        told_ = elapsed;
        wake_();
    }
    return true;
}

// Play begins and ends with the view.
void SceneThread::follow_play() {
    ecs::Registry& registry = copy_->renderer().registry();
    if (view_.playing && play_ == nullptr) {
        play_ = std::make_unique<ScenePlay>(registry, copy_->renderer().meshes());
        owed_steps_ = 0.0;
    }
    if (!view_.playing && play_ != nullptr) {
        play_->end(registry);
        play_.reset();
        asked_steps_ = 0;
    }
    for (; play_ != nullptr && asked_steps_ > 0; --asked_steps_)
        play_->step(registry);
}

void SceneThread::frame() {
    if (moves()) {
        const double seconds = seconds_since(std::exchange(played_until_, Clock::now()));
        owed_steps_ = std::min(owed_steps_ + seconds / simulation::step_seconds, most_steps);
        for (; owed_steps_ >= 1.0; owed_steps_ -= 1.0)
            play_->step(copy_->renderer().registry());
    }
    if (number_ == 0 || moves())
        last_frame_ = Clock::now();
    cancelled_ = false;
    const Status drawn = draw_picture();
    {
        const std::scoped_lock lock(mutex_);
        const bool was_long = std::exchange(status_.building, light_pending_) && !light_pending_;
        status_.builds += was_long && drawn ? 1 : 0;
        status_.cancelled += cancelled_ ? 1 : 0;
    }
    if (drawn || cancelled_ || stop_) {
        frames_left_ -= drawn && frames_left_ > 0 ? 1 : 0;
        return;
    }
    fail(drawn.error());
}

void SceneThread::fail(const Error& error) {
    failed_ = true;
    frames_left_ = 0;
    {
        const std::scoped_lock lock(mutex_);
        status_.error = error.message;
        status_.building = light_pending_ = refining_ = false;
    }
    wake_();
}

} // namespace sunfleck::editor
