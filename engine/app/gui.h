// Dear ImGui, fed with a window's input and drawn through the frame graph.
#pragma once

#include "engine/app/window.h"
#include "engine/gpu/pipeline.h"

#include <imgui.h>

namespace sunfleck::app {

// The shaders of this folder, to be added to the shader library before Gui::create.
std::span<const gpu::EmbeddedShader> shaders();

class Gui {
public:
    // One at a time in a process: ImGui's context is global. `target_format`: of the images that it draws on.
    static Result<std::unique_ptr<Gui>> create(gpu::Device& device, gpu::PipelineStore& pipelines,
                                               VkFormat target_format);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    // Begins a frame; ImGui's functions may be called from here to end_frame. `scale` enlarges letters and spaces.
    void begin_frame(const InputState& input, std::uint32_t width, std::uint32_t height, double seconds, float scale);
    void end_frame();
    // Draws the frame over `target`, which has the size given to begin_frame. After end_frame.
    Status add_pass(gpu::FrameGraph& graph, gpu::ResourceId target, gpu::FrameResources& resources);

    bool wants_mouse() const { return ImGui::GetIO().WantCaptureMouse; }

private:
    Gui() = default;
    void make_style(float scale);
    gpu::Buffer atlas_;
    std::uint32_t atlas_width_ = 0, atlas_height_ = 0;
    const gpu::Pipeline* pipeline_ = nullptr;
    float scale_ = 0.0f;
};

} // namespace sunfleck::app
