#include "editor/window/scene_thread.h"

#include "engine/simulation/path_movers.h"
#include "viewer/exposure.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::editor {
namespace {

using Clock = std::chrono::steady_clock;

// After an edit as many frames as `sunfleck render` draws, so that both show the same; after a movement of the camera
// one for the picture, and one for what is told a frame later.
constexpr int frames_after_edit = 4, frames_after_view = 2;
constexpr double patience = 0.3;        // s: lighting that takes longer is cancelled by the next edit,
constexpr double longest_silence = 3.0; // s: unless the picture has been old for so long
constexpr double most_steps = 12.0;     // of simulation in a frame
constexpr double progress_interval = 0.1;
constexpr std::size_t most_pictures = 8;
constexpr std::chrono::milliseconds light_interval{10}; // between looks at light that is being prepared

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

} // namespace

SceneThread::SceneThread(gpu::Device& device, std::function<void()> wake)
    : device_(device), wake_(std::move(wake)), thread_([this] { run(); }) {}

SceneThread::~SceneThread() {
    {
        const std::scoped_lock lock(mutex_);
        stop_ = true;
    }
    changed_.notify_one();
    thread_.join();
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

void SceneThread::rewind() {
    {
        const std::scoped_lock lock(mutex_);
        rewind_ = true;
    }
    changed_.notify_one();
}

std::shared_ptr<ScenePicture> SceneThread::picture() const {
    const std::scoped_lock lock(mutex_);
    return newest_;
}

SceneStatus SceneThread::status() const {
    const std::scoped_lock lock(mutex_);
    return status_;
}

bool SceneThread::has_work() const {
    const bool draws = copy_ != nullptr && !failed_ && view_.width > 0 && view_.height > 0;
    return next_change_.source != nullptr || view_changed_ || rewind_ || steps_ > 0 ||
           (draws && (frames_left_ > 0 || view_.playing));
}

// What the GUI asked for becomes the thread's own. False: the thread ends.
bool SceneThread::take_work() {
    std::unique_lock lock(mutex_);
    if (!has_work() && !light_pending_ && !stop_ && status_.busy) {
        status_.busy = busy_ = false;
        lock.unlock();
        wake_();
        lock.lock();
    }
    const auto wakes = [this] { return stop_ || has_work(); };
    if (light_pending_)
        changed_.wait_for(lock, light_interval, wakes);
    else
        changed_.wait(lock, wakes);
    if (stop_)
        return false;
    status_.busy = busy_ = true;
    failed_ = false;
    if (next_change_.source != nullptr) {
        change_.add(std::exchange(next_change_, {}));
        change_waits_ = false;
        frames_left_ = std::max(frames_left_, frames_after_edit);
    }
    if (std::exchange(view_changed_, false)) {
        if (next_view_.playing != view_.playing)
            last_frame_ = Clock::now();
        view_ = next_view_;
        frames_left_ = std::max(frames_left_, frames_after_view);
    }
    const std::uint32_t steps = std::exchange(steps_, 0u);
    const bool rewound = std::exchange(rewind_, false);
    if (rewound)
        step_ = 0;
    step_ += steps;
    if (rewound || steps > 0)
        frames_left_ = std::max(frames_left_, frames_after_edit);
    return true;
}

void SceneThread::run() {
    while (take_work()) {
        if (change_.source != nullptr)
            if (const Status applied = apply_change(); !applied) {
                fail(applied.error());
                continue;
            }
        if (copy_ == nullptr || failed_ || view_.width == 0 || view_.height == 0)
            continue;
        follow_light();
        if (frames_left_ > 0 || view_.playing)
            frame();
    }
}

// New light that is ready is in use from the next frame on.
void SceneThread::follow_light() {
    const Result<bool> changed = light_->advance(copy_->renderer());
    if (!changed)
        return fail(Error{"the lighting could not be made: " + changed.error().message});
    if (*changed) {
        light_is_slow_ = seconds_since(edited_) > 2.0 * patience;
        frames_left_ = std::max(frames_left_, frames_after_edit);
    }
    note_light();
}

void SceneThread::note_light() {
    const bool pending = light_->pending() || copy_->renderer().lighting().outdated();
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
    // Handles that the copy has no room for: the document has grown beyond all expectation.
    if (copy_ != nullptr && !change.everything && !copy_->takes(change))
        return Error{"the scene has grown too much to be followed; rebuild the lighting"};
    if (change.everything) {
        light_.reset();
        copy_.reset();
        step_ = 0;
        exposure_is_old_ = true;
        SUNFLECK_ASSIGN(copy_, SceneCopy::create(device_));
        light_ = std::make_unique<viewer::LightingChanges>(device_);
        light_is_slow_ = false;
    }
    SUNFLECK_TRY(copy_->apply(change));
    revision_ = change.revision;
    edited_ = Clock::now();
    if (light_pending_) // what is being prepared is of the scene before
        light_->request(copy_->renderer().lighting().settings());
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

viewer::FrameRequest SceneThread::frame_request() {
    viewer::FrameRequest request;
    request.camera = view_.camera;
    request.width = view_.width;
    request.height = view_.height;
    request.view = view_.view;
    request.lighting_view = view_.lighting_view;
    request.show_samples = view_.show_samples;
    request.antialiasing = view_.look.antialiasing;
    request.glare = view_.look.glare;
    request.keep_samples = light_is_slow_;
    request.step = step_;
    request.progress = [this](float share) { return go_on(share); };
    return request;
}

// A picture of the right size that nobody holds.
Result<std::shared_ptr<ScenePicture>> SceneThread::free_picture() {
    std::erase_if(pictures_, [&](const auto& picture) {
        const gpu::ImageDescription& has = picture->image.description();
        return picture.use_count() == 1 && (has.width != view_.width || has.height != view_.height);
    });
    for (const auto& picture : pictures_)
        if (picture.use_count() == 1)
            return picture;
    auto picture = std::make_shared<ScenePicture>();
    gpu::ImageDescription description;
    description.name = "viewport";
    description.format = VK_FORMAT_R8G8B8A8_UNORM;
    description.width = view_.width;
    description.height = view_.height;
    // Images have views, which some use other than copies has to allow.
    description.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    SUNFLECK_ASSIGN(picture->image, gpu::Image::create(device_, description));
    if (pictures_.size() < most_pictures)
        pictures_.push_back(picture);
    return picture;
}

// Draws a frame and copies it, once it is finished, into the picture; null: draws only.
Status SceneThread::draw(const viewer::FrameRequest& request, ScenePicture* picture) {
    viewer::SceneRenderer& renderer = copy_->renderer();
    const auto copy = [&](gpu::FrameGraph& graph, gpu::ResourceId source, gpu::FrameResources&) -> Status {
        if (picture == nullptr)
            return {};
        const gpu::ResourceId target = graph.import_image(picture->image);
        graph.add_pass("viewport")
            .read(source, gpu::Usage::blit_source)
            .write(target, gpu::Usage::blit_destination)
            .execute([&renderer, picture](gpu::PassContext& context) -> Status {
                const gpu::ImageDescription& size = picture->image.description();
                VkImageBlit region{};
                region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
                region.srcOffsets[1] = region.dstOffsets[1] = {int(size.width), int(size.height), 1};
                context.device.vk.vkCmdBlitImage(context.commands, renderer.output().handle(),
                                                 VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, picture->image.handle(),
                                                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, VK_FILTER_NEAREST);
                return {};
            });
        graph.add_pass("viewport hand over").read(target, gpu::Usage::blit_source).keep();
        return {};
    };
    build_began_ = Clock::now();
    told_ = 0.0;
    SUNFLECK_TRY(renderer.update(request));
    light_is_slow_ = light_is_slow_ || seconds_since(build_began_) > patience;
    SUNFLECK_ASSIGN(const VkCommandBuffer commands, renderer.submission().begin());
    const std::uint64_t serial = renderer.submission().serial();
    SUNFLECK_TRY(renderer.record(commands, request, copy));
    SUNFLECK_TRY(renderer.submission().submit());
    SUNFLECK_TRY(renderer.submission().wait(serial));
    renderer.collect_statistics();
    return {};
}

// A scene that says no exposure is exposed by its first picture, and then left alone: an artist who turns a lamp up
// wants to see it.
Status SceneThread::expose(viewer::FrameRequest& request) {
    const std::optional<float> given = view_.ev100 ? view_.ev100 : viewer::scene_exposure(copy_->renderer().registry());
    if (!given && exposure_is_old_) {
        viewer::FrameRequest linear = request;
        linear.tone_map = false;
        linear.view = shared::view_final;
        linear.lighting_view.clear();
        SUNFLECK_TRY(draw(linear, nullptr));
        SUNFLECK_ASSIGN(const io::Picture radiance, copy_->renderer().read_back());
        automatic_ev100_ = viewer::automatic_exposure(radiance);
        exposure_is_old_ = frames_left_ > 1; // of the light as it is when it has settled
    }
    request.ev100 = given.value_or(automatic_ev100_);
    return {};
}

Status SceneThread::draw_picture() {
    viewer::FrameRequest request = frame_request();
    const auto began = Clock::now();
    SUNFLECK_TRY(expose(request));
    SUNFLECK_ASSIGN(std::shared_ptr<ScenePicture> picture, free_picture());
    SUNFLECK_TRY(draw(request, picture.get()));
    picture->camera = view_.camera;
    picture->revision = revision_;
    picture->number = ++number_;
    picture->step = step_;
    note_light();
    picture->settled = frames_left_ <= 1 && !view_.playing && !light_pending_;
    picture->ev100 = request.ev100;
    picture->frame_ms = 1e3 * seconds_since(began);
    picture->statistics = copy_->renderer().statistics();
    picture->pixels.reset();
    if (view_.read_back && picture->settled) {
        SUNFLECK_ASSIGN(io::Picture pixels, copy_->renderer().read_back());
        picture->pixels = std::make_shared<io::Picture>(std::move(pixels));
    }
    publish(std::move(picture));
    return {};
}

void SceneThread::frame() {
    if (view_.playing) {
        owed_steps_ = std::min(owed_steps_ + seconds_since(last_frame_) / simulation::step_seconds, most_steps);
        step_ += std::uint64_t(owed_steps_);
        owed_steps_ -= std::floor(owed_steps_);
    }
    if (number_ == 0 || view_.playing)
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

void SceneThread::publish(std::shared_ptr<ScenePicture> picture) {
    last_frame_ = Clock::now();
    {
        const std::scoped_lock lock(mutex_);
        status_.longest_frame_ms = std::max(status_.longest_frame_ms, picture->frame_ms);
        newest_ = std::move(picture);
        status_.error.clear();
        ++status_.frames;
    }
    wake_();
}

void SceneThread::fail(const Error& error) {
    failed_ = true;
    frames_left_ = 0;
    {
        const std::scoped_lock lock(mutex_);
        status_.error = error.message;
        status_.building = light_pending_ = false;
    }
    wake_();
}

} // namespace sunfleck::editor
