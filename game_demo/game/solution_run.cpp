#include "game_demo/game/solution_run.h"

#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/core/stop_signals.h"
#include "engine/io/scene_file.h"
#include "engine/simulation/input_recording.h"
#include "engine/statistics/summary.h"
#include "game_demo/game/saved_game.h"
#include "game_demo/game/solution.h"
#include "game_demo/game/world_hashes.h"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

namespace sunfleck::demo {
namespace {

constexpr std::size_t most_steps = 30 * 3600; // steps: half an hour

struct Run {
    explicit Run(const std::filesystem::path& record) : recording(record) {}
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    std::unique_ptr<GameWorld> world;
    std::size_t played = 0; // steps
    WorldHashes hashes;
    simulation::RecordingWriter recording;
    std::vector<double> milliseconds; // of the sensors, by step
    std::set<std::string> open;
    nlohmann::ordered_json opened = nlohmann::ordered_json::array();
};

void note_open(Run& run) {
    run.registry.view<scene::SensorReading, scene::Name>().each(
        [&](ecs::Entity, const scene::SensorReading& reading, const scene::Name& name) {
            if (!reading.open || !run.open.insert(name.name).second)
                return;
            run.opened.push_back({{"sensor", name.name}, {"step", run.played}, {"share", reading.share}});
            std::printf("step %6zu: '%s' opens\n", run.played, name.name.c_str());
        });
}

Status take_step(Run& run, const simulation::StepInput& input) {
    SUNFLECK_TRY(run.world->step(input));
    ++run.played;
    run.hashes.add(run.world->simulation(), run.registry);
    run.recording.add(input);
    run.recording.save_if_due();
    run.milliseconds.push_back(run.world->sensors().milliseconds());
    note_open(run);
    return stop_requested() ? Status(Error{"stopped by " + signal_name(stop_signal())}) : Status();
}

Status play_all(Run& run, const SolutionRun& options, std::string& problem) {
    if (!options.input.empty()) {
        SUNFLECK_ASSIGN(const auto recorded, simulation::read_recording_and_start(options.input));
        if (recorded.steps.empty())
            return Error{"'" + options.input + "' has no steps"};
        if (!recorded.start.empty())
            SUNFLECK_TRY(load_game(*run.world, options.level, recorded.start));
        run.recording.clear(recorded.start);
        for (const simulation::StepInput& one : recorded.steps)
            SUNFLECK_TRY(take_step(run, one));
        return {};
    }
    Solution solution(*run.world);
    if (!solution.problem().empty())
        return Error{solution.problem() + "; --input FILE plays a recording"};
    while (!solution.ended() && run.played < most_steps)
        SUNFLECK_TRY(take_step(run, solution.next()));
    problem = solution.problem();
    return {};
}

std::string statistics_of(Run& run, const std::string& problem) {
    const nlohmann::ordered_json json = {{"finished", run.world->finished()},
                                         {"problem", problem},
                                         {"steps", run.played},
                                         {"world_hash", run.hashes.of_world()},
                                         {"steps_hash", run.hashes.of_steps()},
                                         {"opened", run.opened},
                                         {"sensors_ms",
                                          {{"median", statistics::median(run.milliseconds)},
                                           {"p95", statistics::percentile(run.milliseconds, 0.95)},
                                           {"max", statistics::percentile(run.milliseconds, 1.0)}}}};
    return json.dump(2) + "\n";
}

} // namespace

Status run_solution(const SolutionRun& options) {
    Run run(options.record);
    io::ImportOptions import;
    import.allow_outside = options.allow_outside;
    scene::register_components(run.registry);
    SUNFLECK_TRY(io::load_scene(options.scene, run.registry, run.meshes, run.textures, import));
    SUNFLECK_ASSIGN(run.world, GameWorld::create(run.registry, run.meshes, &run.textures, options.sensors));
    if (!options.record.empty())
        watch_stop_signals(); // from now on there is something to save
    std::string problem;
    const Status played = play_all(run, options, problem);
    const Status recorded = run.recording.finish(); // whatever ended the game
    SUNFLECK_TRY(played);
    SUNFLECK_TRY(recorded);
    std::error_code code;
    std::filesystem::create_directories(options.output, code);
    SUNFLECK_TRY(write_file(std::filesystem::path(options.output) / "stats.json", statistics_of(run, problem)));
    if (!run.world->finished() && options.input.empty())
        return Error{"the game did not end: " + (problem.empty() ? "it took too long" : problem)};
    return {};
}

} // namespace sunfleck::demo
