// Playback without a window: recorded (or the usual) input, one picture after the other, statistics as JSON.
#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/statistics/summary.h"
#include "game_demo/level.h"
#include "game_demo/options.h"
#include "game_demo/presets.h"
#include "game_demo/walk_through.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sunfleck::demo {
namespace {

struct Times {
    std::vector<double> frames;
    std::map<std::string, std::vector<double>> gpu, cpu;

    void add(const viewer::FrameStatistics& statistics) {
        frames.push_back(statistics.frame_ms);
        for (const auto& [name, time] : statistics.gpu_ms)
            gpu[name].push_back(time);
        for (const auto& [name, time] : statistics.cpu_ms)
            cpu[name].push_back(time);
    }
};

nlohmann::ordered_json medians(const std::map<std::string, std::vector<double>>& times) {
    nlohmann::ordered_json result = nlohmann::ordered_json::object();
    for (const auto& [name, values] : times)
        result[name] = statistics::median(values);
    return result;
}

nlohmann::ordered_json statistics_of(Level& level, const Options& options, const DemoSettings& settings,
                                     const Times& times, const std::string& device) {
    const gi::Report& counters = level.renderer().lighting().counters();
    char hash[32];
    std::snprintf(hash, sizeof hash, "%016llx",
                  static_cast<unsigned long long>(level.simulation().world_hash(level.renderer().registry())));
    return {{"device", device},
            {"scene", options.scene},
            {"preset", field_to_text(*DemoSettings::description().find("preset"), &settings)},
            {"frames", times.frames.size()},
            {"steps", level.simulation().steps()},
            {"world_hash", hash},
            {"frame_ms",
             {{"median", statistics::median(times.frames)},
              {"p95", statistics::percentile(times.frames, 0.95)},
              {"min", statistics::percentile(times.frames, 0.0)},
              {"max", statistics::percentile(times.frames, 1.0)}}},
            {"cpu_ms", medians(times.cpu)},
            {"gpu_ms", medians(times.gpu)},
            {"counters",
             {{"light_samples", counters["light_samples"]},
              {"light_samples_dynamic", counters["light_samples_dynamic"]},
              {"pixels_low_resolution", counters["pixels_low_resolution"]},
              {"pixels_repaired", counters["pixels_repaired"]},
              {"transfer_vertices", counters["transfer_vertices"]},
              {"bodies_rescued", level.simulation().physics().rescued()},
              {"player_rescued", level.simulation().player().rescued()}}}};
}

} // namespace

Status run_headless(const Options& options) {
    if (options.output.empty())
        return Error{"--headless needs a folder for its pictures: -o DIR"};
    std::vector<simulation::StepInput> recorded;
    if (!options.input.empty()) {
        SUNFLECK_ASSIGN(recorded, simulation::read_recording(options.input));
        if (recorded.empty())
            return Error{"'" + options.input + "' has no steps"};
    }
    std::error_code code;
    std::filesystem::create_directories(options.output, code);
    if (code)
        return Error{"cannot make folder '" + options.output + "': " + code.message()};
    SUNFLECK_ASSIGN(const auto device, gpu::Device::create({options.device, options.validation, {}}));
    DemoSettings settings;
    settings.preset = options.preset.value_or(usual_preset(device->traits().software));
    apply_preset(settings);
    settings.transfer = options.transfer.value_or(settings.transfer);
    SUNFLECK_ASSIGN(const auto level, Level::load(*device, options.scene, settings, 2));
    WalkThrough walk;
    std::vector<simulation::StepInput> done;
    Times times;
    const std::uint32_t stride = std::max(1u, options.steps_per_frame);
    const std::uint32_t frames = options.frames > 0  ? options.frames
                                 : !recorded.empty() ? std::uint32_t((recorded.size() + stride - 1) / stride)
                                                     : 100000;
    const std::uint32_t expected = options.frames > 0 || !recorded.empty() ? frames : 1600; // the usual walk
    const std::uint32_t interval = std::max(1u, expected / std::max(1u, options.pictures));
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        for (std::uint32_t k = 0; k < stride; ++k) {
            simulation::StepInput input;
            if (recorded.empty())
                input = walk.next(level->simulation());
            else if (done.size() < recorded.size())
                input = recorded[done.size()];
            level->step(input);
            done.push_back(input);
        }
        viewer::FrameRequest request = level->request(settings, options.width, options.height);
        request.indirect_scale = options.indirect ? 1.0f : 0.0f;
        SUNFLECK_TRY(level->renderer().render_and_wait(request));
        times.add(level->renderer().statistics());
        const bool last = frame + 1 == frames || (options.frames == 0 && recorded.empty() && walk.finished());
        if (options.pictures > 0 && (frame % interval == 0 || last)) {
            char name[32];
            std::snprintf(name, sizeof name, "frame_%05u.png", frame);
            SUNFLECK_ASSIGN(const io::Picture picture, level->renderer().read_back());
            SUNFLECK_TRY(io::write_picture(std::filesystem::path(options.output) / name, picture));
        }
        if (frame % 200 == 199)
            log_information("frame " + std::to_string(frame + 1) +
                            (options.frames > 0 ? " of " + std::to_string(frames) : ""));
        if (last)
            break;
    }
    if (!options.record.empty())
        SUNFLECK_TRY(simulation::write_recording(options.record, done));
    const auto statistics = statistics_of(*level, options, settings, times, device->traits().name);
    SUNFLECK_TRY(write_file(std::filesystem::path(options.output) / "stats.json", statistics.dump(2) + "\n"));
    if (device->validation_messages() > 0)
        return Error{"validation printed messages (see above)"};
    return {};
}

} // namespace sunfleck::demo
