// Every setting of the lighting, from the descriptions.
#include "editor/panels/panel.h"
#include "editor/window/comparison.h"
#include "editor/window/cost_thread.h"
#include "editor/window/fields.h"
#include "viewer/quality.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

namespace sunfleck::editor {
namespace {

class Lighting final : public Panel {
public:
    void draw(Session& session) override;

private:
    bool shown(const Field& field) const;
    void part(Session& session, const gi::Settings::ConstPart& now, const gi::Settings::ConstPart& usual);
    void cost_row(Session& session, const Field& field, const std::string& value, const std::string& usual);
    std::string old_value(const Session& session, const std::string& setting, const std::string& usual);
    Cost newest_cost(const Session& session, const std::string& setting);
    bool is_outdated(const Session& session, const std::string& setting) const;
    std::string filter_;
    // What was measured, and of what: document, its revision, what of it was hidden, and what the viewport showed.
    struct Measured {
        Cost cost;
        std::uint64_t document = 0, revision = 0, hiding = 0;
        ViewRequest view;
    };
    std::map<std::string, Measured> measured_; // by setting
    Measured begun_;                           // what is being measured is of this
    // Of this entry of this document's history.
    std::map<std::string, std::string> old_settings_;
    std::pair<const Document*, std::uint64_t> old_of_;
    bool only_changed_ = false;
};

// "ShadowSettings" -> "Shadow settings"
std::string title_of(std::string_view name) {
    std::string result;
    for (const char letter : name) {
        if (std::isupper(static_cast<unsigned char>(letter)) != 0 && !result.empty())
            result += ' ';
        result += result.empty() ? letter : char(std::tolower(static_cast<unsigned char>(letter)));
    }
    return result;
}

bool Lighting::shown(const Field& field) const {
    return filter_.empty() || field.name.find(filter_) != std::string_view::npos ||
           readable_name(field.name).find(filter_) != std::string::npos;
}

std::string budget_text(const Session& session, const Cost& cost) {
    if (!cost.finished || !cost.error.empty() || cost.frame.includes_zero())
        return {};
    char text[48];
    std::snprintf(text, sizeof text, "; %+.0f %% of the budget",
                  100.0 * cost.frame.estimate / double(session.budgets.frame_ms));
    return text;
}

// What it was before its last change; `usual` where it was never changed here.
std::string Lighting::old_value(const Session& session, const std::string& setting, const std::string& usual) {
    const std::pair<const Document*, std::uint64_t> now(session.document.get(), session.document->history().serial());
    if (std::exchange(old_of_, now) != now)
        old_settings_ = session.document->history().old_settings();
    const auto found = old_settings_.find(setting);
    return found != old_settings_.end() ? found->second : usual;
}

// What is being measured, or was found last.
Cost Lighting::newest_cost(const Session& session, const std::string& setting) {
    Cost running = session.cost != nullptr ? session.cost->cost() : Cost();
    if (running.setting == setting && !running.finished)
        return running;
    if (running.setting == setting) {
        measured_[setting] = begun_;
        measured_[setting].cost = std::move(running);
    }
    const auto found = measured_.find(setting);
    const bool here = found != measured_.end() && found->second.document == session.document->number();
    return here ? found->second.cost : Cost();
}

// The scene or what is seen of it is another than the one that was measured.
bool Lighting::is_outdated(const Session& session, const std::string& setting) const {
    const auto found = measured_.find(setting);
    if (found == measured_.end() || !found->second.cost.finished)
        return false;
    const Measured& of = found->second;
    return of.revision != session.document->revision() || of.hiding != session.hiding ||
           !same_view(of.view, session.shown);
}

// "; g-buffer +1.2 ms, composition -0.3 ms": the first few.
std::string passes_text(const Cost& cost) {
    constexpr std::size_t most = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(cost.passes.size(), most); ++i) {
        char part[120];
        std::snprintf(part, sizeof part, "%s%s %+.2f ms", i == 0 ? "; " : ", ", cost.passes[i].first.c_str(),
                      cost.passes[i].second.estimate);
        text += part;
    }
    return text + (cost.passes.size() > most ? ", ..." : "");
}

// What the value costs over the old one: asked for, or found.
void Lighting::cost_row(Session& session, const Field& field, const std::string& value, const std::string& usual) {
    const Cost cost = newest_cost(session, std::string(field.name));
    const std::string old = old_value(session, std::string(field.name), usual);
    const bool is_measured = cost.is_of(field.name, value, old);
    const bool changed = value != old;
    if (cost.setting == field.name && !is_measured && !cost.finished) // so it is what the thread is at
        session.cost->stop();                                         // nobody asks about that value any more
    if (!changed && !is_measured)
        return;
    const ui::Scope scope(field.name);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TableNextColumn();
    if (changed && (!is_measured || cost.finished)) {
        if (ui::button("Measure", "What this value costs over the one before, " + old +
                                      ": copies with both are drawn by turns, for a minute and a half at most")) {
            session.measure_cost(std::string(field.name), old);
            begun_ = {{}, session.document->number(), session.document->revision(), session.hiding, session.shown};
        }
        ImGui::SameLine();
    }
    if (!is_measured)
        return ImGui::NewLine();
    ImGui::PushTextWrapPos(0.0f);
    const std::string text = cost_text(cost) + budget_text(session, cost) + passes_text(cost) +
                             (is_outdated(session, std::string(field.name)) ? "; of the scene or view before" : "");
    ImGui::TextDisabled("%s", text.c_str());
    ui::note("cost", text);
    std::string passes;
    for (const auto& [name, interval] : cost.passes) {
        char line[120];
        std::snprintf(line, sizeof line, "%s  %+.2f ms (%.2f to %.2f)\n", name.c_str(), interval.estimate, interval.low,
                      interval.high);
        passes += line;
    }
    ui::tooltip(passes.empty() ? "No pass changed measurably" : "Passes that changed:\n" + passes);
    ImGui::PopTextWrapPos();
}

void Lighting::part(Session& session, const gi::Settings::ConstPart& now, const gi::Settings::ConstPart& usual) {
    std::vector<const Field*> fields;
    for (const Field& field : now.type->fields) {
        const bool changed = field_to_text(field, now.values) != field_to_text(field, usual.values);
        if (shown(field) && (changed || !only_changed_))
            fields.push_back(&field);
    }
    if (fields.empty())
        return;
    const bool open = ImGui::CollapsingHeader(title_of(now.type->name).c_str(), ImGuiTreeNodeFlags_DefaultOpen);
    ui::note(now.type->name, open ? "open" : "");
    ui::tooltip(now.type->tooltip);
    if (!open || !begin_fields(std::string(now.type->name).c_str()))
        return;
    for (const Field* field : fields) {
        FieldSource source;
        source.field = field;
        source.objects = {now.values};
        source.defaults = usual.values;
        source.gesture = "Set " + readable_name(field->name);
        source.set = [&](std::size_t, const std::string& text) {
            return session.document->set_setting(field->name, text);
        };
        field_row(session, source);
        cost_row(session, *field, field_to_text(*field, now.values), field_to_text(*field, usual.values));
    }
    end_fields();
}

void Lighting::draw(Session& session) {
    const gi::Settings& usual = viewer::usual_lighting();
    const ui::Scope scope("lighting");
    ui::text_box("search", filter_, "Search settings", -9.0f * ui::unit());
    ImGui::SameLine();
    ui::toggle("Changed only", only_changed_, "Only settings that differ from their defaults");
    ImGui::BeginChild("settings");
    const auto now = std::as_const(session.document->settings()).parts();
    const auto defaults = usual.parts();
    for (std::size_t i = 0; i < now.size(); ++i)
        part(session, now[i], defaults[i]);
    ImGui::EndChild();
}

} // namespace

std::unique_ptr<Panel> make_lighting() {
    return std::make_unique<Lighting>();
}

} // namespace sunfleck::editor
