#include "editor/command_line/common.h"

#include "engine/core/log.h"
#include "engine/core/stop_signals.h"

#include "gi_module/technique.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sunfleck::command_line {

Status apply_environment(const SceneOptions& options, ecs::Registry& registry, std::uint64_t* content_hash) {
    if (options.environment.empty())
        return {};
    // The user's own choice may lie anywhere.
    SUNFLECK_ASSIGN(auto image, io::load_environment_image(options.environment, {{}, true, content_hash}));
    std::vector<ecs::Entity> present;
    registry.view<scene::Environment>().each(
        [&](ecs::Entity entity, const scene::Environment&) { present.push_back(entity); });
    for (const ecs::Entity entity : present)
        registry.destroy(entity);
    const ecs::Entity entity = registry.create();
    registry.emplace<scene::Environment>(entity, {vec3(1.0f)});
    registry.emplace<scene::EnvironmentMap>(entity, {options.environment, 0.0f, std::move(image)});
    return {};
}

io::ImportOptions import_options(const SceneOptions& options) {
    io::ImportOptions result = options.import;
    result.progress = viewer::progress_until_stopped("loading");
    return result;
}

scene::CameraView camera_of_frame(const scene::CameraView& start, const SceneOptions& options, std::uint32_t frame) {
    return start.orbited(glm::radians(options.orbit_degrees) * float(frame));
}

Status apply_setting(gi::Settings& settings, const std::string& assignment) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos)
        return Error{"--set '" + assignment + "': name=value is needed"};
    const std::string name = assignment.substr(0, equals);
    if (const Status status = settings.set(name, assignment.substr(equals + 1)); !status)
        return gi::Settings::find(name) == nullptr ? Error{"--set: " + status.error().message} : status.error();
    return {};
}

std::string setting_problem(const std::string& assignment) {
    gi::Settings settings;
    const Status status = apply_setting(settings, assignment);
    if (status)
        return {};
    std::string message = status.error().message; // the parser has named the option
    for (const std::string prefix : {"--set: ", "--set "})
        if (message.compare(0, prefix.size(), prefix) == 0)
            return message.substr(prefix.size());
    return message;
}

std::string json_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

Json settings_json(const gi::Settings& settings) {
    Json json = Json::object();
    for (const gi::Settings::ConstPart& part : settings.parts())
        for (const Field& field : part.type->fields) {
            const std::string text = field_to_text(field, part.values);
            const bool is_text = field.kind == FieldKind::choice || field.kind == FieldKind::text;
            json[std::string(field.name)] = is_text ? Json(text) : Json::parse(text);
        }
    return json;
}

namespace {

Json medians(const std::vector<std::map<std::string, double>>& frames) {
    std::map<std::string, std::vector<double>> by_name;
    for (const auto& frame : frames)
        for (const auto& [name, value] : frame)
            by_name[name].push_back(value);
    Json json = Json::object();
    for (const auto& [name, values] : by_name)
        json[name] = median(values);
    return json;
}

} // namespace

// Whole numbers as such.
Json number_json(double value) {
    if (value == std::floor(value) && std::abs(value) < 9e15)
        return Json(std::int64_t(value));
    return Json(value);
}

std::optional<float> exposure_of(const SceneOptions& options, ecs::Registry& registry) {
    return options.ev100 ? options.ev100 : viewer::scene_exposure(registry);
}

Json measurement_json(const gpu::Device& device, const Measurement& measurement) {
    const gi::Report& counters = measurement.counters;
    Json json;
    json["device"] = device.traits().name;
    json["driver"] = device.traits().driver;
    json["scene"] = measurement.scene;
    json["settings"] = settings_json(measurement.settings);
    json["settings"]["width"] = measurement.size.width;
    json["settings"]["height"] = measurement.size.height;
    json["ev100"] = measurement.ev100;
    json["frames"] = measurement.frames > 0 ? measurement.frames : measurement.frame_ms.size();
    json["frame_ms"] = {{"median", median(measurement.frame_ms)},
                        {"p95", percentile(measurement.frame_ms, 0.95)},
                        {"min", percentile(measurement.frame_ms, 0.0)},
                        {"max", percentile(measurement.frame_ms, 1.0)}};
    json["cpu_ms"] = medians(measurement.cpu_ms);
    json["gpu_ms"] = medians(measurement.gpu_ms);
    json["counters"] = Json::object();
    json["memory_bytes"] = Json::object();
    for (const gi::Counter* counter : gi::all_counters())
        json[counter->group == gi::memory_group ? "memory_bytes" : "counters"][std::string(counter->name)] =
            number_json(counters[counter->name]);
    for (const auto& [what, bytes] : measurement.memory)
        json["memory_bytes"][what] = bytes;
    return json;
}

int fail(const Error& error) {
    std::fprintf(stderr, "error: %s\n", error.message.c_str());
    return exit_failed;
}

int exit_status(const Status& status, int on_error) {
    if (status)
        return exit_done;
    fail(status.error());
    return stop_requested() ? exit_stopped_by(stop_signal()) : on_error;
}

bool interrupted() {
    return stop_requested();
}

} // namespace sunfleck::command_line
