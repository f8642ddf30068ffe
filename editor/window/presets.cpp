#include "editor/window/presets.h"

#include "engine/core/file.h"
#include "viewer/quality.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

namespace sunfleck::editor {
namespace {

constexpr const char* preset_ending = ".json";

} // namespace

std::vector<std::string> preset_names(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code code;
    for (const std::filesystem::path& path : folder_content(folder, code))
        if (path.extension() == preset_ending)
            names.push_back(path.stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

Status save_preset(const std::filesystem::path& folder, const std::string& name, const gi::Settings& settings) {
    const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char letter) {
        return std::isalnum(letter) != 0 || letter == ' ' || letter == '-' || letter == '_';
    });
    if (name.empty() || name.size() > 60 || !plain)
        return Error{"'" + name + "' cannot be a preset's name: up to 60 letters, digits, spaces, '-' and '_' are"};
    if (folder.empty())
        return Error{"the preset '" + name + "' has no place to be kept: neither HOME nor XDG_CONFIG_HOME is set"};
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const auto& [setting, value] : viewer::unusual_lighting(settings))
        json[setting] = value;
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    return write_file(folder / (name + preset_ending), json.dump(1) + "\n");
}

Result<gi::Settings> load_preset(const std::filesystem::path& folder, const std::string& name) {
    const std::filesystem::path path = folder / (name + preset_ending);
    SUNFLECK_ASSIGN(const std::string text, read_file(path, 1u << 20));
    const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
    if (!json.is_object())
        return Error{"the preset '" + path.string() + "' is damaged"};
    gi::Settings settings = viewer::usual_lighting();
    for (const auto& [setting, value] : json.items())
        SUNFLECK_TRY(settings.set(setting, value.is_string() ? value.get<std::string>() : value.dump()));
    SUNFLECK_TRY(settings.validate());
    return settings;
}

Status apply_preset(const std::filesystem::path& folder, const std::string& name, Document& document) {
    SUNFLECK_ASSIGN(const gi::Settings settings, load_preset(folder, name));
    document.begin("Apply preset " + name);
    Status status = document.set_settings(settings);
    if (status)
        document.commit();
    else
        document.cancel();
    return status;
}

} // namespace sunfleck::editor
