// What the viewport shows: the picture, a part of it, or false colours of the lighting, with their legends.
#include "viewer/views.h"
#include "editor/panels/panel.h"
#include "editor/window/commands.h"
#include "editor/window/fields.h"
#include "editor/window/value_box.h"
#include "gi_module/technique.h"
#include "viewer/exposure.h"
#include "viewer/overlays.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::editor {
namespace {

class Views final : public Panel {
public:
    void draw(Session& session) override;
};

void explain(std::string_view tooltip, std::string_view legend, std::string_view unit) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(tooltip.data(), tooltip.data() + tooltip.size());
    if (!legend.empty())
        ImGui::TextDisabled("Colours: %s", std::string(legend).c_str());
    if (!unit.empty())
        ImGui::TextDisabled("Unit: %s", std::string(unit).c_str());
    ImGui::PopTextWrapPos();
}

void picture_views(Session& session) {
    ui::heading("Picture");
    for (const viewer::PictureView& view : viewer::picture_views())
        if (ui::choice(readable_name(view.name) + "##" + std::string(view.name),
                       session.view.lighting_view.empty() && session.view.picture == view.code, view.tooltip)) {
            session.view.lighting_view.clear();
            session.view.picture = view.code;
        }
}

void overlays(Session& session) {
    ui::heading("Overlays");
    for (const gi::Overlay* overlay : viewer::overlays()) {
        const std::string name(overlay->name);
        bool on = session.view.has_overlay(name);
        if (ui::toggle(readable_name(name) + "##overlay " + name, on,
                       std::string(overlay->tooltip) + "\n\nColours: " + std::string(overlay->legend)))
            session.view.toggle_overlay(name);
        if (session.view.has_overlay(name)) {
            ImGui::PushTextWrapPos(0.0f);
            ImGui::TextDisabled("%s", std::string(overlay->legend).c_str());
            ImGui::PopTextWrapPos();
        }
    }
}

void lighting_views(Session& session) {
    std::string_view group = "none";
    for (const gi::DebugView* view : gi::debug_views()) {
        if (view->group != group) {
            group = view->group;
            ui::heading(group.empty() ? "Lighting" : readable_name(group));
        }
        if (ui::choice(readable_name(view->name) + "##" + std::string(view->name),
                       session.view.lighting_view == view->name, view->tooltip)) {
            session.view.lighting_view = std::string(view->name);
            session.view.picture = viewer::picture_view_of(*view);
        }
    }
}

// Rows of numbers that no description has: name, and a box for the new value.
std::optional<double> number_row(Session& session, const std::string& name, const char* tip, ui::NumberLook look) {
    const ui::Scope scope(name);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ui::label(readable_name(name), tip);
    ImGui::TableNextColumn();
    look.width = ImGui::GetContentRegionAvail().x - ui::unit();
    return value_box(session, "value", readable_name(name), look);
}

void exposure_rows(Session& session) {
    const std::shared_ptr<ScenePicture> picture = session.scene.picture();
    ui::NumberLook look;
    look.value = double(session.view.ev100 ? *session.view.ev100 : picture ? picture->ev100 : viewer::default_exposure);
    look.minimum = double(viewer::lowest_exposure);
    look.maximum = double(viewer::highest_exposure);
    look.unit = "EV";
    if (const auto value = number_row(session, "exposure",
                                      "Of the viewport, in place of the scene's or the picture's own: the higher, the "
                                      "darker. -16 to 32 EV at ISO 100",
                                      look))
        session.view.ev100 = float(*value);
    Command& again = *session.commands->find("View/Expose again");
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TableNextColumn();
    if (ui::button(again.name, again.tooltip))
        session.commands->run(again, session);
}

void resolution_row(Session& session) {
    ui::NumberLook look;
    look.value = std::round(100.0 * double(session.view.scale));
    look.minimum = 25.0;
    look.maximum = 100.0;
    look.unit = "%";
    look.whole = true;
    if (const auto value =
            number_row(session, "resolution",
                       "Pixels of the viewport that are drawn, along each side: fewer take less time. 25 "
                       "to 100 %",
                       look))
        session.view.scale = float(*value) / 100.0f;
}

// How light becomes the picture; of the viewport, not of the scene.
void look(Session& session) {
    static const viewer::PictureSettings usual;
    ui::heading("Look");
    if (!begin_fields("look", 0.5f))
        return;
    for (const Field& field : viewer::PictureSettings::description().fields) {
        FieldSource source;
        source.field = &field;
        source.objects = {&session.view.look};
        source.defaults = &usual;
        source.gesture = "Set " + readable_name(field.name);
        source.in_document = false;
        source.set = [&](std::size_t, const std::string& text) {
            return field_from_text(field, &session.view.look, text);
        };
        field_row(session, source);
    }
    exposure_rows(session);
    resolution_row(session);
    end_fields();
}

void legend(const Session& session) {
    for (const gi::DebugView* view : gi::debug_views())
        if (view->name == session.view.lighting_view)
            return explain(view->tooltip, view->legend, view->unit);
    for (const viewer::PictureView& view : viewer::picture_views())
        if (view.code == session.view.picture)
            return explain(view.tooltip, view.legend, view.unit);
}

void Views::draw(Session& session) {
    const ui::Scope scope("views");
    // Where there is no room for four lists beside each other, some stand below.
    constexpr float widest_name = 9.0f; // of a view, with its box, in units
    const int columns = std::clamp(int(ImGui::GetContentRegionAvail().x / (widest_name * ui::unit())), 1, 4);
    if (!ImGui::BeginTable("views", columns, ImGuiTableFlags_SizingStretchSame))
        return;
    if (columns == 4)
        for (const float width : {1.0f, 1.2f, 1.2f, 1.7f})
            ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, width);
    ImGui::TableNextColumn();
    picture_views(session);
    ImGui::TableNextColumn();
    lighting_views(session);
    ImGui::TableNextColumn();
    overlays(session);
    ImGui::TableNextColumn();
    ui::heading("Legend");
    legend(session);
    look(session);
    ImGui::EndTable();
}

} // namespace

std::unique_ptr<Panel> make_views() {
    return std::make_unique<Views>();
}

} // namespace sunfleck::editor
