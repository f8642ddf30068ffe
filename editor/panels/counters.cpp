// What the lighting counted in the frame that is shown.
#include "editor/panels/panel.h"
#include "editor/window/value_box.h"
#include "gi_module/technique.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::editor {
namespace {

class Counters final : public Panel {
public:
    void draw(Session& session) override;
};

std::string amount(double value, std::string_view unit) {
    char text[64];
    if (unit == "B")
        std::snprintf(text, sizeof text, value < 1e6 ? "%.1f kB" : "%.1f MB",
                      value < 1e6 ? value * 1e-3 : value * 1e-6);
    else
        std::snprintf(text, sizeof text, "%.6g %s", value, std::string(unit).c_str());
    return text;
}

// Names within the popup end before it does.
void budget_box(Session& session, const gi::Counter& counter, double count) {
    const ui::Scope scope("budget");
    const std::string name(counter.name);
    const auto budget = session.budgets.counters.find(name);
    const bool has = budget != session.budgets.counters.end();
    ui::NumberLook look;
    look.value = has ? budget->second : count;
    look.maximum = 1e12;
    look.unit = std::string(counter.unit);
    look.width = 10.0f * ui::unit();
    ImGui::TextDisabled("Amber above");
    ImGui::SameLine();
    if (const std::optional<double> most = value_box(session, "most", "Budget of " + name, look))
        session.budgets.counters[name] = *most;
    if (ui::button("No budget", {}, has)) {
        session.budgets.counters.erase(name);
        ImGui::CloseCurrentPopup();
    }
}

// Click it to give it a budget; what is over its own is amber.
void value(Session& session, const gi::Counter& counter, double count) {
    const std::string name(counter.name);
    const auto budget = session.budgets.counters.find(name);
    const bool has = budget != session.budgets.counters.end(), over = has && count > budget->second;
    const std::string text = amount(count, counter.unit) + (has ? " / " + amount(budget->second, counter.unit) : "");
    ImGui::PushID(name.c_str());
    if (over)
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1.0f, 0.66f, 0.4f, 1.0f));
    if (ImGui::Selectable((text + "###value").c_str(), false, 0, ImVec2(ImGui::CalcTextSize(text.c_str()).x, 0.0f)))
        ImGui::OpenPopup("budget");
    if (over)
        ImGui::PopStyleColor();
    ui::note(name, text);
    ui::tooltip(std::string(counter.tooltip) + "\n\nClick: a budget for it");
    if (ImGui::BeginPopup("budget")) {
        ui::close_by_escape();
        budget_box(session, counter, count);
        ImGui::EndPopup();
    }
    ImGui::PopID();
}

void Counters::draw(Session& session) {
    const ui::Scope scope("counters");
    const std::shared_ptr<ScenePicture> picture = session.scene.picture();
    if (picture == nullptr) {
        ImGui::TextDisabled("No frame has been drawn yet");
        return;
    }
    const int columns = std::max(1, int(ImGui::GetContentRegionAvail().x / (22.0f * ui::unit())));
    if (!ImGui::BeginTable("counters", 2 * columns, ImGuiTableFlags_SizingStretchProp))
        return;
    std::string_view group;
    for (const gi::Counter* counter : gi::all_counters()) {
        if (counter->group != group) {
            group = counter->group;
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextColored(ImVec4(0.95f, 0.72f, 0.38f, 1.0f), "%s", std::string(group).c_str());
            ImGui::TableNextRow();
        }
        ImGui::TableNextColumn();
        ui::label(std::string(counter->name), counter->tooltip);
        ImGui::TableNextColumn();
        value(session, *counter, picture->statistics.counters[counter->name]);
    }
    ImGui::EndTable();
}

} // namespace

std::unique_ptr<Panel> make_counters() {
    return std::make_unique<Counters>();
}

} // namespace sunfleck::editor
