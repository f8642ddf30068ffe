// sunfleck bench level: a recorded walk measured frame by frame, into a file or for `bench compare`.
#include "editor/command_line/level_run.h"

#include "engine/core/file.h"
#include "engine/core/output.h"

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

namespace sunfleck::command_line {
namespace {

void say(const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
}

Status answer(LevelRun& run, const gate::DrawFrames& request) {
    std::vector<gate::Frame> frames;
    SUNFLECK_TRY(run.go_to(request.first));
    for (std::uint32_t i = 0; i < request.count; ++i)
        SUNFLECK_TRY(run.draw(frames));
    SUNFLECK_TRY(run.finish(frames));
    for (const gate::Frame& frame : frames)
        say(gate::frame_line(frame));
    return {};
}

// Speaks the gate's protocol until its input ends.
Status serve(LevelRun& run) {
    say(gate::hello_line(run.hello()));
    for (std::string line; std::getline(std::cin, line);) {
        SUNFLECK_ASSIGN(const gate::Request request, gate::parse_request(line));
        if (std::holds_alternative<gate::Quit>(request))
            return {};
        if (const auto* draw = std::get_if<gate::DrawFrames>(&request))
            SUNFLECK_TRY(answer(run, *draw));
        if (const auto* picture = std::get_if<gate::WritePicture>(&request)) {
            SUNFLECK_TRY(run.write_picture(picture->file));
            say(gate::picture_line(picture->file));
        }
    }
    return {};
}

Json level_json(LevelRun& run, const LevelOptions& options, const std::vector<gate::Frame>& frames) {
    Measurement measurement;
    measurement.scene = options.scene;
    measurement.settings = run.settings();
    measurement.size = run.size();
    for (const gate::Frame& frame : frames) {
        measurement.frame_ms.push_back(frame.frame_ms);
        measurement.cpu_ms.push_back(frame.stages);
        measurement.gpu_ms.push_back(frame.passes);
    }
    measurement.counters = run.counters();
    measurement.memory = run.device().memory().usage();
    Json json = measurement_json(run.device(), measurement);
    json["gate"] = Json::parse(gate::hello_line(run.hello()));
    json["each_frame"] = Json::array();
    for (const gate::Frame& frame : frames)
        json["each_frame"].push_back(Json::parse(gate::frame_line(frame)));
    return json;
}

Status measure(LevelRun& run, const LevelOptions& options) {
    const std::uint32_t end =
        options.frames == 0 ? run.frames() : std::min(options.warmup + options.frames, run.frames());
    std::vector<gate::Frame> frames;
    Progress progress("bench level");
    while (run.next_frame() < end) {
        SUNFLECK_TRY(run.draw(frames));
        if (run.next_frame() == options.warmup)
            frames.clear();
        if (interrupted())
            return Error{"interrupted; nothing was written"};
        progress.show(double(run.next_frame()) / end, "");
    }
    SUNFLECK_TRY(run.finish(frames));
    const Json json = level_json(run, options, frames);
    if (!options.output.empty())
        return write_file(options.output, json.dump(1) + "\n");
    say(json.dump());
    return {};
}

} // namespace

Status bench_level(const LevelOptions& options) {
    const NamedFile output = {"-o", options.output},
                    inputs[] = {{"--input", options.input}, {"--scene", options.scene}};
    SUNFLECK_TRY(try_outputs({&output, 1}, inputs));
    SUNFLECK_ASSIGN(const auto run, LevelRun::create(options));
    return options.serve ? serve(*run) : measure(*run, options);
}

} // namespace sunfleck::command_line
