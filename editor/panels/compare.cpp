// The scene, as it is lit now or with settings that were kept, against the path tracer or those settings: as a split
// picture, by turns, as an error map; presets, and what they differ in.
#include "editor/panels/panel.h"
#include "editor/window/comparison.h"
#include "editor/window/fields.h"
#include "editor/window/presets.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

namespace sunfleck::editor {
namespace {

// Names that no preset can have.
constexpr const char *scene_side = "(scene)", *kept_side = "(kept)";

class Compare final : public Panel {
public:
    void draw(Session& session) override;

private:
    static void choose(Session& session);
    static void show_as(Session& session);
    static void figures(Session& session);
    void presets(Session& session);
    void choose_side(const Session& session, const char* name, std::string& side);
    const gi::Settings* settings_of(Session& session, std::size_t which);
    void differences(Session& session);
    std::string name_;
    std::array<std::string, 2> sides_{scene_side, kept_side}; // what is held against one another: these, or presets
    std::map<std::string, gi::Settings> loaded_;              // presets of the sides
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
    const std::string why = comparison.why_without_difference();
    if (difference == nullptr)
        return ui::text("no figures", why.empty() ? "Figures come when both pictures are at rest" : why);
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
        if (session.messages.check(save_preset(session.preset_folder, name_, session.document->settings()))) {
            session.messages.say("Saved the preset '" + name_ + "'");
            loaded_.clear();
        }
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

void Compare::choose_side(const Session& session, const char* name, std::string& side) {
    ImGui::SetNextItemWidth(std::min(9.0f * ui::unit(), ImGui::GetContentRegionAvail().x));
    const bool is_open = ImGui::BeginCombo((std::string("##") + name).c_str(), side.c_str());
    ui::note(name, side);
    ui::tooltip("Settings of the scene, those kept, or a preset");
    if (!is_open)
        return;
    ui::close_by_escape();
    std::vector<std::string> all = preset_names(session.preset_folder);
    all.insert(all.begin(), {scene_side, kept_side});
    for (const std::string& one : all)
        if (ui::choice(one, one == side)) {
            side = one;
            loaded_.clear(); // files may have changed since
        }
    ImGui::EndCombo();
}

// Null: there are none.
const gi::Settings* Compare::settings_of(Session& session, std::size_t which) {
    std::string& side = sides_[which];
    if (side == scene_side)
        return &session.document->settings();
    if (side == kept_side)
        return session.comparison->kept() ? &*session.comparison->kept() : nullptr;
    if (const auto known = loaded_.find(side); known != loaded_.end())
        return &known->second;
    auto settings = load_preset(session.preset_folder, side);
    if (session.messages.check(settings ? Status() : Status(settings.error())))
        return &loaded_.insert_or_assign(side, std::move(*settings)).first->second;
    side = which == 0 ? scene_side : kept_side; // so that it is said once
    return nullptr;
}

// Of two of: the scene's settings, those kept, presets.
void Compare::differences(Session& session) {
    ui::heading("Differences");
    choose_side(session, "first", sides_[0]);
    ImGui::TextDisabled("and");
    ImGui::SameLine();
    choose_side(session, "second", sides_[1]);
    const gi::Settings *const one = settings_of(session, 0), *const two = settings_of(session, 1);
    if (one == nullptr || two == nullptr)
        return ImGui::TextDisabled("None are kept");
    const auto where = [](const std::string& side) {
        return std::string(side == scene_side ? " here" : side == kept_side ? " kept" : " in " + side);
    };
    bool any = false;
    for (const std::string_view name : gi::Settings::names()) {
        const std::string first = one->get(name), second = two->get(name);
        if (first == second)
            continue;
        any = true;
        std::string text = readable_name(name);
        text.append(": ").append(first).append(where(sides_[0])).append(", ");
        text.append(second).append(where(sides_[1]));
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
