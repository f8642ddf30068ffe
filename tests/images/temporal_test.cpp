// Anti-aliasing and enlargement from frame to frame, against pictures with sixteen samples a pixel.
#include "editor/command_line/picture_measures.h"
#include "tests/support/gpu_world.h"

namespace sunfleck::tests {
namespace {

using command_line::box_filtered;
using command_line::edge_error;

class TemporalPicture : public GpuTest {};

constexpr std::uint32_t shown_width = 320, shown_height = 180;

struct TemporalScene : GpuWorld {
    TemporalScene() : GpuWorld(assets::make_four_pillars, "view") {
        gi::Settings settings;
        settings.lights = 24;
        settings.shadow_map_resolution = 64;
        settings.low_resolution = 1;
        set(settings);
        request.view = shared::view_final;
        request.tone_map = request.antialiasing = true;
        request.screen_width = shown_width;
        request.screen_height = shown_height;
        request.width = shown_width / 2;
        request.height = shown_height / 2;
    }
};

// Sixteen samples in each pixel that is shown.
io::Picture truth_of(const scene::CameraView& camera) {
    TemporalScene world;
    world.request.antialiasing = false;
    world.request.camera = camera;
    world.request.width = world.request.screen_width = 4 * shown_width;
    world.request.height = world.request.screen_height = 4 * shown_height;
    return box_filtered(world.picture(), 4);
}

// The view that turns, so many frames before it arrives at `camera`.
scene::CameraView before_arrival(const scene::CameraView& camera, int frames) {
    scene::CameraView view = camera;
    const quat turn = glm::angleAxis(0.02f * float(frames), vec3(0.0f, 1.0f, 0.0f));
    view.target = view.position + turn * (view.target - view.position);
    return view;
}

// The picture after it has turned for some frames and stood still for others.
io::Picture picture_of(TemporalScene& world, int turning, int standing) {
    const scene::CameraView camera = world.request.camera;
    for (int left = turning; left > 0; --left) {
        world.request.camera = before_arrival(camera, left);
        world.render();
    }
    world.request.camera = camera;
    for (int frame = 0; frame < standing; ++frame)
        world.render();
    return world.picture();
}

// Within a round of the sequence, of which one frame is none of it since the camera arrives in it. What each frame
// shows by itself has four samples a pixel at the edges of surfaces, and textures of the screen's size
// (subpixel_edges.h); a plain enlargement has neither, and is what the last frame is compared with.
TEST_F(TemporalPicture, StandingStillComesNearToASupersampledPicture) {
    TemporalScene by_itself, enlarged;
    enlarged.request.antialiasing = false;
    const io::Picture single = picture_of(by_itself, 4, 0), truth = truth_of(by_itself.request.camera);
    double last = edge_error(single, truth);
    const double plain = edge_error(picture_of(enlarged, 4, 0), truth);
    std::printf("plain %.4f, each frame by itself %.4f", plain, last);
    for (const int frames : {4, 8, 16, 40}) {
        TemporalScene world;
        world.request.temporal = true;
        const double error = edge_error(picture_of(world, 4, frames), truth);
        std::printf(", %d frames %.4f", frames, error);
        EXPECT_LT(error, 1.02 * last) << frames << " frames";
        last = error;
    }
    std::printf("\n");
    EXPECT_LT(last, 0.17 * plain); // 0.163: sixteen samples a pixel, as the truth has, but not the same ones
}

// A camera that moves sees each frame by itself, to the bit.
TEST_F(TemporalPicture, MovingLeavesNothingOfTheFramesBefore) {
    TemporalScene temporal, by_itself;
    temporal.request.temporal = true;
    for (TemporalScene* world : {&temporal, &by_itself})
        for (int frame = 0; frame < 5; ++frame)
            world->render();
    EXPECT_EQ(picture_of(temporal, 2, 0).pixels, picture_of(by_itself, 2, 0).pixels);
}

// What stands still comes to rest as the same picture whatever was seen before, and nothing moves in it.
TEST_F(TemporalPicture, ComesToRest) {
    TemporalScene world;
    world.request.temporal = true;
    const io::Picture first = picture_of(world, 0, 40);
    EXPECT_EQ(world.picture().pixels, first.pixels);
    EXPECT_EQ(picture_of(world, 7, 25).pixels, first.pixels);
    // Another exposure is shown at once, and the same one comes to rest as before.
    const float ev100 = world.request.ev100;
    world.request.ev100 += 1.0f;
    EXPECT_NE(world.picture().pixels, first.pixels);
    world.request.ev100 = ev100;
    EXPECT_EQ(picture_of(world, 0, 40).pixels, first.pixels);
}

// A mover leaves no trail: a frame after it stopped, the picture is far nearer to one that never saw it, and is at
// rest, than one that is only enlarged, and about as near as a frame by itself. Light that is switched shows as in a
// frame by itself.
TEST_F(TemporalPicture, WhatChangesLeavesNoTrail) {
    constexpr std::uint64_t steps = 30;
    TemporalScene temporal, by_itself, enlarged, fresh;
    temporal.request.temporal = fresh.request.temporal = true;
    enlarged.request.antialiasing = false;
    for (TemporalScene* world : {&temporal, &by_itself, &enlarged}) {
        static_cast<void>(picture_of(*world, 0, 20));
        for (std::uint64_t step = 1; step <= steps; ++step) {
            world->request.step = step;
            world->render();
        }
    }
    fresh.request.step = steps;
    const io::Picture rest = picture_of(fresh, 0, 40);
    const auto difference = [&](const io::Picture& picture) {
        double sum = 0.0;
        for (std::size_t i = 0; i < picture.pixels.size(); ++i)
            sum += double(glm::length(vec3(picture.pixels[i]) - vec3(rest.pixels[i])));
        return sum / double(picture.pixels.size());
    };
    const double now = difference(temporal.picture()), single = difference(by_itself.picture()),
                 plain = difference(enlarged.picture());
    std::printf("%.5f, a frame by itself %.5f, plainly enlarged %.5f\n", now, single, plain);
    EXPECT_LT(now, 0.52 * plain); // 0.49
    temporal.request.indirect_scale = by_itself.request.indirect_scale = 0.0f;
    EXPECT_EQ(temporal.picture().pixels, by_itself.picture().pixels);
}

} // namespace
} // namespace sunfleck::tests
