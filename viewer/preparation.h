// The lighting work that would delay a renderer's first frame, done beforehand and in portions.
#pragma once

#include "viewer/option_values.h"
#include "viewer/scene_renderer.h"

namespace sunfleck::viewer {

struct PreparationOptions {
    // GPU time of a portion of shadow maps, ms: as long may whoever shares the device's queue have to wait.
    double portion = 100.0;
    // Receives the share that is done, 0 to 1, and returns false to stop with an error. From any thread, never
    // concurrently.
    std::function<bool(float)> progress;
};

// Size of a picture of which nothing but light is kept. Some drivers compile a version of a kernel for each kind of
// size of the images that it reads, while all wait who share the queue: llvmpipe tells apart which of width and height
// are powers of two. So the small picture's are where the shown one's are.
PictureSize small_picture(PictureSize shown);

// Makes light samples and visibility, then draws all shadow maps, sums light maps and bakes light. `request`: of the
// frames that follow, but at any size, since nothing of it is kept but maps and light: small pictures take less time
// (small_picture). Waits for the GPU.
Status prepare_lighting(SceneRenderer& renderer, FrameRequest request, const PreparationOptions& options);

// Whether the light of what stands still is refined further in the frames that follow
// (gi::FrameInput::refinement_budget).
bool light_is_being_refined(SceneRenderer& renderer);

} // namespace sunfleck::viewer
