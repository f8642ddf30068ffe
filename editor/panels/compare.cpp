// The scene, as it is lit now or with settings that were kept, against the path tracer or those settings: as a split
// picture, by turns, as an error map; presets, and what they differ in.
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
    static void choose(Session& session);
    static void show_as(Session& session);
    static void figures(Session& session);
    void presets(Session& session);
    void differences(const Session& session) const;
    std::string name_;
};

// `next`: the name of the option that follows, on the same line where it fits; null: none does.
template <typename T>
void option(const char* name, T value, T& place, const char* tip, const char* next) {
    bool on = place == value;
    if (ImGui::RadioButton(name, on))
        place = value;
    ui::note(name, place == value ? "on" : "off");
    ui::tooltip(tip);
    if (next == nullptr)
        return;
    ImGui::SameLine();
    const float button = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x;
    if (ImGui::GetContentRegionAvail().x < button + ImGui::CalcTextSize(next).x)
        ImGui::NewLine();
}

void Compare::choose(Session& session) {
    Comparison& comparison = *session.comparison;
    ui::heading("Compare");
    option("Scene", CompareWhat::scene, comparison.what, "The scene as it is lit now", "Kept");
    ImGui::BeginDisabled(!comparison.kept());
    option("Kept", CompareWhat::kept_settings, comparison.what,
           "The same scene, lit with the settings kept: against the reference", nullptr);
    ImGui::EndDisabled();
    ImGui::TextDisabled("with");
    option("Nothing", CompareWith::nothing, comparison.with, "The scene alone", "Reference");
    option("Reference", CompareWith::reference, comparison.with, "The path tracer, which works while the scene rests",
           "Kept settings");
    ImGui::BeginDisabled(!comparison.kept());
    option("Kept settings", CompareWith::kept_settings, comparison.with, "The same scene, lit with the settings kept",
           nullptr);
    ImGui::EndDisabled();
}

void Compare::show_as(Session& session) {
    Comparison& comparison = *session.comparison;
    ui::heading("Show as");
    option("Split", CompareAs::split, comparison.as, "What is compared to the left of the line, which can be dragged",
           "Flip");
    option("Flip", CompareAs::flip, comparison.as, "One or the other, by the button or T", "Error");
    option("Error", CompareAs::difference, comparison.as, "Eight times the difference", "Heat");
    option("Heat", CompareAs::heat, comparison.as,
           "The largest difference of a pixel's channels, in colours from black to light yellow", nullptr);
    if (ui::button("Keep settings", "Keeps the settings as they are now, to be compared with"))
        comparison.keep(session.document->settings());
    ImGui::SameLine();
    if (ImGui::GetContentRegionAvail().x < ImGui::CalcTextSize("Show the other").x + ui::unit())
        ImGui::NewLine();
    if (ui::button(comparison.flipped ? "Show the first##flip" : "Show the other##flip", {},
                   comparison.on() && comparison.as == CompareAs::flip))
        comparison.flipped = !comparison.flipped;
}

void Compare::figures(Session& session) {
    Comparison& comparison = *session.comparison;
    if (!comparison.on())
        return;
    if (comparison.without_scene())
        ui::text("state of one", comparison.name_of_one());
    ui::text("state", comparison.name_of_other());
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
    ImGui::TableNextColumn();
    show_as(session);
    figures(session);
    ImGui::TableNextColumn();
    presets(session);
    differences(session);
    ImGui::EndTable();
}

} // namespace

std::unique_ptr<Panel> make_compare() {
    return std::make_unique<Compare>();
}

} // namespace sunfleck::editor
