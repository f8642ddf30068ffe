// The scene against the path tracer, or against settings that were kept: as a split picture, by turns, as an error map;
// presets, and what they differ in.
#include "editor/panels/panel.h"
#include "editor/window/comparison.h"
#include "editor/window/fields.h"
#include "editor/window/presets.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::editor {
namespace {

class Compare final : public Panel {
public:
    void draw(Session& session) override;

private:
    void choose(Session& session);
    void figures(Session& session) const;
    void presets(Session& session);
    void differences(const Session& session) const;
    std::string name_;
};

template <typename T>
void option(const char* name, T value, T& place, const char* tip, bool last = false) {
    bool on = place == value;
    if (ImGui::RadioButton(name, on))
        place = value;
    ui::note(name, place == value ? "on" : "off");
    ui::tooltip(tip);
    if (last)
        return;
    ImGui::SameLine();
    if (ImGui::GetContentRegionAvail().x < 6.5f * ui::unit()) // of another one
        ImGui::NewLine();
}

void Compare::choose(Session& session) {
    Comparison& comparison = *session.comparison;
    ui::heading("Compare with");
    option("Nothing", CompareWith::nothing, comparison.with, "The scene alone");
    option("Reference", CompareWith::reference, comparison.with, "The path tracer, which works while the scene rests",
           true);
    ImGui::BeginDisabled(!comparison.kept());
    option("Kept settings", CompareWith::kept_settings, comparison.with, "The same scene, lit with the settings kept",
           true);
    ImGui::EndDisabled();
    option("Split", CompareAs::split, comparison.as, "The scene to the left of the line, which can be dragged");
    option("Flip", CompareAs::flip, comparison.as, "One or the other, by the button or T");
    option("Error", CompareAs::difference, comparison.as, "Eight times the difference", true);
    if (ui::button("Keep settings", "Keeps the settings as they are now, to be compared with"))
        comparison.keep(session.document->settings());
    ImGui::SameLine();
    if (ImGui::GetContentRegionAvail().x < ImGui::CalcTextSize("Show the scene").x + ui::unit())
        ImGui::NewLine();
    if (ui::button(comparison.flipped ? "Show the scene##flip" : "Show the other##flip", {},
                   comparison.on() && comparison.as == CompareAs::flip))
        comparison.flipped = !comparison.flipped;
}

void Compare::figures(Session& session) const {
    Comparison& comparison = *session.comparison;
    if (!comparison.on())
        return;
    ui::text("state", comparison.state());
    const std::shared_ptr<const Difference> difference = comparison.difference();
    if (difference == nullptr)
        return ImGui::TextDisabled("Figures come when both pictures are at rest");
    const auto row = [](const char* name, double value, const char* tip) {
        char text[48];
        std::snprintf(text, sizeof text, "%.4g", value);
        ImGui::TextDisabled("%s", name);
        ui::tooltip(tip);
        ImGui::SameLine(11.0f * ui::unit());
        ui::text(name, text);
    };
    row("relative MSE", difference->metrics.relative_mean_square_error,
        "Mean of |A-B|^2 over |B|^2, of display values");
    row("mean error", difference->metrics.mean_absolute_error, "Mean absolute difference of display values");
    row("FLIP", difference->metrics.flip, "What an eye would see of it, 0 to 1");
}

void Compare::presets(Session& session) {
    ui::heading("Presets");
    ui::text_box("preset", name_, "Name of a preset",
                 std::min(9.0f * ui::unit(), ImGui::GetContentRegionAvail().x - 4.5f * ui::unit()));
    ImGui::SameLine();
    if (ui::button("Save##preset", "Keeps the settings that differ from their defaults under this name",
                   !name_.empty()))
        if (session.messages.check(save_preset(session.preset_folder, name_, session.document->settings())))
            session.messages.say("Saved the preset '" + name_ + "'");
    for (const std::string& name : preset_names(session.preset_folder)) {
        const ui::Scope scope(name);
        if (ui::button("Apply", "One entry of the history"))
            session.messages.check(apply_preset(session.preset_folder, name, *session.document));
        ImGui::SameLine();
        if (ui::button("Keep", "To be compared with")) {
            auto settings = load_preset(session.preset_folder, name);
            if (session.messages.check(settings ? Status() : Status(settings.error())))
                session.comparison->keep(*settings);
        }
        ImGui::SameLine();
        ui::label(name);
    }
}

// Of the scene's settings and those kept.
void Compare::differences(const Session& session) const {
    ui::heading("Kept settings differ in");
    const std::optional<gi::Settings>& kept = session.comparison->kept();
    if (!kept)
        return ImGui::TextDisabled("None are kept");
    bool any = false;
    for (const std::string_view name : gi::Settings::names()) {
        const std::string here = session.document->settings().get(name), there = kept->get(name);
        if (here == there)
            continue;
        any = true;
        std::string text = readable_name(name);
        text.append(": ").append(here).append(" here, ").append(there).append(" kept");
        ui::text("difference " + std::string(name), text);
    }
    if (!any)
        ImGui::TextDisabled("Nothing");
}

void Compare::draw(Session& session) {
    const ui::Scope scope("compare");
    if (!ImGui::BeginTable("compare", 3, ImGuiTableFlags_SizingStretchSame))
        return;
    ImGui::TableNextColumn();
    choose(session);
    figures(session);
    ImGui::TableNextColumn();
    presets(session);
    ImGui::TableNextColumn();
    differences(session);
    ImGui::EndTable();
}

} // namespace

std::unique_ptr<Panel> make_compare() {
    return std::make_unique<Compare>();
}

} // namespace sunfleck::editor
