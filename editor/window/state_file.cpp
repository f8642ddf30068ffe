#include "editor/window/state_file.h"

#include "engine/core/file.h"
#include "engine/core/user_folders.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <thread>
#include <unistd.h>

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

// Those that are in range.
void read_steps(const Json& json, SnapSteps& steps) {
    const auto found = json.find("snap");
    if (found == json.end() || !found->is_object())
        return;
    SnapSteps read = steps;
    read_number(*found, "length", read.length);
    read_number(*found, "angle", read.angle);
    read_number(*found, "factor", read.factor);
    steps.length = SnapSteps::lengths.has(read.length) ? read.length : steps.length;
    steps.angle = SnapSteps::angles.has(read.angle) ? read.angle : steps.angle;
    steps.factor = SnapSteps::factors.has(read.factor) ? read.factor : steps.factor;
}

Json parsed(const std::string& text) {
    const Json json = Json::parse(text, nullptr, false);
    return json.is_object() ? json : Json::object();
}

// What this editor has opened, and then what others have. Where it has opened nothing new, theirs.
Json merged_list(const Json& before, const Json& now, const Json& theirs) {
    if (now == before)
        return theirs;
    Json result = now;
    const auto has = [](const Json& list, const Json& one) {
        return std::find(list.begin(), list.end(), one) != list.end();
    };
    for (const Json& one : theirs)
        if (!has(now, one) && !has(before, one) && result.size() < Session::most_recent)
            result.push_back(one);
    return result;
}

// `theirs`, with what has changed from `before` to `now`.
Json merged(const Json& before, const Json& now, const Json& theirs) {
    if (now == before)
        return theirs;
    if (!now.is_object() || !theirs.is_object())
        return now;
    Json result = theirs;
    if (before.is_object())
        for (const auto& [name, value] : before.items())
            if (!now.contains(name))
                result.erase(name);
    for (const auto& [name, value] : now.items()) {
        const Json was = before.is_object() && before.contains(name) ? before[name] : Json();
        const Json other = theirs.contains(name) ? theirs[name] : Json();
        const bool are_lists = name == "recent" && value.is_array() && other.is_array();
        const Json one =
            are_lists ? merged_list(was.is_array() ? was : Json::array(), value, other) : merged(was, value, other);
        if (!one.is_null()) // which others have removed
            result[name] = one;
    }
    return result;
}

// Of the folder that the file is in, while it is read and written; the file itself is another after each write. An
// editor that was stopped holds the others up for no longer than a moment.
class FolderLock {
public:
    explicit FolderLock(const std::filesystem::path& file) {
        const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
        std::error_code code;
        std::filesystem::create_directories(folder, code);
        folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        constexpr auto turn = std::chrono::milliseconds(5);
        constexpr int most_turns = 100;
        for (int i = 0; folder_ >= 0 && i < most_turns && ::flock(folder_, LOCK_EX | LOCK_NB) != 0; ++i)
            std::this_thread::sleep_for(turn);
    }
    ~FolderLock() {
        if (folder_ >= 0)
            ::close(folder_);
    }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int folder_ = -1;
};

Status write_state(const std::filesystem::path& path, const Json& json) {
    std::error_code code;
    std::filesystem::create_directories(path.parent_path(), code);
    return write_file(path, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Json state_json(const EditorState& state) {
    Json json;
    json["layout"] = {{"left", state.layout.left},
                      {"right", state.layout.right},
                      {"bottom", state.layout.bottom},
                      {"front", state.layout.front}};
    json["width"] = state.width;
    json["height"] = state.height;
    json["recent"] = state.recent_files;
    json["keys"] = state.keys;
    json["snap"] = {{"length", state.steps.length}, {"angle", state.steps.angle}, {"factor", state.steps.factor}};
    json["budget_ms"] = state.budgets.frame_ms;
    json["counter_budgets"] = state.budgets.counters;
    for (const auto& [file, camera] : state.cameras)
        json["cameras"][file] = camera_json(camera);
    return json;
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
    state.budgets.frame_ms = std::clamp(state.budgets.frame_ms, Budgets::least_ms, Budgets::most_ms);
    read_steps(json, state.steps);
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

std::string state_text(const EditorState& state) {
    return state_json(state).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Status save_state(const std::filesystem::path& path, const EditorState& state) {
    return write_state(path, state_json(state));
}

Status save_changes(const std::filesystem::path& path, const std::string& before, const EditorState& state) {
    const FolderLock lock(path); // two that end at once
    std::error_code code;
    if (!std::filesystem::exists(path, code))
        return save_state(path, state);
    // What cannot be read may be fine, and is not replaced.
    SUNFLECK_ASSIGN(const std::string text, read_file(path, 1u << 20));
    const Json theirs = Json::parse(text, nullptr, false);
    // As equal states have equal texts, this compares what would be written.
    return write_state(path, theirs.is_object() ? merged(parsed(before), parsed(state_text(state)), theirs)
                                                : state_json(state));
}

Status StateKeeper::keep(const std::filesystem::path& path, const EditorState& state, Clock::time_point now) {
    is_old_ = false;
    kept_ = now;
    std::string text = state_text(state);
    if (text == text_)
        return {};
    text_ = std::move(text);
    const Status saved = save_changes(path, written_, state);
    if (saved)
        written_ = text_;
    std::string problem = saved ? std::string() : saved.error().message;
    return std::exchange(problem_, problem) == problem ? Status() : saved;
}

} // namespace sunfleck::editor
