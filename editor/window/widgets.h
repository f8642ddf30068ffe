// The widgets of which panels are made: Dear ImGui's, with tooltips, and with a note of name, place and value of each
// visible one, so that scripts find them (--widgets FILE).
//
// Names are paths: "inspector/Material/roughness". Use between Gui::begin_frame and end_frame, on the GUI thread.
#pragma once

#include <cstdint>
#include <imgui.h>
#include <string>
#include <string_view>
#include <vector>

namespace sunfleck::editor::ui {

struct Note {
    std::string name, value;
    ImVec2 low, high; // pixels
};

// Forgets the notes of the last frame; `wanted`: whether any are made.
void begin_notes(bool wanted);
const std::vector<Note>& notes();
// Of the item that was submitted last.
void note(std::string_view name, std::string_view value = {});
void note_place(std::string_view name, std::string_view value, ImVec2 low, ImVec2 high);

// Names within it begin with "name/".
class Scope {
public:
    explicit Scope(std::string_view name);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

private:
    std::size_t length_;
};

// Height of a letter, pixels: the measure of all else.
inline float unit() {
    return ImGui::GetFontSize();
}

// Shown while the pointer rests on the last item. Wrapped.
void tooltip(std::string_view text);
bool button(const std::string& name, std::string_view tip = {}, bool enabled = true, float width = 0.0f);
bool toggle(const std::string& name, bool& on, std::string_view tip = {});
bool menu_item(const std::string& name, const std::string& shortcut, bool enabled, bool checked = false);
// Within a menu or popup: Escape closes it.
void close_by_escape();
// A row to be clicked, as wide as there is room.
bool choice(const std::string& name, bool chosen, std::string_view tip = {});
// True while the text changes; with `enter`, when Enter was pressed.
bool text_box(const std::string& name, std::string& text, const char* hint, float width, bool enter = false);
// What is seen of a text in so much room, pixels: what does not fit is cut, with dots.
std::string fitted(const std::string& text, float room);
// Cut so; the whole is in the tooltip.
void label(const std::string& text, std::string_view tip = {}, bool dim = false);
void heading(const std::string& text);
void hint(const char* text);                                  // dim, in as many lines as it needs
void text(const std::string& name, const std::string& value); // a line whose value scripts may read

// Text that is about to take the keys does so a frame or two after the click that asked for it: until then letters
// would be lost, so that no further input is taken.
void ask_for_quiet_frames();
// Whether the next frame is to be one without further input.
bool take_quiet_frame();

// --- Numbers: dragged, or clicked and typed --------------------------------------------------------------------------
struct NumberLook {
    double value = 0.0, minimum = 0.0, maximum = 0.0; // in the unit that is shown
    double speed = 0.0;                               // of a drag, per pixel; 0: by the range, or the value
    bool whole = false, mixed = false, enabled = true;
    std::string unit;
    const char* instead = "mixed"; // of a number, where it is mixed
    float width = 0.0f;
};
struct NumberEdit {
    enum class Phase { none, began, dragged, ended, cancelled, typed } phase = Phase::none;
    double value = 0.0; // of `dragged`
    std::string text;   // of `typed`
};
NumberEdit number_box(const std::string& name, const NumberLook& look);
// What is being typed or dragged is given up, without an edit.
void leave_boxes();
// Which text box of a document's value is being typed into, and what; 0: none is.
struct TextEdit {
    ImGuiID box = 0;
    std::string text;
};
TextEdit& text_edit();
// At the start of a frame: boxes that are not drawn any more are left.
void begin_number_boxes();
// A number is being typed or dragged.
bool editing_number();
std::string number_text(double value, bool whole);

} // namespace sunfleck::editor::ui
