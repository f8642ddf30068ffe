// Frames as a Chrome trace (the "Trace Event Format"): what the CPU and the GPU did when.
#pragma once

#include "viewer/scene_renderer.h"

namespace sunfleck::viewer {

class Trace {
public:
    // The next frame, after those before. Frames do not overlap (SceneRenderer::render_and_wait).
    void add(const FrameStatistics& frame);
    Status write(const std::filesystem::path& path) const;

private:
    struct Frame {
        double begin_ms = 0.0;
        FrameStatistics statistics;
    };
    std::vector<Frame> frames_;
    double end_ms_ = 0.0;
};

} // namespace sunfleck::viewer
