// What frames took: their history with median, 95th percentile and budget, and the stages and passes of one of them.
#include "editor/panels/panel.h"
#include "editor/window/value_box.h"
#include "engine/core/file.h"
#include "engine/statistics/summary.h"
#include "viewer/trace.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace sunfleck::editor {
namespace {

class Profile final : public Panel {
public:
    void draw(Session& session) override;

private:
    void controls(Session& session);
    void step(const std::deque<ProfiledFrame>& frames);
    void save(Session& session, bool trace) const;
    void history(const std::deque<ProfiledFrame>& frames, double budget);
    void graph(const char* name, const std::vector<gpu::ScopeTime>& scopes, double whole);
    void compare(const ProfiledFrame& frame);
    std::uint64_t chosen_ = 0;          // number of a frame; 0: the newest
    std::optional<ProfiledFrame> kept_; // that others are compared with
};

ImU32 colour_of_name(const std::string& name) {
    std::uint32_t hash = 2166136261u;
    for (const char letter : name)
        hash = (hash ^ std::uint8_t(letter)) * 16777619u;
    float red = 0.0f, green = 0.0f, blue = 0.0f;
    ImGui::ColorConvertHSVtoRGB(float(hash % 360u) / 360.0f, 0.45f, 0.62f, red, green, blue);
    return IM_COL32(int(red * 255.0f), int(green * 255.0f), int(blue * 255.0f), 255);
}

std::string milliseconds(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f ms", value);
    return text;
}

std::string table_of(const std::deque<ProfiledFrame>& frames) {
    std::string text = "frame,row,name,begin_ms,end_ms\n";
    const auto rows = [&](const ProfiledFrame& frame, const char* row, const std::vector<gpu::ScopeTime>& scopes) {
        for (const gpu::ScopeTime& scope : scopes)
            text += std::to_string(frame.number) + "," + row + "," + scope.name + "," + std::to_string(scope.begin_ms) +
                    "," + std::to_string(scope.end_ms) + "\n";
    };
    for (const ProfiledFrame& frame : frames) {
        rows(frame, "CPU", frame.statistics.cpu_scopes);
        rows(frame, "GPU", frame.statistics.gpu_scopes);
    }
    return text;
}

// In the folder that the program was started in, beside those that were saved before.
void Profile::save(Session& session, bool trace) const {
    std::error_code code;
    const std::filesystem::path path =
        free_path(std::filesystem::current_path(code) / (trace ? "sunfleck_trace.json" : "sunfleck_frames.csv"));
    Status written;
    if (trace) {
        viewer::Trace frames;
        for (const ProfiledFrame& frame : session.frames)
            frames.add(frame.statistics);
        written = frames.write(path);
    } else {
        written = write_file(path, table_of(session.frames));
    }
    if (session.messages.check(written))
        session.messages.say("Wrote " + path.string());
}

// To the frame before or after.
void Profile::step(const std::deque<ProfiledFrame>& frames) {
    const auto end = frames.end();
    auto place = std::find_if(frames.begin(), end, [&](const ProfiledFrame& one) { return one.number == chosen_; });
    if (place == end && !frames.empty())
        place = std::prev(end); // the newest
    ImGui::SameLine();
    if (ui::button("<##before", "The frame before", place != frames.begin()))
        chosen_ = std::prev(place)->number;
    ImGui::SameLine();
    if (ui::button(">##after", "The frame after", place != end && std::next(place) != end))
        chosen_ = std::next(place)->number;
}

void Profile::controls(Session& session) {
    if (ui::button(session.profiling ? "Pause##pause" : "Go on##pause", "Whether further frames are kept"))
        session.profiling = !session.profiling;
    ImGui::SameLine();
    if (ui::button("Newest", "Follow the newest frame", chosen_ != 0))
        chosen_ = 0;
    step(session.frames);
    ImGui::SameLine();
    if (ui::button("Save trace",
                   "A new file sunfleck_trace.json in the current folder, for chrome://tracing or ui.perfetto.dev",
                   !session.frames.empty()))
        save(session, true);
    ImGui::SameLine();
    if (ui::button("Save CSV", "A new file sunfleck_frames.csv in the current folder", !session.frames.empty()))
        save(session, false);
    ui::NumberLook look;
    look.value = double(session.budgets.frame_ms);
    look.minimum = double(Budgets::least_ms);
    look.maximum = double(Budgets::most_ms);
    look.unit = "ms";
    look.width = 6.0f * ui::unit();
    const char* const name = "Budget";
    ImGui::SameLine();
    if (ImGui::GetContentRegionAvail().x < look.width + ImGui::CalcTextSize(name).x + ui::unit())
        ImGui::NewLine(); // in a narrow panel on a line of its own
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine();
    if (const std::optional<double> most = value_box(session, "budget", "Budget of a frame", look))
        session.budgets.frame_ms = float(*most);
    ui::tooltip("What a frame may take, 1 to 1,000 ms; the status bar and measured costs are held against it");
}

// Both frames' stages and passes, those that differ most first.
void Profile::compare(const ProfiledFrame& frame) {
    struct Row {
        std::string name;
        double before = 0.0, now = 0.0;
    };
    std::map<std::string, Row> rows;
    for (const bool on_gpu : {false, true})
        for (const bool now : {false, true}) {
            const viewer::FrameStatistics& statistics = now ? frame.statistics : kept_->statistics;
            for (const auto& [name, time] : on_gpu ? statistics.gpu_ms : statistics.cpu_ms) {
                Row& row = rows[(on_gpu ? "GPU  " : "CPU  ") + name];
                (now ? row.now : row.before) = time;
            }
        }
    std::vector<Row> sorted;
    sorted.reserve(rows.size());
    for (auto& [name, row] : rows)
        sorted.push_back({name, row.before, row.now});
    std::stable_sort(sorted.begin(), sorted.end(), [](const Row& a, const Row& b) {
        return std::abs(a.now - a.before) > std::abs(b.now - b.before);
    });
    if (!ImGui::BeginTable("compare", 4, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg))
        return;
    const std::string kept = "frame " + std::to_string(kept_->number), shown = "frame " + std::to_string(frame.number);
    for (const char* name : {"stage or pass", kept.c_str(), shown.c_str(), "difference"})
        ImGui::TableSetupColumn(name);
    ImGui::TableHeadersRow();
    for (const Row& row : sorted) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ui::label(row.name);
        for (const double time : {row.before, row.now}) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(milliseconds(time).c_str());
        }
        ImGui::TableNextColumn();
        const double change = row.now - row.before;
        ImGui::TextColored(change > 0.0 ? ImVec4(1.0f, 0.6f, 0.5f, 1.0f) : ImVec4(0.6f, 0.9f, 0.6f, 1.0f), "%+.2f ms",
                           change);
        ui::note("difference " + row.name, milliseconds(change));
    }
    ImGui::EndTable();
}

// A bar a frame; click one to look at it.
void Profile::history(const std::deque<ProfiledFrame>& frames, double budget) {
    std::vector<double> times;
    times.reserve(frames.size());
    for (const ProfiledFrame& frame : frames)
        times.push_back(frame.statistics.frame_ms);
    const double middle = statistics::median(times), high = statistics::percentile(times, 0.95);
    const double top = std::max(1.15 * high, 1.1 * budget);
    const ImVec2 low = ImGui::GetCursorScreenPos(),
                 size(std::max(ImGui::GetContentRegionAvail().x, 1.0f), 4.0f * ui::unit());
    ImGui::InvisibleButton("history", size);
    ui::note("history", milliseconds(middle) + " median, " + milliseconds(high) + " 95 %");
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(low, ImVec2(low.x + size.x, low.y + size.y), IM_COL32(16, 15, 14, 255));
    const float wide = size.x / float(ProfiledFrame::most);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const float x = low.x + float(i) * wide, height = float(std::min(times[i] / top, 1.0)) * size.y;
        const bool chosen = frames[i].number == chosen_;
        list->AddRectFilled(ImVec2(x, low.y + size.y - height), ImVec2(x + std::max(wide - 0.5f, 1.0f), low.y + size.y),
                            chosen              ? IM_COL32(255, 255, 255, 255)
                            : times[i] > budget ? IM_COL32(220, 110, 70, 255)
                                                : IM_COL32(110, 160, 110, 255));
    }
    const auto line = [&](double value, ImU32 colour, const std::string& text, float place) {
        const float y = low.y + size.y * (1.0f - float(std::min(value / top, 1.0)));
        list->AddLine(ImVec2(low.x, y), ImVec2(low.x + size.x, y), colour);
        // Above the line, or below where there is no room, and readable over bars.
        const ImVec2 text_size = ImGui::CalcTextSize(text.c_str());
        const float above = y - text_size.y - 1.0f;
        const ImVec2 from(low.x + 4.0f + place * (size.x - text_size.x - 8.0f), above < low.y ? y + 2.0f : above);
        list->AddRectFilled(ImVec2(from.x - 2.0f, from.y), ImVec2(from.x + text_size.x + 2.0f, from.y + text_size.y),
                            IM_COL32(16, 15, 14, 200));
        list->AddText(from, colour, text.c_str());
        ui::note_place("line " + text, "", from, ImVec2(from.x + text_size.x, from.y + text_size.y));
    };
    line(budget, IM_COL32(240, 200, 90, 220), "budget", 0.0f);
    line(high, IM_COL32(200, 200, 200, 220), "95 % " + milliseconds(high), 1.0f);
    line(middle, IM_COL32(150, 200, 240, 220), "median " + milliseconds(middle), 0.5f);
    if (!ImGui::IsItemHovered())
        return;
    const auto index = std::size_t(std::max((ImGui::GetIO().MousePos.x - low.x) / wide, 0.0f));
    if (index < frames.size()) {
        ImGui::SetTooltip("frame %llu: %s", static_cast<unsigned long long>(frames[index].number),
                          milliseconds(times[index]).c_str());
        if (ImGui::IsMouseClicked(0))
            chosen_ = frames[index].number;
    }
}

// Scopes as they lie in one another; they come in the order of their beginnings.
void Profile::graph(const char* name, const std::vector<gpu::ScopeTime>& scopes, double whole) {
    const ui::Scope names(name);
    const float row = 1.3f * ui::unit(), label_width = 3.0f * ui::unit();
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x - label_width;
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddText(low, ImGui::GetColorU32(ImGuiCol_TextDisabled), name);
    std::vector<double> ends;
    std::size_t deepest = 0;
    for (const gpu::ScopeTime& scope : scopes) {
        while (!ends.empty() && scope.begin_ms >= ends.back())
            ends.pop_back();
        const float x = low.x + label_width + width * float(scope.begin_ms / whole);
        const float end = low.x + label_width + width * float(scope.end_ms / whole);
        const ImVec2 from(x, low.y + float(ends.size()) * row), to(std::max(end, x + 1.0f), from.y + row - 1.0f);
        ends.push_back(scope.end_ms);
        deepest = std::max(deepest, ends.size());
        list->AddRectFilled(from, to, colour_of_name(scope.name));
        if (const float room = to.x - from.x - 6.0f; room > 2.0f * ui::unit())
            list->AddText(ImVec2(from.x + 3.0f, from.y), IM_COL32(255, 255, 255, 255),
                          ui::fitted(scope.name, room).c_str());
        const std::string time = milliseconds(scope.end_ms - scope.begin_ms);
        ui::note_place(scope.name, time, from, to);
        if (ImGui::IsMouseHoveringRect(from, to) && ImGui::IsWindowHovered())
            ImGui::SetTooltip("%s: %s, from %.2f ms on", scope.name.c_str(), time.c_str(), scope.begin_ms);
    }
    ImGui::Dummy(ImVec2(width, float(std::max<std::size_t>(deepest, 1)) * row));
}

void Profile::draw(Session& session) {
    const ui::Scope scope("profile");
    controls(session);
    if (session.frames.empty())
        return ImGui::TextDisabled("No frame has been drawn yet");
    history(session.frames, double(session.budgets.frame_ms));
    const ProfiledFrame* frame = &session.frames.back();
    for (const ProfiledFrame& one : session.frames)
        if (one.number == chosen_)
            frame = &one;
    ImGui::AlignTextToFramePadding();
    ImGui::Text("Frame %llu: %s", static_cast<unsigned long long>(frame->number),
                milliseconds(frame->statistics.frame_ms).c_str());
    ui::note("frame", std::to_string(frame->number));
    ImGui::SameLine();
    if (ui::button(kept_ ? "Compare no longer" : "Compare with others",
                   "Keeps this frame: the stages and passes of others are shown beside its own"))
        kept_ = kept_ ? std::nullopt : std::optional(*frame);
    if (kept_ && kept_->number != frame->number)
        return compare(*frame);
    double whole = 1e-3;
    for (const auto* scopes : {&frame->statistics.cpu_scopes, &frame->statistics.gpu_scopes})
        for (const gpu::ScopeTime& one : *scopes)
            whole = std::max(whole, one.end_ms);
    graph("CPU", frame->statistics.cpu_scopes, whole);
    graph("GPU", frame->statistics.gpu_scopes, whole);
}

} // namespace

std::unique_ptr<Panel> make_profile() {
    return std::make_unique<Profile>();
}

} // namespace sunfleck::editor
