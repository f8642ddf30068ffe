// Dear ImGui with a window's input, drawn through the frame graph.
#pragma once

#include "engine/app/window.h"
#include "engine/gpu/pipeline.h"

#include <functional>
#include <imgui.h>

namespace sunfleck::app {

// The shaders of this folder, to be added to the shader library before Gui::create.
std::span<const gpu::EmbeddedShader> shaders();

class Gui {
public:
    // At most one per process: ImGui's context is global. `target_format`: of the images that it draws on.
    static Result<std::unique_ptr<Gui>> create(gpu::Device& device, gpu::PipelineStore& pipelines,
                                               VkFormat target_format);
    ~Gui();
    // Another device, in place of one that is lost: windows, focus and what is being typed stay. What lay on the device
    // before is let go of at once.
    void forget_device();
    Status use_device(gpu::Device& device, gpu::PipelineStore& pipelines, VkFormat target_format);
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    // Begins a frame; ImGui's functions may be called until end_frame. `scale`: of text and spacing.
    void begin_frame(const InputState& input, std::uint32_t width, std::uint32_t height, double seconds, float scale);
    void end_frame();
    // Draws the frame over `target`, which has the size given to begin_frame. Call after end_frame.
    Status add_pass(gpu::FrameGraph& graph, gpu::ResourceId target, gpu::FrameResources& resources);

    // Clipboard and pointer shapes of this window, which must outlive the GUI; and Escape goes to the GUI.
    void use_window(Window& window);
    // Escape goes to the GUI, and not to the program alone.
    void take_escape() { takes_escape_ = true; }
    // Changes the style at scale 1, for programs other than games.
    void set_style(std::function<void(ImGuiStyle&)> change);

    bool wants_mouse() const { return ImGui::GetIO().WantCaptureMouse; }

private:
    Gui() = default;
    struct Draw;
    struct Geometry;
    struct Frame;
    static void add_font();
    Status make_atlas(gpu::Device& device);
    void make_style(float scale);
    static Geometry collect(const ImDrawData& data);
    Status draw(gpu::PassContext& context, gpu::ResourceId target, const Frame& frame) const;
    gpu::Buffer atlas_;
    std::uint32_t atlas_width_ = 0, atlas_height_ = 0;
    const gpu::Pipeline* pipeline_ = nullptr;
    float scale_ = 0.0f;
    bool takes_escape_ = false;
    Window* window_ = nullptr;
    std::string pasted_; // what ImGui reads from the clipboard
    std::function<void(ImGuiStyle&)> change_style_;
};

} // namespace sunfleck::app
