#include "editor/window/script_files.h"

#include "editor/window/commands.h"
#include "engine/core/file.h"
#include "engine/statistics/summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sunfleck::editor {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t most_times = 20'000;

std::string text_of(const Json& json) {
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace

void ReportFigures::note_frame(double milliseconds) {
    const auto now = std::chrono::steady_clock::now();
    const double gap = std::chrono::duration<double, std::milli>(now - last).count();
    if (gui_frames > 0 && gap < 1000.0)
        longest_gap_ms = std::max(longest_gap_ms, gap);
    last = now;
    ++gui_frames;
    if (gui_ms.size() < most_times) {
        gui_ms.push_back(milliseconds);
        gui_at.push_back(seconds_now());
    }
}

Status write_widgets(const std::filesystem::path& path, const std::vector<ui::Note>& notes, vec2 pointer) {
    static std::string written;
    Json json;
    json["pointer"] = {int(std::lround(pointer.x)), int(std::lround(pointer.y))};
    json["widgets"] = Json::array();
    for (const ui::Note& note : notes)
        json["widgets"].push_back({{"name", note.name},
                                   {"value", note.value},
                                   {"x", note.low.x},
                                   {"y", note.low.y},
                                   {"width", note.high.x - note.low.x},
                                   {"height", note.high.y - note.low.y}});
    std::string text = text_of(json);
    if (text == written)
        return {};
    SUNFLECK_TRY(write_file(path, text));
    written = std::move(text);
    return {};
}

Status write_report(const std::filesystem::path& path, const ReportFigures& figures, Session& session,
                    int validation_messages) {
    const SceneStatus scene = session.scene.status();
    Json json;
    json["gui_frames"] = figures.gui_frames;
    json["wake_ups"] = figures.wake_ups;
    json["gui_ms"] = {{"median", figures.gui_ms.empty() ? 0.0 : statistics::median(figures.gui_ms)},
                      {"p95", figures.gui_ms.empty() ? 0.0 : statistics::percentile(figures.gui_ms, 0.95)}};
    json["gui_frames_at"] = figures.gui_at;
    json["gui_frame_ms"] = figures.gui_ms;
    json["scene_frames_at"] = Json::array();
    json["scene_frame_ms"] = Json::array();
    for (const FrameNote& note : session.scene.frame_notes()) {
        json["scene_frames_at"].push_back(note.at);
        json["scene_frame_ms"].push_back(note.milliseconds);
    }
    json["longest_gap_ms"] = figures.longest_gap_ms;
    json["scene_frames"] = scene.frames;
    json["long_builds"] = scene.builds;
    json["cancelled"] = scene.cancelled;
    json["longest_scene_frame_ms"] = scene.longest_frame_ms;
    json["entities"] = session.document->entity_count();
    json["edits"] = session.document->history().position();
    json["unsaved"] = session.document->unsaved();
    json["validation_messages"] = validation_messages;
    json["messages"] = Json::array();
    for (const Message& message : session.messages.all())
        json["messages"].push_back(message.text);
    for (const Command& command : session.commands->all())
        json["commands"][command.path()] = command.uses;
    return write_file(path, text_of(json));
}

} // namespace sunfleck::editor
