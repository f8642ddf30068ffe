// What the lighting counted in the frame that is shown.
#include "editor/panels/panel.h"
#include "gi_module/technique.h"

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
        ui::text(std::string(counter->name), amount(picture->statistics.counters[counter->name], counter->unit));
    }
    ImGui::EndTable();
}

} // namespace

std::unique_ptr<Panel> make_counters() {
    return std::make_unique<Counters>();
}

} // namespace sunfleck::editor
