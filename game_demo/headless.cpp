// Playback without a window: recorded input or the built-in walk, rendered frame by frame, with statistics as JSON.
#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/core/output.h"
#include "engine/core/stop_signals.h"
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

Status write_numbered(const std::string& folder, std::uint32_t frame, const io::Picture& picture) {
    char name[32];
    std::snprintf(name, sizeof name, "frame_%05u.png", frame);
    return io::write_picture(std::filesystem::path(folder) / name, picture);
}

// Plays a level from a recording, or else from the built-in walk.
class Playback {
public:
    Playback(const Options& options, const DemoSettings& settings, std::vector<simulation::StepInput> recorded)
        : options_(options), settings_(settings), recorded_(std::move(recorded)),
          stride_(std::max(1u, options.steps_per_frame)) {
        constexpr std::uint32_t unlimited = 100000, walk_frames = 1600; // about the length of the built-in walk
        frames_ = options.frames > 0   ? options.frames
                  : !recorded_.empty() ? std::uint32_t((recorded_.size() + stride_ - 1) / stride_)
                                       : unlimited;
        const std::uint32_t expected = options.frames > 0 || !recorded_.empty() ? frames_ : walk_frames;
        interval_ = std::max(1u, expected / std::max(1u, options.pictures));
    }

    Status run(Level& level) {
        for (std::uint32_t frame = 0; frame < frames_; ++frame) {
            for (std::uint32_t k = 0; k < stride_; ++k)
                step(level);
            viewer::FrameRequest request = level.request(settings_, options_.width, options_.height);
            request.indirect_scale = options_.indirect ? 1.0f : 0.0f;
            SUNFLECK_TRY(level.renderer().render_and_wait(request));
            if (stop_requested())
                return Error{std::string("stopped by ") + signal_name(stop_signal())};
            times_.add(level.renderer().statistics());
            const bool last = frame + 1 == frames_ || (options_.frames == 0 && recorded_.empty() && walk_.finished());
            if (options_.pictures > 0 && (frame % interval_ == 0 || last)) {
                SUNFLECK_ASSIGN(const io::Picture picture, level.renderer().read_back());
                SUNFLECK_TRY(write_numbered(options_.output, frame, picture));
            }
            if (frame % 200 == 199)
                log_information("frame " + std::to_string(frame + 1) +
                                (options_.frames > 0 ? " of " + std::to_string(frames_) : ""));
            if (last)
                break;
        }
        return {};
    }

    const Times& times() const { return times_; }
    // The input of all steps so far.
    const std::vector<simulation::StepInput>& played() const { return played_; }

private:
    void step(Level& level) {
        simulation::StepInput input;
        if (recorded_.empty())
            input = walk_.next(level.simulation());
        else if (played_.size() < recorded_.size())
            input = recorded_[played_.size()];
        level.step(input);
        played_.push_back(input);
    }

    const Options& options_;
    const DemoSettings& settings_;
    std::vector<simulation::StepInput> recorded_, played_;
    WalkThrough walk_;
    Times times_;
    std::uint32_t stride_, frames_ = 0, interval_ = 1;
};

Result<std::vector<simulation::StepInput>> recorded_input(const Options& options) {
    std::vector<simulation::StepInput> recorded;
    if (options.input.empty())
        return recorded;
    SUNFLECK_ASSIGN(recorded, simulation::read_recording(options.input));
    if (recorded.empty())
        return Error{"'" + options.input + "' has no steps"};
    return recorded;
}

} // namespace

Status run_headless(const Options& options) {
    if (options.output.empty())
        return Error{"--headless needs a folder for its images: -o DIR"};
    SUNFLECK_ASSIGN(auto recorded, recorded_input(options));
    std::error_code code;
    std::filesystem::create_directories(options.output, code);
    if (code)
        return Error{"cannot create folder '" + options.output + "': " + code.message()};
    const std::filesystem::path statistics_file = std::filesystem::path(options.output) / "stats.json";
    const NamedFile outputs[] = {{"-o", statistics_file}, {"--record", options.record}};
    const NamedFile inputs[] = {{"--input", options.input}, {"--scene", options.scene}};
    SUNFLECK_TRY(try_outputs(outputs, inputs));
    SUNFLECK_ASSIGN(const auto device, gpu::Device::create({options.device, options.validation, {}}));
    DemoSettings settings;
    settings.preset = options.preset.value_or(default_preset(device->traits().software));
    apply_preset(settings);
    settings.transfer = options.transfer.value_or(settings.transfer);
    SUNFLECK_ASSIGN(const auto level, Level::load(*device, source_of(options), settings, 2));
    watch_stop_signals();
    Playback playback(options, settings, std::move(recorded));
    const Status played = playback.run(*level);
    if (!options.record.empty())
        SUNFLECK_TRY(simulation::write_recording(options.record, playback.played()));
    SUNFLECK_TRY(played);
    const auto statistics = statistics_of(*level, options, settings, playback.times(), device->traits().name);
    SUNFLECK_TRY(write_file(statistics_file, statistics.dump(2) + "\n"));
    if (device->validation_messages() > 0)
        return Error{"validation printed messages (see above)"};
    return {};
}

} // namespace sunfleck::demo
