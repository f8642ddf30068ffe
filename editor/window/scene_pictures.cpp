// How the scene thread draws: exposure, the frame, and the picture that is handed to the GUI.
#include "editor/window/scene_thread.h"

#include "editor/window/camera.h"
#include "viewer/exposure.h"
#include "viewer/preparation.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::editor {
namespace {

constexpr std::size_t most_pictures = 8, most_notes = 20'000;
// Of a usual frame: light for which one took longer is made behind the frames from then on.
constexpr double longest_share = 1.5;

bool has_light(const io::Picture& radiance) {
    return std::any_of(radiance.pixels.begin(), radiance.pixels.end(), [](const vec4& pixel) {
        const float light = luminance(vec3(pixel));
        return light > 0.0f && std::isfinite(light);
    });
}

constexpr std::uint32_t refinement = 4000; // in a frame: some twenty milliseconds

} // namespace

viewer::FrameRequest SceneThread::frame_request() {
    viewer::FrameRequest request;
    request.camera = view_.camera;
    request.width = view_.width;
    request.height = view_.height;
    request.view = view_.view;
    request.lighting_view = view_.lighting_view;
    request.overlays = view_.overlays;
    request.overlay_sample = view_.chosen_sample;
    request.antialiasing = view_.look.antialiasing;
    request.glare = view_.look.glare;
    request.refinement_budget = hand_rests() ? refinement : 0;
    request.keep_samples = light_is_slow_;
    request.keep_geometry = hand_moves();
    request.simulate = play_ == nullptr;
    request.progress = [this](float share) { return go_on(share); };
    return request;
}

// A picture of the right size that nobody holds.
Result<std::shared_ptr<ScenePicture>> SceneThread::free_picture() {
    const auto fits = [&](const ScenePicture& picture) {
        const gpu::ImageDescription& has = picture.image.description();
        return has.width == view_.width && has.height == view_.height;
    };
    std::erase_if(pictures_, [&](const auto& picture) { return picture.use_count() == 1 && !fits(*picture); });
    // The GUI lets go of pictures at any time: one of the old size may have become free just now.
    for (const auto& picture : pictures_)
        if (picture.use_count() == 1 && fits(*picture))
            return picture;
    auto picture = std::make_shared<ScenePicture>();
    gpu::ImageDescription description;
    description.name = "viewport";
    description.format = VK_FORMAT_R8G8B8A8_UNORM;
    description.width = view_.width;
    description.height = view_.height;
    // Images have views, which some use other than copies has to allow.
    description.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    SUNFLECK_ASSIGN(picture->image, gpu::Image::create(*device_, description));
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
    SUNFLECK_ASSIGN(const VkCommandBuffer commands, renderer.submission().begin());
    const std::uint64_t serial = renderer.submission().serial();
    SUNFLECK_TRY(renderer.record(commands, request, copy));
    SUNFLECK_TRY(renderer.submission().submit());
    SUNFLECK_TRY(renderer.submission().wait(serial));
    return renderer.collect_statistics();
}

// A scene that says no exposure is exposed by its first picture that has light, and then left alone until somebody asks
// for it: an artist who turns a lamp up wants to see it.
Status SceneThread::expose(viewer::FrameRequest& request) {
    if (std::exchange(exposures_, view_.exposures) != view_.exposures)
        exposure_is_old_ = true;
    const std::optional<float> given = view_.ev100 ? view_.ev100 : viewer::scene_exposure(copy_->renderer().registry());
    if (!given && exposure_is_old_) {
        viewer::FrameRequest linear = request;
        linear.tone_map = false;
        linear.view = shared::view_final;
        linear.lighting_view.clear();
        SUNFLECK_TRY(draw(linear, nullptr));
        SUNFLECK_ASSIGN(const io::Picture radiance, copy_->renderer().read_back());
        automatic_ev100_ = viewer::automatic_exposure(radiance);
        // Of the light as it is when it has settled, and not of darkness.
        exposure_is_old_ = frames_left_ > 1 || !has_light(radiance);
    }
    request.ev100 = given.value_or(automatic_ev100_);
    return {};
}

// The light that the picture has at the place, and what that is made of.
Status SceneThread::look_into_pixel() {
    viewer::SceneRenderer& renderer = copy_->renderer();
    viewer::FrameRequest linear = frame_request();
    linear.camera = inspection_->camera;
    linear.width = inspection_->width;
    linear.height = inspection_->height;
    linear.tone_map = false;
    linear.view = shared::view_irradiance;
    linear.lighting_view.clear();
    SUNFLECK_TRY(draw(linear, nullptr));
    SUNFLECK_ASSIGN(const io::Picture light, renderer.read_back());
    const auto place = [](float share, std::uint32_t size) {
        return std::min(std::uint32_t(std::max(share, 0.0f) * float(size)), size - 1);
    };
    const std::uint32_t x = place(inspection_->x, linear.width), y = place(inspection_->y, linear.height);
    auto answer = std::make_shared<InspectedPixel>();
    answer->shown = vec3(light.pixels[std::size_t(y) * linear.width + x]);
    const vec2 size(float(linear.width), float(linear.height));
    const vec2 middle(float(x) + 0.5f, float(y) + 0.5f); // of the pixel, as its light is
    answer->report = viewer::report_pixel(renderer, linear.camera.position, ray_through(linear.camera, size, middle));
    answer->serial = inspection_->serial;
    answer->revision = revision_;
    {
        const std::scoped_lock lock(mutex_);
        inspected_ = std::move(answer);
    }
    wake_();
    return {};
}

// Where something has changed since the last answer, and the picture has settled.
void SceneThread::follow_inspection() {
    if (!inspection_ || failed_ || frames_left_ > 0 || moves() || light_comes())
        return;
    const std::array<std::uint64_t, 5> now{inspection_->serial, revision_, hiding_, steps(), status().builds};
    if (now == inspected_state_)
        return;
    inspected_state_ = now;
    if (const Status looked = look_into_pixel(); !looked && !stop_ && !cancelled_)
        fail(looked.error());
}

Status SceneThread::draw_picture() {
    viewer::FrameRequest request = frame_request();
    const auto began = Clock::now();
    const bool was_behind = copy_->renderer().geometry_outdated();
    SUNFLECK_TRY(expose(request));
    SUNFLECK_ASSIGN(std::shared_ptr<ScenePicture> picture, free_picture());
    SUNFLECK_TRY(draw(request, picture.get()));
    picture->camera = view_.camera;
    picture->revision = revision_;
    picture->hiding = hiding_;
    picture->number = ++number_;
    picture->step = steps();
    picture->played = play_ != nullptr ? std::make_shared<PlayedPlaces>(copy_->renderer().registry()) : nullptr;
    if (was_behind && !copy_->renderer().geometry_outdated()) // shadows begin to follow
        frames_left_ = std::max(frames_left_, frames_after_edit);
    refining_ = viewer::light_is_being_refined(copy_->renderer());
    fill_listing();
    note_light();
    picture->settled = frames_left_ <= 1 && !moves() && !light_comes();
    picture->ev100 = request.ev100;
    picture->frame_ms = 1e3 * seconds_since(began);
    const bool first = longest_frame_ms_ == 0.0;
    longest_frame_ms_ = std::max(longest_frame_ms_, picture->frame_ms);
    if (picture->settled) // such frames make no light
        light_is_slow_ = light_is_slow_ || longest_frame_ms_ > longest_share * picture->frame_ms;
    picture->statistics = copy_->renderer().statistics();
    picture->pixels.reset();
    if (view_.read_back && picture->settled) {
        SUNFLECK_ASSIGN(io::Picture pixels, copy_->renderer().read_back());
        picture->pixels = std::make_shared<io::Picture>(std::move(pixels));
    }
    if (first) { // kernels that the first mover needs are compiled now, not when it moves
        request.as_if_stale = true;
        request.refinement_budget = 0;
        SUNFLECK_TRY(draw(request, nullptr));
    }
    publish(std::move(picture));
    return {};
}

void SceneThread::publish(std::shared_ptr<ScenePicture> picture) {
    last_frame_ = Clock::now();
    {
        const std::scoped_lock lock(mutex_);
        if (frame_notes_.size() < most_notes)
            frame_notes_.push_back({seconds_now(), picture->frame_ms});
        status_.longest_frame_ms = std::max(status_.longest_frame_ms, picture->frame_ms);
        newest_ = std::move(picture);
        status_.error.clear();
        ++status_.frames;
    }
    wake_();
}

} // namespace sunfleck::editor
