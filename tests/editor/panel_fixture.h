// The editor's session and its panels in the test's own process, without window and program: what the pointer and the
// keys do to widgets, by their names, a frame at a time. Nothing is drawn.
#pragma once

#include "editor/document/edits.h"
#include "editor/window/commands.h"
#include "editor/window/comparison.h"
#include "editor/window/cost_thread.h"
#include "editor/window/layout.h"
#include "editor/window/opening.h"
#include "editor/window/style.h"
#include "engine/app/gui.h"
#include "tests/support/folder.h"
#include "tests/support/gpu_device.h"

#include <cctype>

namespace sunfleck::editor {

class PanelTest : public tests::GpuTest {
protected:
    PanelTest() {
        shaders_.add(app::shaders());
        auto made = app::Gui::create(tests::device(), pipelines_, VK_FORMAT_R8G8B8A8_UNORM);
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        gui_ = std::move(*made);
        gui_->take_escape();
        gui_->set_style(set_style);
        ImGui::GetIO().ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
        session_.wake = [] {};
        session_.comparison = std::make_unique<Comparison>(tests::device(), scene_, [] {});
    }
    Document& document() { return *session_.document; }
    Entity add(std::string_view name) {
        for (const scene::EntityTemplate& source : scene::entity_templates())
            if (source.name == name)
                return add_from(document(), source, vec3(0.0f), 1.0f);
        ADD_FAILURE() << "no template " << name;
        return {};
    }
    void run(std::string_view command) {
        Command* const found = session_.commands->find(command);
        ASSERT_NE(found, nullptr) << command;
        ASSERT_TRUE(found->is_enabled(session_)) << command;
        session_.commands->run(*found, session_);
    }
    std::string newest_message() const {
        return session_.messages.all().empty() ? std::string() : session_.messages.all().back().text;
    }

    // A frame with what has happened since the last one, and those that a box needs before it takes letters.
    void frame() {
        draw();
        input_ = input_.still();
        while (ui::take_quiet_frame())
            draw();
    }
    void frames(int count) {
        for (int i = 0; i < count; ++i)
            frame();
    }
    // As it was drawn last.
    const ui::Note* find(std::string_view name) const {
        const auto found =
            std::find_if(ui::notes().begin(), ui::notes().end(), [&](const ui::Note& one) { return one.name == name; });
        return found == ui::notes().end() ? nullptr : &*found;
    }
    std::string value(std::string_view name) const {
        const ui::Note* const found = find(name);
        return found != nullptr ? found->value : "(not there)";
    }
    void point_at(std::string_view name) {
        frames(2); // what has just opened has its place in the next one
        const ui::Note* const found = find(name);
        ASSERT_NE(found, nullptr) << name;
        input_.mouse = 0.5f * vec2(found->low.x + found->high.x, found->low.y + found->high.y);
        frame();
    }
    void move(vec2 by) {
        input_.mouse += by;
        frame();
    }
    void press() {
        input_.mouse_buttons[0] = true;
        input_.went_down.push_back(app::first_mouse_button);
        frame();
    }
    void let_go() {
        input_.mouse_buttons[0] = false;
        frame();
    }
    void click(std::string_view name) {
        ASSERT_NO_FATAL_FAILURE(point_at(name));
        press();
        let_go();
        frame();
    }
    // "Ctrl+S" as shortcut_text writes it.
    void key(const std::string& keys) {
        const Shortcut shortcut = shortcut_from_text(keys);
        ASSERT_NE(shortcut.key, app::no_key) << keys;
        const auto hold = [&](bool on) {
            input_.keys[app::key_left_control] = on && shortcut.control;
            input_.keys[app::key_left_shift] = on && shortcut.shift;
            input_.keys[app::key_left_alt] = on && shortcut.alt;
            input_.keys[std::size_t(shortcut.key)] = on;
        };
        hold(true);
        input_.went_down.push_back(shortcut.key);
        frame();
        hold(false);
        frame();
    }
    void type(std::string_view text) {
        for (const char letter : text) {
            input_.text.push_back(std::uint32_t(static_cast<unsigned char>(letter)));
            frame();
        }
    }
    // A number or text into a box.
    void enter(std::string_view name, std::string_view text) {
        ASSERT_NO_FATAL_FAILURE(click(name));
        type(text);
        ASSERT_NO_FATAL_FAILURE(key("Enter"));
    }

    const tests::Folder folder_{"editor_panels"};
    SceneThread scene_{tests::device(), [] {}};
    Session session_{scene_};
    app::InputState input_;

private:
    void draw() {
        session_.input = &input_;
        ui::begin_notes(true);
        ui::begin_number_boxes();
        gui_->begin_frame(input_, 1440, 900, 1.0 / 60.0, 1.0f);
        session_.follow_focus(input_);
        layout_.take_keys(session_);
        layout_.draw(session_, nullptr);
        gui_->end_frame();
    }

    gpu::ShaderLibrary shaders_;
    gpu::PipelineStore pipelines_{tests::device(), shaders_};
    std::unique_ptr<app::Gui> gui_;
    Layout layout_;
};

} // namespace sunfleck::editor
