#include "editor/gate/protocol.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

namespace sunfleck::gate {
namespace {

using Json = nlohmann::ordered_json;

std::string shortened(const std::string& line) {
    constexpr std::size_t most = 120;
    return line.size() <= most ? line : line.substr(0, most) + "...";
}

Result<Json> parse_object(const std::string& line) {
    Json json = Json::parse(line, nullptr, false);
    if (!json.is_object())
        return Error{"no JSON object: '" + shortened(line) + "'"};
    return json;
}

Result<std::string> text_at(const Json& json, const char* key) {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_string())
        return Error{std::string("'") + key + "' must be there, as text"};
    return found->get<std::string>();
}

Result<std::uint32_t> count_at(const Json& json, const char* key, std::uint32_t least) {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_number_integer() || found->get<std::int64_t>() < least ||
        found->get<std::int64_t>() > most_frames)
        return Error{std::string("'") + key + "' must be there, as a whole number from " + std::to_string(least) +
                     " to " + std::to_string(most_frames)};
    return std::uint32_t(found->get<std::int64_t>());
}

// Numbers by name; JSON writes what is not finite as null.
Result<std::map<std::string, double>> numbers_at(const Json& json, const char* key, bool negative) {
    std::map<std::string, double> result;
    const auto found = json.find(key);
    if (found == json.end())
        return result;
    if (!found->is_object())
        return Error{std::string("'") + key + "' must be an object of numbers"};
    for (const auto& [name, value] : found->items()) {
        if (!value.is_number() || !std::isfinite(value.get<double>()) || (!negative && value.get<double>() < 0.0))
            return Error{std::string("'") + key + "', '" + name + "': a " +
                         (negative ? "finite number" : "time in ms") + " is needed, not " + shortened(value.dump())};
        result[name] = value.get<double>();
    }
    return result;
}

} // namespace

std::string hello_line(const Hello& hello) {
    Json json = {{"sunfleck_gate", protocol_version}, {"device", hello.device}, {"driver", hello.driver},
                 {"recording", hello.recording},      {"size", hello.size},     {"frames", hello.frames}};
    json["pictures"] = hello.pictures;
    json["settings"] = hello.settings;
    return json.dump();
}

Result<Hello> parse_hello(const std::string& line) {
    SUNFLECK_ASSIGN(const Json json, parse_object(line));
    const auto version = json.find("sunfleck_gate");
    if (version == json.end() || *version != protocol_version)
        return Error{"the first line must have \"sunfleck_gate\": " + std::to_string(protocol_version)};
    Hello hello;
    for (const auto& [key, member] : {std::pair{"device", &Hello::device},
                                      {"driver", &Hello::driver},
                                      {"recording", &Hello::recording},
                                      {"size", &Hello::size}}) {
        SUNFLECK_ASSIGN(hello.*member, text_at(json, key));
    }
    SUNFLECK_ASSIGN(hello.frames, count_at(json, "frames", 1));
    if (const auto pictures = json.find("pictures"); pictures != json.end() && pictures->is_boolean())
        hello.pictures = pictures->get<bool>();
    const auto settings = json.find("settings");
    if (settings == json.end())
        return hello;
    if (!settings->is_object())
        return Error{"'settings' must be an object"};
    for (const auto& [name, value] : settings->items())
        hello.settings[name] = value.is_string() ? value.get<std::string>() : value.dump();
    return hello;
}

std::string frame_line(const Frame& frame) {
    const Json json = {{"frame", frame.number},
                       {"frame_ms", frame.frame_ms},
                       {"passes", frame.passes},
                       {"stages", frame.stages},
                       {"counters", frame.counters}};
    return json.dump();
}

Result<Frame> parse_frame(const std::string& line) {
    SUNFLECK_ASSIGN(const Json json, parse_object(line));
    Frame frame;
    SUNFLECK_ASSIGN(frame.number, count_at(json, "frame", 0));
    const auto time = json.find("frame_ms");
    if (time == json.end() || !time->is_number() || !std::isfinite(time->get<double>()) || time->get<double>() <= 0.0)
        return Error{"'frame_ms' must be there, as a positive number"};
    frame.frame_ms = time->get<double>();
    SUNFLECK_ASSIGN(frame.passes, numbers_at(json, "passes", false));
    SUNFLECK_ASSIGN(frame.stages, numbers_at(json, "stages", false));
    SUNFLECK_ASSIGN(frame.counters, numbers_at(json, "counters", true));
    return frame;
}

std::string request_line(const Request& request) {
    if (const auto* draw = std::get_if<DrawFrames>(&request))
        return "frames " + std::to_string(draw->first) + " " + std::to_string(draw->count);
    if (const auto* picture = std::get_if<WritePicture>(&request))
        return "picture " + picture->file;
    return "quit";
}

Result<Request> parse_request(const std::string& line) {
    constexpr const char* picture = "picture ";
    if (line == "quit")
        return Request{Quit{}};
    if (line.rfind(picture, 0) == 0 && line.size() > std::string(picture).size())
        return Request{WritePicture{line.substr(std::string(picture).size())}};
    std::istringstream words(line);
    std::string verb, rest;
    std::int64_t first = -1, count = 0;
    if (!(words >> verb >> first >> count) || (words >> rest) || verb != "frames" || first < 0 || count < 1 ||
        first + count > most_frames)
        return Error{"'" + shortened(line) + "': 'frames FIRST COUNT', 'picture FILE' or 'quit' is needed"};
    return Request{DrawFrames{std::uint32_t(first), std::uint32_t(count)}};
}

std::string picture_line(const std::string& file) {
    return Json({{"picture", file}}).dump();
}

Status check_picture_line(const std::string& line, const std::string& file) {
    SUNFLECK_ASSIGN(const Json json, parse_object(line));
    SUNFLECK_ASSIGN(const std::string written, text_at(json, "picture"));
    if (written != file)
        return Error{"wrote '" + written + "' where '" + file + "' was asked for"};
    return {};
}

} // namespace sunfleck::gate
