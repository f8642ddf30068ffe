// Playback without a window: recorded input or the built-in walk, rendered frame by frame, with statistics as JSON.
#include "engine/core/caught.h"
#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/core/output.h"
#include "engine/core/stop_signals.h"
#include "engine/simulation/path_movers.h"
#include "engine/statistics/sample_series.h"
#include "engine/statistics/summary.h"
#include "game_demo/game/checkpoint_files.h"
#include "game_demo/game/solution.h"
#include "game_demo/game/world_hashes.h"
#include "game_demo/hitch_log.h"
#include "game_demo/level.h"
#include "game_demo/options.h"
#include "game_demo/presets.h"
#include "game_demo/walk_through.h"
#include "viewer/lost_devices.h"
#include "viewer/preparation.h"
#include "viewer/progress.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sunfleck::demo {
namespace {

using Series = statistics::SampleSeries<double>;

struct Times {
    Series frames;
    std::map<std::string, Series> gpu, cpu;

    void add(const viewer::FrameStatistics& statistics) {
        frames.add(statistics.frame_ms);
        for (const auto& [name, time] : statistics.gpu_ms)
            gpu[name].add(time);
        for (const auto& [name, time] : statistics.cpu_ms)
            cpu[name].add(time);
    }
};

nlohmann::ordered_json medians(const std::map<std::string, Series>& times) {
    nlohmann::ordered_json result = nlohmann::ordered_json::object();
    for (const auto& [name, series] : times)
        result[name] = statistics::median(series.values());
    return result;
}

nlohmann::ordered_json values(const std::map<std::string, Series>& times) {
    nlohmann::ordered_json result = nlohmann::ordered_json::object();
    for (const auto& [name, series] : times)
        result[name] = series.values();
    return result;
}

Status write_numbered(const std::string& folder, std::uint32_t frame, const io::Picture& picture) {
    char name[32];
    std::snprintf(name, sizeof name, "frame_%05u.png", frame);
    return io::write_picture(std::filesystem::path(folder) / name, picture);
}

Error stopped() {
    return Error{"stopped by " + signal_name(stop_signal()), ErrorCode::stopped};
}

// Plays a level from a recording, or else from the built-in walk.
class Playback {
public:
    // `steps`: of the input, recorded or walked.
    Playback(const Options& options, const DemoSettings& settings, const simulation::Recording& recorded,
             std::size_t steps)
        : options_(options), settings_(settings), recorded_(recorded), recording_(options.record),
          stride_(std::max(1u, options.steps_per_frame)) {
        recording_.clear(recorded.start);
        frames_ = options.frames > 0 ? options.frames : std::uint32_t((steps + stride_ - 1) / stride_);
    }

    Status run(Level& level) {
        if (recorded_.steps.empty() && Solution::exists(level.game()))
            solution_ = std::make_unique<Solution>(level.game());
        viewer::Progress progress("playing");
        for (std::uint32_t frame = 0; frame < frames_; ++frame) {
            for (std::uint32_t k = 0; k < stride_; ++k)
                step(level);
            if (level.game().has_sensors())
                times_.cpu["light sensors"].add(level.take_sensor_milliseconds());
            level.adapt(settings_, simulation::step_seconds * double(stride_));
            viewer::FrameRequest request = level.request(settings_, options_.width, options_.height);
            request.milliseconds = 1e3 * simulation::step_seconds * double(level.simulation().steps());
            request.indirect_scale = options_.indirect ? 1.0f : 0.0f;
            SUNFLECK_TRY(frame == 0 ? draw_first(level, request) : level.renderer().render_and_wait(request));
            if (stop_requested())
                return stopped();
            if (frame == 0)
                watch_stop_signals(); // from now on there is something to save
            times_.add(level.renderer().statistics());
            log_hitch(level.renderer().statistics());
            recording_.save_if_due();
            if (wants_picture(frame)) {
                SUNFLECK_ASSIGN(const io::Picture picture, level.renderer().read_back());
                SUNFLECK_TRY(write_numbered(options_.output, frame, picture));
                ++pictures_;
            }
            progress.show(double(frame + 1) / double(frames_),
                          std::to_string(frame + 1) + " of " + std::to_string(frames_) + " frames");
        }
        return {};
    }

    // Writes what is left of the recording.
    Status finish() {
        if (options_.hitches)
            log_information(hitches_.summary());
        return recording_.finish();
    }
    const Times& times() const { return times_; }
    const WorldHashes& hashes() const { return hashes_; }
    std::uint32_t pictures() const { return pictures_; }

private:
    // With all of the light, and refined, so that no picture depends on how many frames came before it.
    static Status draw_first(Level& level, viewer::FrameRequest request) {
        request.progress = viewer::progress_until_stopped("lighting");
        request.refinement_budget = viewer::FrameRequest().refinement_budget;
        viewer::SceneRenderer& renderer = level.renderer();
        do
            SUNFLECK_TRY(renderer.render_and_wait(request));
        while (viewer::light_is_being_refined(renderer) && !stop_requested());
        return {};
    }

    void log_hitch(const viewer::FrameStatistics& statistics) {
        const std::string line = hitches_.add(statistics.frame_ms, statistics);
        if (options_.hitches && !line.empty())
            log_information(line);
    }
    // As many as the options ask for, or every frame if there are fewer: the first frame, the last, and some between.
    bool wants_picture(std::uint32_t frame) const {
        if (options_.pictures == 0 || options_.pictures >= frames_)
            return options_.pictures > 0;
        if (options_.pictures == 1)
            return frame + 1 == frames_;
        const std::uint64_t gaps = options_.pictures - 1, frames = frames_ - 1;
        const std::uint64_t nearest = (2 * frame * gaps + frames) / (2 * frames);
        return frame == (2 * nearest * frames + gaps) / (2 * gaps);
    }

    void step(Level& level) {
        simulation::StepInput input;
        if (solution_)
            input = solution_->next();
        else if (recorded_.steps.empty())
            input = walk_.next(level.simulation());
        else if (played_ < recorded_.steps.size())
            input = recorded_.steps[played_];
        ++played_;
        level.step(input);
        hashes_.add(level.simulation(), level.renderer().registry());
        recording_.add(input);
    }

    const Options& options_;
    const DemoSettings& settings_;
    const simulation::Recording& recorded_;
    std::size_t played_ = 0; // steps
    simulation::RecordingWriter recording_;
    WalkThrough walk_;
    std::unique_ptr<Solution> solution_; // in place of the walk, where there is one
    WorldHashes hashes_;
    Times times_;
    HitchLog hitches_;
    std::uint32_t stride_, frames_ = 0, pictures_ = 0;
};

nlohmann::ordered_json statistics_of(Level& level, const Options& options, const DemoSettings& settings,
                                     const Playback& playback, const std::string& device) {
    const Times& times = playback.times();
    const gi::Report& counters = level.renderer().lighting().counters();
    return {{"device", device},
            {"scene", options.scene},
            {"preset", field_to_text(*DemoSettings::description().find("preset"), &settings)},
            {"frames", times.frames.count()},
            {"steps", level.simulation().steps()},
            {"world_hash", playback.hashes().of_world()},
            {"steps_hash", playback.hashes().of_steps()},
            {"ev100", level.shown_exposure()},
            {"frame_ms",
             {{"median", statistics::median(times.frames.values())},
              {"p95", statistics::percentile(times.frames.values(), 0.95)},
              {"min", statistics::percentile(times.frames.values(), 0.0)},
              {"max", statistics::percentile(times.frames.values(), 1.0)}}},
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

Result<simulation::Recording> recorded_input(const Options& options) {
    simulation::Recording recorded;
    if (options.input.empty())
        return recorded;
    SUNFLECK_ASSIGN(recorded, simulation::read_recording_and_start(options.input));
    if (recorded.steps.empty())
        return Error{"'" + options.input + "' has no steps"};
    return recorded;
}

// Steps of the built-in walk or solution, which depend on the world: it waits for lifts and stops at obstacles.
Result<std::size_t> walk_length(const LevelSource& source) {
    ecs::Registry registry;
    scene::register_components(registry);
    scene::MeshStore meshes;
    scene::TextureStore textures;
    SUNFLECK_TRY(load_world(source, registry, meshes, textures));
    SUNFLECK_ASSIGN(const auto game, GameWorld::create(registry, meshes, &textures, source.sensors));
    const bool solvable = Solution::exists(*game);
    Solution solution(*game);
    WalkThrough walk;
    while (solvable ? !solution.ended() : !walk.finished()) {
        SUNFLECK_TRY(game->step(solvable ? solution.next() : walk.next(game->simulation())));
        if (stop_requested())
            return stopped();
    }
    return std::size_t(game->simulation().steps());
}

void print_result(const Playback& playback, const Options& options) {
    const std::vector<double>& frames = playback.times().frames.values();
    std::printf("%llu frames, %.1f ms in the median, 95 %% within %.1f ms; %u picture%s and stats.json in '%s'\n",
                static_cast<unsigned long long>(playback.times().frames.count()), statistics::median(frames),
                statistics::percentile(frames, 0.95), playback.pictures(), playback.pictures() == 1 ? "" : "s",
                options.output.c_str());
}

// On a device of its own.
Status play(const Options& options, const simulation::Recording& recorded,
            const std::filesystem::path& statistics_file) {
    SUNFLECK_ASSIGN(const auto device, gpu::Device::create({options.device, options.validation, {}}));
    DemoSettings settings;
    settings.preset = options.preset.value_or(default_preset(device->traits().software));
    apply_preset(settings);
    settings.transfer = options.transfer.value_or(settings.transfer);
    SUNFLECK_ASSIGN(const auto level,
                    Level::load(*device, source_of(options), settings, 2, viewer::progress_until_stopped("loading")));
    if (!recorded.start.empty()) {
        SUNFLECK_TRY(load_game(level->game(), identity_of_level(options.scene), recorded.start));
        level->jumped();
    }
    std::size_t steps = recorded.steps.size();
    if (options.frames == 0 && recorded.steps.empty()) {
        SUNFLECK_ASSIGN(steps, walk_length(source_of(options)));
    }
    Playback playback(options, settings, recorded, steps);
    const Status played = caught([&] { return playback.run(*level); });
    SUNFLECK_TRY(playback.finish());
    SUNFLECK_TRY(played);
    auto statistics = statistics_of(*level, options, settings, playback, device->traits().name);
    if (const Times& times = playback.times(); options.each_frame)
        statistics["each_frame"] = {
            {"frame_ms", times.frames.values()}, {"cpu_ms", values(times.cpu)}, {"gpu_ms", values(times.gpu)}};
    SUNFLECK_TRY(
        write_file(statistics_file, statistics.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"));
    if (device->validation_messages() > 0)
        return Error{"validation printed messages (see above)"};
    print_result(playback, options);
    return {};
}

} // namespace

Status run_headless(const Options& options) {
    if (options.output.empty())
        return Error{"--headless needs a folder for its images: -o DIR"};
    SUNFLECK_ASSIGN(const auto recorded, recorded_input(options));
    std::error_code code;
    std::filesystem::create_directories(options.output, code);
    if (code)
        return Error{"cannot create folder '" + options.output + "': " + code.message()};
    const std::filesystem::path statistics_file = std::filesystem::path(options.output) / "stats.json";
    const NamedFile outputs[] = {{"-o", statistics_file}, {"--record", options.record}};
    const NamedFile inputs[] = {{"--input", options.input}, {"--scene", options.scene}};
    SUNFLECK_TRY(try_outputs(outputs, inputs));
    // The same input gives the same world: what a lost device ended is played once more, from the first step.
    return viewer::survive_lost_devices([&] { return play(options, recorded, statistics_file); });
}

} // namespace sunfleck::demo
