#include "engine/app/gui.h"

#include "engine/gpu/rendering.h"

#include <cstring>
#include <filesystem>

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_app_shaders();
}

namespace sunfleck::app {
namespace {

constexpr float font_size = 16.0f;  // pixels at scale 1
constexpr float atlas_scale = 2.0f; // the font atlas is rasterised at this scale, for high-DPI screens
constexpr const char* font_file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

struct Constants {
    vec2 scale, white;
    glm::uvec2 atlas;
    std::uint32_t first_index, first_vertex;
};

} // namespace

std::span<const gpu::EmbeddedShader> shaders() {
    return gpu::sunfleck_app_shaders();
}

Result<std::unique_ptr<Gui>> Gui::create(gpu::Device& device, gpu::PipelineStore& pipelines, VkFormat target_format) {
    std::unique_ptr<Gui> gui(new Gui());
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr; // the program keeps its own settings
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard | ImGuiConfigFlags_NavEnableGamepad;
    const std::pair<ImGuiKey, Key> keys[] = {{ImGuiKey_Tab, key_tab},
                                             {ImGuiKey_LeftArrow, key_left},
                                             {ImGuiKey_RightArrow, key_right},
                                             {ImGuiKey_UpArrow, key_up},
                                             {ImGuiKey_DownArrow, key_down},
                                             {ImGuiKey_Space, key_space},
                                             {ImGuiKey_Enter, key_enter},
                                             {ImGuiKey_Escape, key_escape},
                                             {ImGuiKey_Backspace, 259},
                                             {ImGuiKey_Delete, 261},
                                             {ImGuiKey_Home, 268},
                                             {ImGuiKey_End, 269},
                                             {ImGuiKey_PageUp, 266},
                                             {ImGuiKey_PageDown, 267},
                                             {ImGuiKey_Insert, 260},
                                             {ImGuiKey_KeyPadEnter, 335},
                                             {ImGuiKey_A, 'A'},
                                             {ImGuiKey_C, 'C'},
                                             {ImGuiKey_V, 'V'},
                                             {ImGuiKey_X, 'X'},
                                             {ImGuiKey_Y, 'Y'},
                                             {ImGuiKey_Z, 'Z'}};
    for (const auto& [meaning, key] : keys)
        io.KeyMap[meaning] = key;
    add_font();
    SUNFLECK_TRY(gui->use_device(device, pipelines, target_format));
    return gui;
}

void Gui::forget_device() {
    pipeline_ = nullptr;
    atlas_ = {};
}

Status Gui::use_device(gpu::Device& device, gpu::PipelineStore& pipelines, VkFormat target_format) {
    SUNFLECK_TRY(make_atlas(device));
    gpu::GraphicsDescription description;
    description.vertex_shader = "engine/app/gui.vert";
    description.fragment_shader = "engine/app/gui.frag";
    description.colour_formats = {target_format};
    description.blend = true;
    SUNFLECK_ASSIGN(pipeline_, pipelines.graphics(description));
    return {};
}

void Gui::add_font() {
    ImGuiIO& io = ImGui::GetIO();
    std::error_code code;
    const float pixels = font_size * atlas_scale;
    if (!std::filesystem::exists(font_file, code) || io.Fonts->AddFontFromFileTTF(font_file, pixels) == nullptr) {
        ImFontConfig config;
        config.SizePixels = pixels;
        io.Fonts->AddFontDefault(&config);
    }
}

Status Gui::make_atlas(gpu::Device& device) {
    ImGuiIO& io = ImGui::GetIO();
    unsigned char* coverage = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsAlpha8(&coverage, &width, &height);
    const std::size_t bytes = (std::size_t(width) * std::size_t(height) + 3) / 4 * 4;
    SUNFLECK_ASSIGN(atlas_, gpu::Buffer::create(device, {"font atlas", bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                         gpu::MemoryUse::upload, VK_FORMAT_UNDEFINED}));
    std::memcpy(atlas_.mapped(), coverage, std::size_t(width) * std::size_t(height));
    atlas_width_ = std::uint32_t(width);
    atlas_height_ = std::uint32_t(height);
    return {};
}

Gui::~Gui() {
    ImGui::DestroyContext();
}

void Gui::make_style(float scale) {
    if (scale == scale_)
        return;
    scale_ = scale;
    ImGuiStyle& style = ImGui::GetStyle();
    style = ImGuiStyle();
    ImGui::StyleColorsDark();
    style.WindowRounding = style.FrameRounding = style.GrabRounding = 4.0f;
    style.WindowPadding = ImVec2(16.0f, 14.0f);
    style.FramePadding = ImVec2(10.0f, 6.0f);
    style.ItemSpacing = ImVec2(10.0f, 8.0f);
    style.WindowBorderSize = 0.0f;
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.06f, 0.055f, 0.05f, 0.86f);
    const ImVec4 amber(0.72f, 0.46f, 0.16f, 1.0f), bright(0.92f, 0.62f, 0.24f, 1.0f), dim(0.22f, 0.18f, 0.14f, 1.0f);
    style.Colors[ImGuiCol_Button] = style.Colors[ImGuiCol_FrameBg] = style.Colors[ImGuiCol_Tab] = dim;
    style.Colors[ImGuiCol_ButtonHovered] = style.Colors[ImGuiCol_HeaderHovered] = style.Colors[ImGuiCol_TabHovered] =
        amber;
    style.Colors[ImGuiCol_FrameBgHovered] = ImVec4(0.32f, 0.25f, 0.18f, 1.0f);
    style.Colors[ImGuiCol_ButtonActive] = style.Colors[ImGuiCol_SliderGrabActive] =
        style.Colors[ImGuiCol_HeaderActive] = bright;
    style.Colors[ImGuiCol_SliderGrab] = style.Colors[ImGuiCol_CheckMark] = style.Colors[ImGuiCol_PlotHistogram] =
        bright;
    style.Colors[ImGuiCol_Header] = style.Colors[ImGuiCol_TabActive] = amber;
    style.Colors[ImGuiCol_NavHighlight] = bright;
    if (change_style_)
        change_style_(style);
    style.ScaleAllSizes(scale);
    ImGui::GetIO().FontGlobalScale = scale / atlas_scale;
}

void Gui::set_style(std::function<void(ImGuiStyle&)> change) {
    change_style_ = std::move(change);
    scale_ = 0.0f; // made again at the next frame
}

void Gui::use_window(Window& window) {
    window_ = &window;
    take_escape();
    ImGuiIO& io = ImGui::GetIO();
    io.ClipboardUserData = this;
    io.SetClipboardTextFn = [](void* gui, const char* text) { static_cast<Gui*>(gui)->window_->set_clipboard(text); };
    io.GetClipboardTextFn = [](void* gui) {
        Gui& self = *static_cast<Gui*>(gui);
        self.pasted_ = self.window_->clipboard();
        return self.pasted_.c_str();
    };
}

void Gui::begin_frame(const InputState& input, std::uint32_t width, std::uint32_t height, double seconds, float scale) {
    make_style(scale);
    ImGuiIO& io = ImGui::GetIO();
    // A key that was pressed and released between two frames still counts as pressed.
    const auto seen = [&](Key key) { return input.down(key) || input.hit(key); };
    io.DisplaySize = ImVec2(float(width), float(height));
    io.DeltaTime = float(std::max(seconds, 1e-4));
    io.MousePos = input.captured || !input.focused ? ImVec2(-1e6f, -1e6f) : ImVec2(input.mouse.x, input.mouse.y);
    for (int i = 0; i < 3; ++i)
        io.MouseDown[i] = !input.captured && (input.mouse_buttons[std::size_t(i)] || input.hit(first_mouse_button + i));
    io.MouseWheel = input.captured ? 0.0f : input.scroll;
    for (const std::uint32_t letter : input.text)
        io.AddInputCharacter(letter);
    for (Key key = 0; key < first_mouse_button; ++key)
        // Where it is not the GUI's, the menu handles escape itself.
        io.KeysDown[key] = !input.captured && seen(key) && (key != key_escape || takes_escape_);
    io.KeyCtrl = input.down(key_left_control) || input.down(345);
    io.KeyShift = input.down(key_left_shift) || input.down(344);
    io.KeyAlt = input.down(342) || input.down(346);
    std::memset(io.NavInputs, 0, sizeof io.NavInputs);
    if (!input.captured) {
        io.NavInputs[ImGuiNavInput_Activate] = input.gamepad.pressed(0) || seen(key_enter);
        io.NavInputs[ImGuiNavInput_Cancel] = input.gamepad.pressed(1);
        io.NavInputs[ImGuiNavInput_DpadLeft] = input.gamepad.pressed(14);
        io.NavInputs[ImGuiNavInput_DpadRight] = input.gamepad.pressed(12);
        io.NavInputs[ImGuiNavInput_DpadUp] = input.gamepad.pressed(11);
        io.NavInputs[ImGuiNavInput_DpadDown] = input.gamepad.pressed(13);
    }
    ImGui::NewFrame();
}

void Gui::end_frame() {
    ImGui::Render();
    if (window_ == nullptr)
        return;
    window_->typing(ImGui::GetIO().WantTextInput);
    switch (ImGui::GetMouseCursor()) {
    case ImGuiMouseCursor_TextInput:
        return window_->set_pointer(Pointer::text);
    case ImGuiMouseCursor_Hand:
        return window_->set_pointer(Pointer::hand);
    case ImGuiMouseCursor_ResizeEW:
        return window_->set_pointer(Pointer::horizontal);
    case ImGuiMouseCursor_ResizeNS:
        return window_->set_pointer(Pointer::vertical);
    default:
        return window_->set_pointer(Pointer::arrow);
    }
}

struct Gui::Draw {
    VkRect2D scissor;
    std::uint32_t first_index, first_vertex, count;
};

// One frame's draws, as its pass needs them.
struct Gui::Frame {
    std::vector<Draw> draws;
    vec2 size{0.0f}, white{0.0f};
    gpu::UploadSlice vertices, indices;
};

// All of ImGui's draw lists, joined.
struct Gui::Geometry {
    std::vector<ImDrawVert> vertices;
    std::vector<std::uint32_t> indices;
    std::vector<Draw> draws;
};

Gui::Geometry Gui::collect(const ImDrawData& data) {
    static_assert(sizeof(ImDrawVert) == 20);
    Geometry result;
    for (int list = 0; list < data.CmdListsCount; ++list) {
        const ImDrawList& commands = *data.CmdLists[list];
        const auto first_vertex = std::uint32_t(result.vertices.size());
        const auto first_index = std::uint32_t(result.indices.size());
        result.vertices.insert(result.vertices.end(), commands.VtxBuffer.begin(), commands.VtxBuffer.end());
        result.indices.insert(result.indices.end(), commands.IdxBuffer.begin(), commands.IdxBuffer.end());
        for (const ImDrawCmd& command : commands.CmdBuffer) {
            const float left = std::max(command.ClipRect.x, 0.0f), top = std::max(command.ClipRect.y, 0.0f);
            const float right = std::min(command.ClipRect.z, data.DisplaySize.x);
            const float bottom = std::min(command.ClipRect.w, data.DisplaySize.y);
            if (right <= left || bottom <= top || command.UserCallback != nullptr)
                continue;
            result.draws.push_back({{{int(left), int(top)}, {std::uint32_t(right - left), std::uint32_t(bottom - top)}},
                                    first_index + command.IdxOffset,
                                    first_vertex + command.VtxOffset,
                                    command.ElemCount});
        }
    }
    return result;
}

Status Gui::add_pass(gpu::FrameGraph& graph, gpu::ResourceId target, gpu::FrameResources& resources) {
    const ImDrawData* data = ImGui::GetDrawData();
    if (data == nullptr || data->TotalIdxCount == 0)
        return {};
    const Geometry geometry = collect(*data);
    Frame frame;
    frame.draws = geometry.draws;
    frame.size = vec2(data->DisplaySize.x, data->DisplaySize.y);
    frame.white = vec2(ImGui::GetIO().Fonts->TexUvWhitePixel.x, ImGui::GetIO().Fonts->TexUvWhitePixel.y);
    SUNFLECK_ASSIGN(frame.vertices, resources.upload(std::span<const ImDrawVert>(geometry.vertices)));
    SUNFLECK_ASSIGN(frame.indices, resources.upload(std::span<const std::uint32_t>(geometry.indices)));
    graph.add_pass("gui")
        .write(target, gpu::Usage::colour_attachment)
        .execute([this, target, frame](gpu::PassContext& context) { return draw(context, target, frame); });
    return {};
}

Status Gui::draw(gpu::PassContext& context, gpu::ResourceId target, const Frame& frame) const {
    const auto colour =
        gpu::rendering_attachment(context.graph.view(target), VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, true);
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea.extent = {std::uint32_t(frame.size.x), std::uint32_t(frame.size.y)};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachments = &colour;
    const gpu::DeviceFunctions& vk = context.device.vk;
    vk.vkCmdBeginRendering(context.commands, &rendering);
    const VkViewport viewport{0, 0, frame.size.x, frame.size.y, 0, 1};
    vk.vkCmdSetViewport(context.commands, 0, 1, &viewport);
    const gpu::Binding bindings[] = {gpu::Binding::storage(frame.vertices), gpu::Binding::storage(frame.indices),
                                     gpu::Binding::storage(atlas_)};
    Status status = context.resources.bind(context.commands, *pipeline_, bindings);
    for (const Draw& draw : frame.draws) {
        vk.vkCmdSetScissor(context.commands, 0, 1, &draw.scissor);
        const Constants constants{2.0f / frame.size, frame.white, glm::uvec2(atlas_width_, atlas_height_),
                                  draw.first_index, draw.first_vertex};
        if (status)
            status = context.resources.push(context.commands, *pipeline_, constants);
        if (!status)
            break;
        vk.vkCmdDraw(context.commands, draw.count, 1, 0, 0);
    }
    vk.vkCmdEndRendering(context.commands);
    return status;
}

} // namespace sunfleck::app
