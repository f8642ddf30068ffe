#include "editor/gate/picture_store.h"

#include "engine/core/file.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>

namespace sunfleck::gate {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* manifest_name = "manifest.json";
constexpr int manifest_version = 1;

Error manifest_error(const fs::path& file, const std::string& what) {
    return Error{"'" + file.string() + "': " + what};
}

bool is_text(const Json& json, const char* key) {
    return json.contains(key) && json[key].is_string();
}

bool valid_name(const std::string& name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    });
}

Result<std::vector<NamedFrame>> parse_frames(const Json& json) {
    std::vector<NamedFrame> frames;
    if (!json.contains("frames") || !json["frames"].is_object() || json["frames"].empty())
        return Error{"'frames' must name at least one frame"};
    for (const auto& [name, number] : json["frames"].items()) {
        if (!valid_name(name) || !number.is_number_unsigned() || number.get<std::uint64_t>() >= most_frames)
            return Error{"'frames', '" + name + "': a name of letters, digits, _ and -, and a frame are needed"};
        frames.push_back({name, number.get<std::uint32_t>()});
    }
    std::sort(frames.begin(), frames.end(), [](const NamedFrame& a, const NamedFrame& b) { return a.frame < b.frame; });
    return frames;
}

Status check_same_drawing(const PictureStore& store, const Hello& hello) {
    const auto differ = [&](const std::string& what, const std::string& stored, const std::string& now) {
        return Error{"the pictures in '" + store.folder.string() + "' show something else: " + what + " is '" + stored +
                     "' there and '" + now + "' here (--accept replaces them)"};
    };
    if (store.recording != hello.recording)
        return differ("the recording", store.recording, hello.recording);
    if (store.size != hello.size)
        return differ("the size", store.size, hello.size);
    for (const auto& [name, value] : store.settings)
        if (const auto found = hello.settings.find(name); found != hello.settings.end() && found->second != value)
            return differ("setting '" + name + "'", value, found->second);
    return {};
}

} // namespace

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    std::string vendor = "unknown", vectors;
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find(": ");
        if (line.rfind("vendor_id", 0) == 0 && colon != std::string::npos)
            vendor = line.substr(colon + 2);
        if (line.rfind("flags", 0) != 0)
            continue;
        vectors = line.find(" avx512f") != std::string::npos ? ", AVX-512"
                  : line.find(" avx2") != std::string::npos  ? ", AVX2"
                                                             : "";
        break;
    }
    return vendor + vectors;
}

Result<NamedFrame> parse_named_frame(const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
    const bool digits = !number.empty() && number.size() < 8 &&
                        std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!valid_name(name) || !digits)
        return Error{"'" + text + "': NAME=FRAME is needed, the name of letters, digits, _ and -"};
    return NamedFrame{name, std::uint32_t(std::stoul(number))};
}

Result<PictureStore> read_picture_store(const fs::path& folder) {
    const fs::path file = folder / manifest_name;
    SUNFLECK_ASSIGN(const std::string text, read_file(file));
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object() || json.value("sunfleck_pictures", Json()) != manifest_version)
        return manifest_error(file, "\"sunfleck_pictures\": 1 is needed");
    for (const char* key : {"processor", "driver", "recording", "size"})
        if (!is_text(json, key))
            return manifest_error(file, std::string("'") + key + "' must be there, as text");
    PictureStore store{folder, {json["processor"], json["driver"]}, json["recording"], json["size"], {}, {}};
    const Json settings = json.value("settings", Json::object());
    for (const auto& [name, value] : settings.items())
        if (value.is_string())
            store.settings[name] = value;
    Result<std::vector<NamedFrame>> frames = parse_frames(json);
    if (!frames)
        return manifest_error(file, frames.error().message);
    store.frames = std::move(*frames);
    return store;
}

Status compare_picture(PictureResult& result, bool to_the_bit) {
    SUNFLECK_ASSIGN(const io::Picture stored, io::read_picture(result.stored));
    SUNFLECK_ASSIGN(const io::Picture picture, io::read_picture(result.drawn));
    result.difference = picture_difference(stored, picture);
    result.fault = picture_fault(result.difference, to_the_bit);
    return {};
}

Result<std::vector<PictureResult>> compare_with_store(const PictureStore& store, const Hello& hello,
                                                      const fs::path& drawn) {
    SUNFLECK_TRY(check_same_drawing(store, hello));
    const bool to_the_bit = store.maker == Maker{processor_name(), hello.driver};
    std::vector<PictureResult> results;
    for (const NamedFrame& frame : store.frames) {
        PictureResult result{frame, store.file(frame), drawn / (frame.name + ".png"), {}, {}};
        SUNFLECK_TRY(compare_picture(result, to_the_bit));
        results.push_back(std::move(result));
    }
    return results;
}

Result<std::vector<fs::path>> accept_pictures(PictureStore store, const Hello& hello, const fs::path& drawn) {
    std::error_code code;
    fs::create_directories(store.folder, code);
    if (code)
        return Error{"cannot make '" + store.folder.string() + "': " + code.message()};
    std::vector<fs::path> written;
    Json frames = Json::object();
    for (const NamedFrame& frame : store.frames) {
        frames[frame.name] = frame.frame;
        SUNFLECK_ASSIGN(const std::string bytes, read_file(drawn / (frame.name + ".png")));
        if (const auto old = read_file(store.file(frame)); old && *old == bytes)
            continue;
        SUNFLECK_TRY(write_file(store.file(frame), bytes));
        written.push_back(store.file(frame));
    }
    Json json = {{"sunfleck_pictures", manifest_version},
                 {"processor", processor_name()},
                 {"driver", hello.driver},
                 {"recording", hello.recording},
                 {"size", hello.size},
                 {"frames", frames}};
    json["settings"] = hello.settings;
    SUNFLECK_TRY(write_file(store.folder / manifest_name, json.dump(2) + "\n"));
    written.push_back(store.folder / manifest_name);
    return written;
}

} // namespace sunfleck::gate
