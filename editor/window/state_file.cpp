#include "editor/window/state_file.h"

#include "engine/core/file.h"
#include "engine/core/user_folders.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sunfleck::editor {
namespace {

using Json = nlohmann::ordered_json;

// A number of the file, or what it was.
template <typename T>
void read_number(const Json& json, const char* name, T& value) {
    if (const auto found = json.find(name); found != json.end() && found->is_number())
        if (const double number = found->get<double>();
            std::isfinite(number) && std::abs(number) < 1e9 && (std::is_signed_v<T> || number >= 0.0))
            value = T(number);
}

void read_strings(const Json& json, std::vector<std::string>& values) {
    if (json.is_array())
        for (const Json& one : json)
            if (one.is_string())
                values.push_back(one.get<std::string>());
}

Json camera_json(const scene::CameraView& view) {
    return {view.position.x,
            view.position.y,
            view.position.z,
            view.target.x,
            view.target.y,
            view.target.z,
            view.vertical_field_of_view};
}

bool read_camera(const Json& json, scene::CameraView& view) {
    if (!json.is_array() || json.size() != 7)
        return false;
    float numbers[7];
    for (std::size_t i = 0; i < 7; ++i) {
        if (!json[i].is_number())
            return false;
        numbers[i] = json[i].get<float>();
        if (!std::isfinite(numbers[i]))
            return false;
    }
    view.position = {numbers[0], numbers[1], numbers[2]};
    view.target = {numbers[3], numbers[4], numbers[5]};
    view.vertical_field_of_view = numbers[6];
    return view.position != view.target && numbers[6] > 0.01f && numbers[6] < 3.1f;
}

void read_layout(const Json& json, Layout::State& layout) {
    read_number(json, "left", layout.left);
    read_number(json, "right", layout.right);
    read_number(json, "bottom", layout.bottom);
    std::vector<std::string> front;
    if (const auto found = json.find("front"); found != json.end())
        read_strings(*found, front);
    for (std::size_t i = 0; i < front.size() && i < layout.front.size(); ++i)
        layout.front[i] = front[i];
}

} // namespace

std::filesystem::path usual_state_file() {
    const std::filesystem::path folder = user_settings_folder();
    return folder.empty() ? folder : folder / "editor.json";
}

EditorState load_state(const std::filesystem::path& path, std::string& problem, bool& may_save) {
    EditorState state;
    std::error_code code;
    may_save = !path.empty();
    if (path.empty())
        problem = "Layout, keys and unsaved edits are not kept: neither HOME nor XDG_CONFIG_HOME is set "
                  "(--settings FILE names a file)";
    if (path.empty() || !std::filesystem::exists(path, code))
        return state;
    const auto text = read_file(path, 1u << 20);
    if (!text) { // what can't be read may be fine
        problem = text.error().message + "; layout and keys are the usual ones, and will not be kept";
        may_save = false;
        return state;
    }
    const Json json = Json::parse(*text, nullptr, false);
    if (!json.is_object()) {
        problem = "'" + path.string() + "' is damaged; layout and keys are the usual ones";
        set_aside(path);
        return state;
    }
    if (const auto found = json.find("layout"); found != json.end() && found->is_object())
        read_layout(*found, state.layout);
    read_number(json, "width", state.width);
    read_number(json, "height", state.height);
    if (const auto found = json.find("recent"); found != json.end())
        read_strings(*found, state.recent_files);
    if (const auto found = json.find("keys"); found != json.end() && found->is_object())
        for (const auto& [name, keys] : found->items())
            if (keys.is_string())
                state.keys[name] = keys.get<std::string>();
    read_number(json, "budget_ms", state.budgets.frame_ms);
    state.budgets.frame_ms = std::clamp(state.budgets.frame_ms, 1.0f, 1000.0f);
    if (const auto found = json.find("counter_budgets"); found != json.end() && found->is_object())
        for (const auto& [name, most] : found->items())
            if (most.is_number() && most.get<double>() >= 0.0)
                state.budgets.counters[name] = most.get<double>();
    if (const auto found = json.find("cameras"); found != json.end() && found->is_object())
        for (const auto& [file, camera] : found->items())
            if (scene::CameraView view; read_camera(camera, view))
                state.cameras[file] = view;
    return state;
}

Status save_state(const std::filesystem::path& path, const EditorState& state) {
    Json json;
    json["layout"] = {{"left", state.layout.left},
                      {"right", state.layout.right},
                      {"bottom", state.layout.bottom},
                      {"front", state.layout.front}};
    json["width"] = state.width;
    json["height"] = state.height;
    json["recent"] = state.recent_files;
    json["keys"] = state.keys;
    json["budget_ms"] = state.budgets.frame_ms;
    json["counter_budgets"] = state.budgets.counters;
    for (const auto& [file, camera] : state.cameras)
        json["cameras"][file] = camera_json(camera);
    std::error_code code;
    std::filesystem::create_directories(path.parent_path(), code);
    return write_file(path, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

} // namespace sunfleck::editor
