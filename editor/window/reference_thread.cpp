#include "editor/window/reference_thread.h"

#include "editor/window/picture_upload.h"
#include "engine/core/caught.h"
#include "engine/render/tone_map.h"
#include "engine/scene/deformation.h"
#include "engine/simulation/path_movers.h"
#include "gi_module/reference/path_tracer.h"

#include <algorithm>

namespace sunfleck::editor {
namespace {

using namespace gi::reference;
using TraceClock = std::chrono::steady_clock;

constexpr std::uint32_t most_samples = 4096, largest_batch = 16;
constexpr auto rest_time = std::chrono::milliseconds(50); // while the scene is being drawn
constexpr double picture_interval = 1.0;                  // s

} // namespace

struct ReferenceThread::Copy : PlainCopy {
    std::unique_ptr<raytrace::RayScene> rays;
    std::unique_ptr<PathTracer> tracer;
    Accumulation sums;
    ViewRequest view;
    std::unique_ptr<gpu::Submission> submission;
    TraceClock::time_point shown{};

    Status apply(const SceneChange& change) {
        PlainCopy::apply(change);
        simulation::set_movers_to_step(registry, 0);
        scene::deform_meshes(registry, meshes);
        tracer.reset();
        if (rays == nullptr) {
            SUNFLECK_ASSIGN(rays, raytrace::RayScene::create());
        }
        SUNFLECK_TRY(rays->update(registry, meshes, &textures));
        tracer = std::make_unique<PathTracer>(
            *rays, gi::collect_emitters(registry, meshes, viewer::scene_bounds(registry, meshes)),
            gi::collect_backgrounds(registry));
        return {};
    }

    io::Picture display() const {
        io::Picture picture;
        picture.width = sums.width;
        picture.height = sums.height;
        picture.pixels.resize(std::size_t(sums.width) * sums.height);
        const double scale = 1.0 / std::max(sums.samples, 1u);
        const float exposure = shared::exposure_factor(*view.ev100);
        for (std::size_t i = 0; i < picture.pixels.size(); ++i)
            picture.pixels[i] =
                vec4(shared::display_from_radiance(
                         vec3(sums.sums[i * 3] * scale, sums.sums[i * 3 + 1] * scale, sums.sums[i * 3 + 2] * scale),
                         exposure),
                     1.0f);
        return picture;
    }
};

ReferenceThread::ReferenceThread(gpu::Device& device, std::function<bool()> busy, std::function<void()> wake)
    : device_(device), busy_(std::move(busy)), wake_(std::move(wake)), thread_([this] { run(); }) {}

ReferenceThread::~ReferenceThread() {
    {
        const std::scoped_lock lock(mutex_);
        ends_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

void ReferenceThread::change(const SceneChange& change) {
    {
        const std::scoped_lock lock(mutex_);
        next_.add(change);
        newest_.reset();
        news_ = true;
    }
    changed_.notify_one();
}

void ReferenceThread::show(const ViewRequest& request) {
    {
        const std::scoped_lock lock(mutex_);
        next_view_ = request;
        newest_.reset();
        news_ = true;
    }
    changed_.notify_one();
}

std::shared_ptr<ScenePicture> ReferenceThread::picture() const {
    const std::scoped_lock lock(mutex_);
    return newest_;
}

std::string ReferenceThread::error() const {
    const std::scoped_lock lock(mutex_);
    return error_;
}

Status ReferenceThread::publish(Copy& copy) {
    if (copy.submission == nullptr) {
        SUNFLECK_ASSIGN(copy.submission, gpu::Submission::create(device_, 1));
    }
    SUNFLECK_ASSIGN(std::shared_ptr<ScenePicture> picture, upload_picture(device_, *copy.submission, copy.display()));
    picture->camera = copy.view.camera;
    picture->ev100 = *copy.view.ev100;
    picture->number = copy.sums.samples;
    samples_ = copy.sums.samples;
    copy.shown = TraceClock::now();
    {
        const std::scoped_lock lock(mutex_);
        if (news_) // it shows what is no more
            return {};
        newest_ = std::move(picture);
    }
    wake_();
    return {};
}

// Until something is new; pictures come when the samples have doubled, or a second has passed.
Status ReferenceThread::trace(Copy& copy) {
    if (copy.tracer == nullptr || copy.view.width == 0 || !copy.view.ev100 || copy.view.playing)
        return {}; // it has the scene as edited, without what play has moved
    ReferenceSettings settings;
    settings.width = copy.view.width;
    settings.height = copy.view.height;
    settings.bounces = copy.settings.bounces;
    settings.seed = copy.settings.seed;
    std::uint32_t shown = 0;
    while (copy.sums.samples < most_samples && !has_news()) {
        if (busy_()) {
            std::this_thread::sleep_for(rest_time);
            continue;
        }
        const std::uint32_t batch =
            std::min({std::max(1u, copy.sums.samples), largest_batch, most_samples - copy.sums.samples});
        const bool whole = copy.tracer->accumulate(copy.sums, copy.view.camera, settings, batch,
                                                   [this] { return has_news() || busy_(); });
        const bool late = std::chrono::duration<double>(TraceClock::now() - copy.shown).count() > picture_interval;
        if (whole && (copy.sums.samples >= 2 * shown || late)) {
            SUNFLECK_TRY(publish(copy));
            shown = copy.sums.samples;
        }
    }
    return {};
}

void ReferenceThread::run() {
    auto copy = std::make_unique<Copy>();
    for (;;) {
        SceneChange change;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return has_news(); });
            if (ends_)
                return;
            news_ = false;
            change = std::exchange(next_, {});
            if (change.everything)
                copy = std::make_unique<Copy>();
            copy->view = next_view_;
            newest_.reset();
            error_.clear();
        }
        copy->sums = {};
        samples_ = 0;
        const Status status = caught([&]() -> Status {
            if (change.source != nullptr)
                SUNFLECK_TRY(copy->apply(change));
            return trace(*copy);
        });
        if (!status) {
            const std::scoped_lock lock(mutex_);
            error_ = status.error().message;
        }
    }
}

} // namespace sunfleck::editor
