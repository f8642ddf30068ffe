#include "editor/gate/level_file.h"

#include "engine/core/file.h"

#include <nlohmann/json.hpp>

namespace sunfleck::gate {
namespace {

constexpr std::uint32_t stretches = 12;
constexpr std::uint32_t least_frames = 4 * stretches;
// Two runs of the same program, one after the other on a shared machine, differ by so much.
constexpr double between_runs = 0.15, harm_between_runs = 0.25;

Result<LevelFile> parse_level_file(const std::string& text) {
    const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
    if (!json.is_object())
        return Error{"it is empty, cut off or not JSON"};
    if (!json.contains("gate") || !json.contains("each_frame") || !json["each_frame"].is_array())
        return Error{"it was not written by `sunfleck bench level -o FILE`: 'gate' and 'each_frame' are missing"};
    LevelFile file;
    SUNFLECK_ASSIGN(file.hello, parse_hello(json["gate"].dump()));
    for (const auto& element : json["each_frame"]) {
        Result<Frame> frame = parse_frame(element.dump());
        if (!frame)
            return Error{"frame " + std::to_string(file.frames.size()) + ": " + frame.error().message};
        file.frames.push_back(std::move(*frame));
    }
    return file;
}

Status check_frames(const LevelFile& base, const LevelFile& head) {
    if (base.frames.size() != head.frames.size())
        return Error{"base has " + std::to_string(base.frames.size()) + " frames, head " +
                     std::to_string(head.frames.size()) + "; the same frames are needed"};
    if (base.frames.size() < least_frames)
        return Error{"the files have " + std::to_string(base.frames.size()) + " frames; at least " +
                     std::to_string(least_frames) + " are needed"};
    for (std::size_t i = 0; i < base.frames.size(); ++i)
        if (base.frames[i].number != head.frames[i].number)
            return Error{"base and head do not have the same frames: " + std::to_string(base.frames[i].number) +
                         " in base stands where " + std::to_string(head.frames[i].number) + " is in head"};
    return {};
}

} // namespace

Result<LevelFile> read_level_file(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const std::string text, read_file(path));
    Result<LevelFile> file = parse_level_file(text);
    if (!file)
        return Error{"'" + path.string() + "': " + file.error().message};
    return file;
}

Result<GateRun> compare_files(const std::filesystem::path& base_path, const std::filesystem::path& head_path,
                              const std::set<std::string>& accepted_counters) {
    SUNFLECK_ASSIGN(const LevelFile base, read_level_file(base_path));
    SUNFLECK_ASSIGN(const LevelFile head, read_level_file(head_path));
    SUNFLECK_TRY(check_alike(base.hello, head.hello));
    SUNFLECK_TRY(check_frames(base, head));
    GateRun run{Comparison(accepted_counters), {}, 0.0, {}, {}, {}};
    const std::size_t frames = base.frames.size();
    for (std::size_t stretch = 0; stretch < stretches; ++stretch) {
        PairRun pair{base.hello, head.hello, {}};
        for (std::size_t i = stretch * frames / stretches; i < (stretch + 1) * frames / stretches; ++i)
            pair.frames.push_back({base.frames[i], head.frames[i], true});
        SUNFLECK_TRY(run.comparison.add(pair));
    }
    statistics::GateOptions options;
    options.looks = {stretches};
    options.tolerance = between_runs;
    options.harm = harm_between_runs;
    SUNFLECK_ASSIGN(run.report, run.comparison.judge(options));
    run.weaker = "a weaker verdict, from files of one process each: only a slow-down beyond 15 % counts, and 'fine' "
                 "says no more than that none is beyond 25 %; programs side by side tell 5 %";
    return run;
}

} // namespace sunfleck::gate
