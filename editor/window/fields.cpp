#include "editor/window/fields.h"

#include "editor/window/colour_box.h"
#include "editor/window/field_parts.h"
#include "editor/window/widgets.h"

#include <algorithm>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

namespace sunfleck::editor {
namespace {

using Phase = ui::NumberEdit::Phase;
constexpr float room_for_name = 6.5f;     // of ui::unit()
constexpr double degrees_per_pixel = 0.5; // of rotations that are dragged
constexpr ImU32 changed_colour = IM_COL32(240, 178, 80, 255);

bool same_in_all(const FieldSource& source) {
    return std::all_of(source.objects.begin() + 1, source.objects.end(),
                       [&](const void* object) { return same_field(*source.field, object, source.objects[0]); });
}

bool same_part(const FieldSource& source, int part) {
    const double first = read_part(*source.field, source.objects[0], part);
    return std::all_of(source.objects.begin() + 1, source.objects.end(),
                       [&](const void* object) { return read_part(*source.field, object, part) == first; });
}

// All objects, within the gesture that is open.
Status set_all(const FieldSource& source, const std::function<std::string(std::size_t)>& text) {
    // Setting may move the objects: all texts come first.
    std::vector<std::string> texts;
    texts.reserve(source.objects.size());
    for (std::size_t i = 0; i < source.objects.size(); ++i)
        texts.push_back(text(i));
    for (std::size_t i = 0; i < texts.size(); ++i)
        SUNFLECK_TRY(source.set(i, texts[i]));
    return {};
}

void edit_number(Session& session, const FieldSource& source, int part, const ui::NumberEdit& edit) {
    Document& document = *session.document;
    // Values before the drag, of objects outside the document, whose gestures do not take them back. There is one
    // pointer.
    static std::vector<std::string> before;
    static PartDrag drag;
    const auto put_back = [&] {
        for (std::size_t i = 0; i < before.size() && i < source.objects.size(); ++i)
            static_cast<void>(source.set(i, before[i]));
        before.clear();
    };
    switch (edit.phase) {
    case Phase::began:
        before.clear();
        drag = PartDrag(*source.field, source.objects, part);
        if (!source.in_document)
            for (const void* object : source.objects)
                before.push_back(field_to_text(*source.field, object));
        return document.begin(source.gesture);
    case Phase::dragged:
        // A value that the field does not take (a multiple is needed, say) leaves the one before.
        if (document.in_gesture())
            static_cast<void>(set_all(
                source, [&](std::size_t i) { return drag.text(*source.field, source.objects[i], i, edit.value); }));
        return;
    case Phase::ended:
        if (!document.in_gesture()) // given up already: loss of focus
            put_back();
        document.commit();
        return;
    case Phase::cancelled:
        put_back();
        return document.cancel();
    case Phase::typed: {
        const std::optional<double> value = typed_number(edit.text);
        // What the box shows of a rotation are angles, whatever it is stored as.
        if (source.field->kind == FieldKind::quaternion && !value && edit.text.find(',') == std::string::npos) {
            session.messages.say("'" + edit.text + "' is not an angle in degrees", Message::Kind::error);
            return;
        }
        return apply_field_text(session, source, [&](const void* object) {
            return value ? text_with_part(*source.field, object, part, *value)
                         : text_with_part(*source.field, object, part, edit.text);
        });
    }
    case Phase::none:
        return;
    }
}

void number_cells(Session& session, const FieldSource& source, int parts, float width) {
    const Field& field = *source.field;
    const float gap = 0.25f * ui::unit();
    static const char* names[] = {"x", "y", "z"};
    const bool same = same_in_all(source);
    for (int part = 0; part < parts; ++part) {
        ui::NumberLook look;
        look.value = read_part(field, source.objects[0], part);
        const bool ranged = field.kind != FieldKind::quaternion && field.maximum < unbounded;
        look.minimum = ranged ? field.minimum * shown_factor(field) : 0.0;
        look.maximum = ranged ? field.maximum * shown_factor(field) : 0.0;
        look.speed = field.kind == FieldKind::quaternion ? degrees_per_pixel : 0.0;
        look.whole = field.kind == FieldKind::integer || field.kind == FieldKind::unsigned_integer;
        look.mixed = !same && !same_part(source, part);
        look.unit = shown_unit(field);
        look.width = (width - gap * float(parts - 1)) / float(parts);
        if (part > 0)
            ImGui::SameLine(0.0f, gap);
        edit_number(session, source, part, ui::number_box(parts == 1 ? "value" : names[part], look));
    }
}

void choice_cell(Session& session, const FieldSource& source, float width) {
    const Field& field = *source.field;
    const bool mixed = !same_in_all(source);
    const std::string now = field_to_text(field, source.objects[0]);
    ImGui::SetNextItemWidth(width);
    const bool is_open = ImGui::BeginCombo("##value", mixed ? "mixed" : readable_name(now).c_str());
    ui::note("value", mixed ? "mixed" : now);
    if (!is_open)
        return;
    ui::close_by_escape();
    for (const std::string_view choice : field.choices)
        if (ui::choice(readable_name(choice) + "##" + std::string(choice), choice == now))
            apply_field_text(session, source, [&](const void*) { return std::string(choice); });
    ImGui::EndCombo();
}

void boolean_cell(Session& session, const FieldSource& source) {
    const bool mixed = !same_in_all(source);
    bool on = field_to_text(*source.field, source.objects[0]) == "true";
    ImGui::PushItemFlag(ImGuiItemFlags_MixedValue, mixed);
    const bool changed = ImGui::Checkbox("##value", &on);
    ImGui::PopItemFlag();
    ui::note("value", mixed ? "mixed" : on ? "on" : "off");
    if (changed)
        apply_field_text(session, source, [&](const void*) { return on ? "true" : "false"; });
}

// Text is taken when it is complete: at Enter, or when something else is clicked.
void text_cell(Session& session, const FieldSource& source, float width) {
    auto& [editing, text] = ui::text_edit();
    const ImGuiID id = ImGui::GetID("##value");
    const std::string now = same_in_all(source) ? field_to_text(*source.field, source.objects[0]) : std::string();
    std::string shown = editing == id ? text : now;
    ImGui::SetNextItemWidth(width);
    const bool enter = ImGui::InputText("##value", &shown, ImGuiInputTextFlags_EnterReturnsTrue);
    ui::note("value", shown);
    if (ImGui::IsItemActive() || enter) { // on a slow machine, letters may come in the same frame as Enter
        editing = id;
        text = shown;
    }
    if (editing != id || ImGui::IsItemActive())
        return;
    editing = 0;
    const bool escape = ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape], false) && !enter;
    if (!escape && text != now)
        apply_field_text(session, source, [typed = text](const void*) { return typed; });
}

// A dot where the value is not the usual one; clicked, it is.
void reset_cell(Session& session, const FieldSource& source) {
    if (source.defaults == nullptr)
        return;
    std::string usual = field_to_text(*source.field, source.defaults);
    if (field_to_text(*source.field, source.objects[0]) == usual && same_in_all(source))
        return;
    ImGui::SameLine(0.0f, 0.2f * ui::unit());
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float side = ImGui::GetFrameHeight();
    const bool pressed = ImGui::InvisibleButton("reset", ImVec2(0.8f * ui::unit(), side));
    const float radius = (ImGui::IsItemHovered() ? 0.3f : 0.2f) * ui::unit();
    ImGui::GetWindowDrawList()->AddCircleFilled(ImVec2(low.x + 0.4f * ui::unit(), low.y + 0.5f * side), radius,
                                                changed_colour);
    ui::note("reset");
    ui::tooltip("Reset to " + (usual.empty() ? "nothing" : usual));
    if (pressed)
        apply_field_text(session, source, [&](const void*) { return usual; });
}

void cells(Session& session, const FieldSource& source) {
    const Field& field = *source.field;
    float width = ImGui::GetContentRegionAvail().x - ui::unit();
    const int parts = number_of_parts(field);
    if (is_colour(field)) {
        colour_cell(session, source);
        ImGui::SameLine(0.0f, 0.25f * ui::unit());
        width -= ImGui::GetFrameHeight() + 0.25f * ui::unit();
    }
    if (parts > 0)
        return number_cells(session, source, parts, width);
    switch (field.kind) {
    case FieldKind::boolean:
        return boolean_cell(session, source);
    case FieldKind::choice:
        return choice_cell(session, source, width);
    case FieldKind::text:
        return text_cell(session, source, width);
    default:
        ui::label("(entity)");
    }
}

} // namespace

void apply_field_text(Session& session, const FieldSource& source,
                      const std::function<std::string(const void*)>& text) {
    Document& document = *session.document;
    document.begin(source.gesture);
    const Status status = set_all(source, [&](std::size_t i) { return text(source.objects[i]); });
    if (session.messages.check(status))
        document.commit();
    else
        document.cancel();
}

std::string readable_name(std::string_view name) {
    std::string result(name);
    std::replace(result.begin(), result.end(), '_', ' ');
    if (!result.empty())
        result[0] = char(std::toupper(static_cast<unsigned char>(result[0])));
    return result;
}

// Where there is no room for both, names stand above their values.
bool begin_fields(const char* id, float names) {
    const bool beside = names * ImGui::GetContentRegionAvail().x >= room_for_name * ui::unit();
    if (!ImGui::BeginTable(id, beside ? 2 : 1, ImGuiTableFlags_SizingStretchProp))
        return false;
    if (!beside)
        return true;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, names);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 1.0f - names);
    return true;
}

void end_fields() {
    ImGui::EndTable();
}

void field_row(Session& session, const FieldSource& source) {
    const ui::Scope scope(source.field->name);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ui::label(readable_name(source.field->name), field_help(*source.field, source.defaults));
    ui::note("name");
    ImGui::TableNextColumn();
    cells(session, source);
    reset_cell(session, source);
}

} // namespace sunfleck::editor
