#include "viewer/lighting_change.h"

#include "engine/core/caught.h"
#include "engine/core/jobs.h"

namespace sunfleck::viewer {
namespace {

// GPU time, ms: by so much may a portion delay a frame.
constexpr double portion = 20.0;

} // namespace

LightingChange::LightingChange(gpu::Device& device, SceneRenderer& renderer, const gi::Settings& settings,
                               Varying varying)
    : device_(device), settings_(settings),
      picture_(small_picture({renderer.shown_request().width, renderer.shown_request().height})),
      copy_(renderer.copy_scene(SceneRenderer::CopyOf::all)) {
    if (varying == Varying::known)
        varying_lights_ = renderer.lighting().sample_set().varying_lights();
    thread_ = std::thread([this] { run_alone([this] { run(); }); });
}

LightingChange::~LightingChange() {
    if (shown_ != nullptr && !ended())
        static_cast<void>(shown_->submission().wait(last_old_frame_));
    cancel();
    thread_.join();
}

void LightingChange::cancel() {
    stop_ = true;
    changed_.notify_all();
}

void LightingChange::go_to(Stage stage) {
    {
        const std::scoped_lock lock(mutex_);
        stage_ = stage;
    }
    changed_.notify_all();
}

// False: cancelled.
bool LightingChange::wait_while(Stage stage) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return stage_ != stage || stop_; });
    return !stop_;
}

void LightingChange::run() {
    status_ = caught([&] { return prepare(); });
    renderer_.reset();
    copy_.reset();
    go_to(Stage::ended);
}

Status LightingChange::light_copy() {
    SUNFLECK_TRY(renderer_->take_scene(std::move(copy_)));
    FrameRequest request;
    request.width = picture_.width;
    request.height = picture_.height;
    request.picture = false; // what is kept does not depend on it
    request.simulate = false;
    const auto progress = [this](float share) {
        share_ = std::max(share_.load(), share);
        return !stop_;
    };
    return prepare_lighting(*renderer_, request, {portion, progress});
}

Status LightingChange::prepare() {
    SUNFLECK_ASSIGN(renderer_, SceneRenderer::create(device_, 1));
    renderer_->lighting().expect_varying(varying_lights_);
    SUNFLECK_TRY(renderer_->lighting().set_settings(settings_));
    SUNFLECK_TRY(light_copy());
    go_to(Stage::prepared); // light of the scene as it was: what moved since comes next
    if (!wait_while(Stage::prepared))
        return {};
    SUNFLECK_TRY(light_copy());
    go_to(Stage::caught_up);
    if (wait_while(Stage::caught_up))
        wait_while(Stage::handed_over);
    return {};
}

Result<bool> LightingChange::advance(SceneRenderer& renderer) {
    switch (stage_) {
    case Stage::prepared:
        copy_ = renderer.copy_scene(SceneRenderer::CopyOf::world);
        go_to(Stage::catching_up);
        return false;
    case Stage::caught_up:
        if (stop_)
            return false;
        renderer.exchange_lighting(*renderer_);
        shown_ = &renderer;
        last_old_frame_ = renderer.submission().serial() - 1;
        go_to(Stage::handed_over);
        return true;
    case Stage::handed_over: {
        SUNFLECK_ASSIGN(const std::uint64_t completed, renderer.submission().completed());
        if (completed >= last_old_frame_)
            go_to(Stage::releasing);
        return false;
    }
    case Stage::ended:
        if (!status_ && !stop_)
            return status_.error();
        return false;
    default:
        return false;
    }
}

void LightingChanges::request(const gi::Settings& settings) {
    cancel();
    wanted_ = settings;
    begins_ = Clock::now() + quiet_time;
    varying_ = LightingChange::Varying::known;
}

void LightingChanges::renew(const gi::Settings& settings) {
    cancel();
    wanted_ = settings;
    begins_ = Clock::now() + long_quiet_time;
    varying_ = LightingChange::Varying::none;
}

void LightingChanges::cancel() {
    wanted_.reset();
    if (change_ && !handed_over_) {
        change_->cancel();
        cancelled_ = true;
    }
}

Result<bool> LightingChanges::advance(SceneRenderer& renderer) {
    if (change_) {
        const bool ended = change_->ended();
        const Result<bool> changed = change_->advance(renderer);
        if (changed && *changed)
            handed_over_ = true;
        if (ended) {
            change_.reset();
            handed_over_ = cancelled_ = false;
        }
        return changed;
    }
    if (!wanted_ && renderer.lighting().outdated()) {
        wanted_ = renderer.lighting().settings();
        begins_ = Clock::now();
        varying_ = LightingChange::Varying::known;
    }
    if (!wanted_ || Clock::now() < begins_)
        return false;
    change_ = std::make_unique<LightingChange>(device_, renderer, *wanted_, varying_);
    wanted_.reset();
    return false;
}

} // namespace sunfleck::viewer
