// One place of the picture: its surface, and which light gives it how much.
#include "editor/panels/panel.h"
#include "editor/window/fields.h"

#include <algorithm>
#include <cstdio>
#include <map>

namespace sunfleck::editor {
namespace {

// A light at the place, of any technique.
struct Share {
    const gi::LightShare* light;
    float part = 0.0f, unshadowed = 0.0f; // of the sum's luminance
};

class Pixel final : public Panel {
public:
    void draw(Session& session) override;

private:
    void surface(Session& session, const viewer::PixelReport& report);
    void summary(Session& session, const InspectedPixel& pixel);
    void lamps(Session& session);
    void list(Session& session);
    void gather(const InspectedPixel& pixel);

    std::shared_ptr<const InspectedPixel> shown_; // of the shares
    std::vector<Share> shares_;                   // the largest first
    float total_ = 0.0f;
    bool hidden_too_ = false;
    static constexpr std::size_t most_rows = 300;
};

std::string format(const char* pattern, double a, double b = 0.0, double c = 0.0) {
    char text[120];
    std::snprintf(text, sizeof text, pattern, a, b, c);
    return text;
}

std::string vector_text(vec3 value, const char* pattern = "%.3f  %.3f  %.3f") {
    return format(pattern, double(value.x), double(value.y), double(value.z));
}

std::string light_text(vec3 irradiance) {
    return format("%.4g W/m2", double(luminance(irradiance))) + "\n" + vector_text(irradiance, "%.3g  %.3g  %.3g");
}

std::string percent(float share) {
    const char* const pattern = share < 0.001f ? "%.2f %%" : share < 0.9995f ? "%.1f %%" : "%.0f %%";
    return format(pattern, 100.0 * double(share));
}

std::string entity_name(Session& session, Entity entity) {
    return session.document->exists(entity) ? session.document->name(entity) : "(not known)";
}

std::string bounces_text(std::uint32_t bounce) {
    return bounce == 0 ? "straight" : bounce == 1 ? "1 bounce" : std::to_string(bounce) + " bounces";
}

// A table of names and values, both as long as they need be.
bool begin_values(const char* name) {
    if (!ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingStretchSame))
        return false;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 1.0f);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 1.8f);
    return true;
}

// In as many lines as it needs, which end at the gaps between numbers: Dear ImGui also ends lines at a decimal point.
std::string broken_at_gaps(const std::string& text, float room) {
    constexpr std::string_view gap = "  ";
    std::string result = text;
    std::size_t begin = 0; // of the line
    for (std::size_t at = result.find(gap); at != result.npos; at = result.find(gap, at + 1)) {
        const std::size_t next = std::min(result.find(gap, at + gap.size()), result.size());
        if (const std::size_t end_of_line = result.rfind('\n', at); end_of_line != result.npos)
            begin = std::max(begin, end_of_line + 1);
        if (ImGui::CalcTextSize(result.c_str() + begin, result.c_str() + next).x <= room)
            continue;
        result.replace(at, gap.size(), "\n");
        begin = at + 1;
    }
    return result;
}

void row(const std::string& name, const std::string& value, std::string_view tip = {}) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextDisabled("%s", name.c_str());
    ui::tooltip(tip);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(broken_at_gaps(value, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopTextWrapPos();
    ui::note(name, value);
}

// What a light's row says when it is pointed at.
std::string sample_text(Session& session, const viewer::PixelReport& report, std::uint32_t index) {
    if (index >= report.samples.size())
        return {};
    const viewer::SampleState& sample = report.samples[index];
    std::string text =
        "Shadow map: slot " + std::to_string(sample.map.slot) + ", " + std::to_string(sample.map.resolution) +
        " texels along a side, " +
        (sample.map.frames_out_of_date == 0 ? "up to date"
                                            : std::to_string(sample.map.frames_out_of_date) + " frames old");
    if (!sample.map.static_part_valid)
        text += ", not drawn yet";
    if (!report.patch)
        return text;
    text += "\nVisibility database: ";
    switch (sample.between) {
    case gi::PairState::none:
        text += "nothing stands between";
        break;
    case gi::PairState::partial:
        text += "something may stand between";
        break;
    case gi::PairState::full:
        text += "hidden";
        break;
    case gi::PairState::unlit:
        text += "the patch faces away";
        break;
    }
    for (const auto& blocker : sample.blockers)
        text += "\n   " + (blocker.entity.is_null() ? "what stands still" : entity_name(session, blocker.entity)) +
                (blocker.full ? ", all of it" : ", a part");
    return text;
}

void Pixel::gather(const InspectedPixel& pixel) {
    shares_.clear();
    total_ = std::max(luminance(pixel.report.irradiance()), 1e-30f);
    for (const gi::ExplainedLight& part : pixel.report.light)
        for (const gi::LightShare& light : part.shares)
            shares_.push_back({&light, luminance(light.irradiance) / total_, luminance(light.unshadowed) / total_});
    std::stable_sort(shares_.begin(), shares_.end(), [](const Share& a, const Share& b) {
        return a.part != b.part ? a.part > b.part : a.unshadowed > b.unshadowed;
    });
}

void Pixel::surface(Session& session, const viewer::PixelReport& report) {
    ui::heading("Surface");
    const std::string name = entity_name(session, report.entity);
    if (ui::button(name + "##surface", "Selects it", session.document->exists(report.entity)))
        session.document->select({report.entity});
    ui::note("surface", name);
    ImGui::SameLine();
    ImGui::TextDisabled(report.moves ? "moves" : "stands still");
    if (!begin_values("surface"))
        return;
    row("position", vector_text(report.position) + " m");
    row("normal", vector_text(report.normal), "That light is received by");
    row("distance", format("%.4g m", double(report.distance)), "From the camera");
    ImGui::EndTable();
    if (!ImGui::TreeNode("Material at this place"))
        return;
    if (begin_values("material")) {
        for (const viewer::PixelReport::Value& value : report.material_values())
            row(readable_name(value.name), value.value + (value.unit.empty() ? "" : " " + value.unit));
        ImGui::EndTable();
    }
    ImGui::TreePop();
}

void Pixel::summary(Session& session, const InspectedPixel& pixel) {
    ui::heading("Light that arrives");
    if (!begin_values("light"))
        return;
    const vec3 sum = pixel.report.irradiance();
    row("in the picture", light_text(pixel.shown), "Irradiance of this pixel, as the techniques have computed it");
    row("sum of shares", light_text(sum), "Of all lights below, each tested by a ray");
    for (const gi::ExplainedLight& part : pixel.report.light)
        row("by " + readable_name(part.technique), part.divided ? light_text(part.sum()) : "not divided by lights");
    if (const auto& patch = pixel.report.patch) {
        row("patch",
            "#" + std::to_string(patch->node) +
                (pixel.report.moves ? ", a mover" : ", level " + std::to_string(patch->level)),
            "Of the visibility database");
        row("light samples",
            std::to_string(patch->samples.none) + " free, " + std::to_string(patch->samples.partial) + " in part, " +
                std::to_string(patch->samples.full) + " hidden, " + std::to_string(patch->samples.unlit) + " behind",
            "What the database says of the patch: they need no shadow test, need one, give nothing, or lie behind it");
    }
    ImGui::EndTable();
    if (session.inspecting && session.inspecting->serial == pixel.serial &&
        pixel.revision != session.document->revision())
        ImGui::TextDisabled("Older than the last edit");
}

// How much comes from each lamp, straight and reflected.
void Pixel::lamps(Session& session) {
    struct Parts {
        float straight = 0.0f, reflected = 0.0f;
    };
    std::map<std::string, std::pair<Entity, Parts>> by_lamp;
    for (const Share& share : shares_) {
        auto& [entity, parts] = by_lamp[entity_name(session, share.light->emitter)];
        entity = share.light->emitter;
        (share.light->bounce == 0 ? parts.straight : parts.reflected) += share.part;
    }
    ui::heading("Lamps");
    if (!ImGui::BeginTable("lamps", 4, ImGuiTableFlags_SizingStretchSame | ImGuiTableFlags_RowBg))
        return;
    for (const auto& [name, width] :
         {std::pair("lamp", 1.4f), {"straight", 1.0f}, {"reflected", 1.0f}, {"share", 0.9f}})
        ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthStretch, width);
    ImGui::TableHeadersRow();
    for (const auto& [name, lamp] : by_lamp) {
        const auto& [entity, parts] = lamp;
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        if (ui::choice(name + "##lamp", session.document->selected(entity), "Selects it") &&
            session.document->exists(entity))
            session.document->select({entity});
        for (const float part : {parts.straight, parts.reflected, parts.straight + parts.reflected}) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(percent(part).c_str());
        }
        ui::note("lamp " + name, percent(parts.straight + parts.reflected));
    }
    ImGui::EndTable();
}

void Pixel::list(Session& session) {
    ui::heading("Lights");
    ui::toggle("Hidden ones, too", hidden_too_, "Lights that something stands in the way of");
    if (session.view.chosen_sample) {
        ImGui::SameLine();
        if (ui::button("Choose none", "No light sample is singled out in overlays"))
            session.view.chosen_sample.reset();
    }
    if (!ImGui::BeginTable("shares", 4, ImGuiTableFlags_SizingStretchSame | ImGuiTableFlags_RowBg))
        return;
    for (const auto& [name, width] : {std::pair("light", 1.4f), {"way", 1.0f}, {"W/m2", 1.0f}, {"share", 0.9f}})
        ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthStretch, width);
    ImGui::TableHeadersRow();
    std::size_t rows = 0;
    for (const Share& share : shares_) {
        const bool hidden = share.part <= 0.0f;
        if ((hidden && !hidden_too_) || ++rows > most_rows)
            continue;
        const gi::LightShare& light = *share.light;
        const std::string number = light.sample ? std::to_string(*light.sample) : std::to_string(rows);
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        const bool chosen = light.sample && session.view.chosen_sample == light.sample;
        std::string title = number;
        title.append(" ").append(entity_name(session, light.emitter)).append("##light ").append(number);
        if (ui::choice(title, chosen,
                       light.sample
                           ? "Click: singled out in overlays\n" + sample_text(session, shown_->report, *light.sample)
                           : std::string()) &&
            light.sample)
            session.view.chosen_sample = chosen ? std::nullopt : light.sample;
        ui::note("light " + std::to_string(rows), percent(share.part));
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(bounces_text(light.bounce).c_str());
        ImGui::TableNextColumn();
        const std::string amount = format("%.3g", double(luminance(hidden ? light.unshadowed : light.irradiance)));
        ImGui::TextUnformatted((hidden ? "(" + amount + ")" : amount).c_str());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(hidden ? "hidden" : percent(share.part).c_str());
    }
    ImGui::EndTable();
    if (rows > most_rows)
        ImGui::TextDisabled("and %d more", int(rows - most_rows));
}

void Pixel::draw(Session& session) {
    const ui::Scope scope("pixel");
    const std::shared_ptr<const InspectedPixel> pixel = session.scene.inspected();
    if (pixel == nullptr) {
        ImGui::PushTextWrapPos(0.0f);
        ImGui::TextDisabled(session.inspecting ? "Waits for the picture to settle"
                                               : "Choose Inspect (I) over the picture and click a place, or click it "
                                                 "holding Alt: what is there, and which lights give it how much");
        ImGui::PopTextWrapPos();
        return;
    }
    if (pixel != shown_) {
        shown_ = pixel;
        gather(*pixel);
    }
    if (pixel->report.entity.is_null()) {
        ImGui::TextDisabled("There is no surface");
        return;
    }
    surface(session, pixel->report);
    summary(session, *pixel);
    lamps(session);
    list(session);
}

} // namespace

std::unique_ptr<Panel> make_pixel() {
    return std::make_unique<Pixel>();
}

} // namespace sunfleck::editor
