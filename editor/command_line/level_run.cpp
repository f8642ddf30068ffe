#include "editor/command_line/level_run.h"

#include "engine/core/hash.h"
#include "engine/core/user_folders.h"
#include "gi_module/technique.h"
#include "viewer/exposure.h"
#include "viewer/picture_settings.h"
#include "viewer/quality.h"

#include <algorithm>
#include <chrono>

namespace sunfleck::command_line {
namespace {

constexpr std::uint32_t most_preparation = 200;      // frames
constexpr const char* recording_extension = ".walk"; // beside the scene

using Clock = std::chrono::steady_clock;

Result<gi::Settings> make_settings(const LevelOptions& options, const std::map<std::string, std::string>& of_scene) {
    const auto presets = viewer::quality_presets();
    const auto preset = std::find_if(presets.begin(), presets.end(),
                                     [&](const viewer::QualityPreset& each) { return options.preset == each.name; });
    if (preset == presets.end())
        return Error{"--preset '" + options.preset + "': software, low, medium, high or ultra is needed"};
    gi::Settings settings = viewer::quality_settings(viewer::Quality(preset - presets.begin()), *preset);
    for (const auto& [name, value] : of_scene)
        SUNFLECK_TRY(settings.set(name, value));
    for (const std::string& assignment : options.settings)
        SUNFLECK_TRY(apply_setting(settings, assignment));
    SUNFLECK_TRY(settings.validate());
    return settings;
}

// The walk that a level is played with: the one that is named, or the scene's own, beside it.
Result<std::filesystem::path> walk_of(const LevelOptions& options) {
    SUNFLECK_ASSIGN(const std::filesystem::path scene, find_scene(options.scene));
    if (!options.input.empty())
        return std::filesystem::path(options.input);
    std::string name = scene.filename().string();
    name = name.substr(0, name.find('.')) + recording_extension;
    std::error_code code;
    if (std::filesystem::path file = scene.parent_path() / name; std::filesystem::exists(file, code))
        return file;
    return Error{"scene '" + options.scene + "' has no recorded walk: --input FILE is needed"};
}

Result<std::vector<simulation::StepInput>> read_walk(const LevelOptions& options, const std::filesystem::path& file) {
    SUNFLECK_ASSIGN(std::vector<simulation::StepInput> steps, simulation::read_recording(file));
    if (steps.size() < options.steps_per_frame)
        return Error{"'" + file.string() + "' has no whole frame of " + std::to_string(options.steps_per_frame) +
                     " steps"};
    return steps;
}

} // namespace

Status check_level(const LevelOptions& options) {
    SUNFLECK_TRY(viewer::size_value(options.size));
    SUNFLECK_TRY(make_settings(options, {}));
    SUNFLECK_ASSIGN(const std::filesystem::path walk, walk_of(options));
    SUNFLECK_TRY(read_walk(options, walk));
    return {};
}

Result<std::unique_ptr<LevelRun>> LevelRun::create(const LevelOptions& options) {
    std::unique_ptr<LevelRun> run(new LevelRun());
    run->stride_ = options.steps_per_frame;
    SUNFLECK_ASSIGN(run->size_, viewer::size_value(options.size));
    SUNFLECK_TRY(make_settings(options, {})); // what is wrong on the command line, before anything is loaded
    SUNFLECK_TRY(run->read_input(options));
    SUNFLECK_TRY(run->load(options));
    SUNFLECK_TRY(run->prepare());
    return run;
}

Status LevelRun::read_input(const LevelOptions& options) {
    SUNFLECK_ASSIGN(const std::filesystem::path file, walk_of(options));
    SUNFLECK_ASSIGN(input_, read_walk(options, file));
    if (!options.serve && frames() <= options.warmup)
        return Error{"the recording has " + std::to_string(frames()) + " frames; all of them are warm-up"};
    std::uint64_t hash = hash_start;
    for (const simulation::StepInput& step : input_)
        hash = hash_bytes(hash, &step, sizeof step);
    recording_ = options.scene + ", " + file.filename().string() + " " + hash_text(hash);
    return {};
}

Status LevelRun::load(const LevelOptions& options) {
    SUNFLECK_ASSIGN(const std::filesystem::path path, find_scene(options.scene));
    SUNFLECK_ASSIGN(device_, gpu::Device::create({options.device, false, {}}));
    SUNFLECK_ASSIGN(renderer_, viewer::SceneRenderer::create(*device_));
    renderer_->lighting().set_cache_folder(user_cache_folder());
    SUNFLECK_ASSIGN(const io::ImportReport report, renderer_->load(path, import_options({})));
    SUNFLECK_ASSIGN(settings_, make_settings(options, report.settings));
    SUNFLECK_TRY(renderer_->lighting().set_settings(settings_));
    simulation_ = std::make_unique<simulation::Simulation>(renderer_->registry(), renderer_->meshes());
    request_.width = size_.width;
    request_.height = size_.height;
    request_.simulate = false;
    const viewer::PictureSettings picture; // as the demo draws it
    request_.antialiasing = picture.antialiasing;
    request_.glare = picture.glare;
    request_.camera.vertical_field_of_view = glm::radians(viewer::usual_field_of_view);
    request_.ev100 = viewer::scene_exposure(renderer_->registry()).value_or(viewer::default_exposure);
    return {};
}

Status LevelRun::render() {
    const simulation::Character& player = simulation_->player();
    request_.camera.position = player.eye();
    request_.camera.target = player.eye() + player.forward();
    request_.step = simulation_->steps();
    return renderer_->render_and_wait(request_);
}

// Until every shadow map is drawn and all baked light is there: no frame of the walk is charged with loading.
Status LevelRun::prepare() {
    Progress progress("loading");
    for (std::uint32_t i = 0; i < most_preparation; ++i) {
        SUNFLECK_TRY(render());
        if (interrupted())
            return Error{"interrupted; nothing was written"};
        if (counters()["shadow_maps_stale"] == 0.0 && counters()["baked_light_waiting"] == 0.0 &&
            counters()["refined_light_waiting"] == 0.0)
            return {};
    }
    return {};
}

gate::Hello LevelRun::hello() const {
    gate::Hello hello{device_->traits().name, device_->traits().driver, recording_, {}, frames(), true, {}};
    hello.size = std::to_string(size_.width) + "x" + std::to_string(size_.height);
    for (const gi::Settings::ConstPart& part : settings_.parts())
        for (const Field& field : part.type->fields)
            hello.settings[std::string(field.name)] = field_to_text(field, part.values);
    hello.settings["steps_per_frame"] = std::to_string(stride_);
    return hello;
}

std::uint32_t LevelRun::frames() const {
    return std::uint32_t(input_.size() / stride_);
}

std::uint32_t LevelRun::next_frame() const {
    return std::uint32_t(simulation_->steps() / stride_);
}

void LevelRun::step() {
    for (std::uint32_t i = 0; i < stride_; ++i)
        simulation_->step(renderer_->registry(), input_[simulation_->steps()]);
}

Status LevelRun::go_to(std::uint32_t frame) {
    if (frame < next_frame())
        return Error{"frame " + std::to_string(frame) + " was asked for after frame " + std::to_string(next_frame()) +
                     ": frames must rise"};
    if (frame >= frames())
        return Error{"frame " + std::to_string(frame) + " was asked for; the recording has " +
                     std::to_string(frames())};
    while (next_frame() < frame)
        step();
    return {};
}

Status LevelRun::draw(std::vector<gate::Frame>& frames) {
    gate::Frame frame;
    frame.number = next_frame();
    SUNFLECK_TRY(go_to(frame.number)); // that there is one more
    const auto start = Clock::now();
    step();
    const double simulation_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    SUNFLECK_TRY(render());
    const viewer::FrameStatistics& statistics = renderer_->statistics();
    frame.frame_ms = statistics.frame_ms + simulation_ms;
    frame.passes = statistics.gpu_ms;
    frame.stages = statistics.cpu_ms;
    frame.stages["simulation"] += simulation_ms;
    for (const gi::Counter* counter : gi::all_counters()) {
        if (counter->group == gi::memory_group)
            continue;
        const std::string name(counter->name);
        if (!counter->from_gpu)
            frame.counters[name] = counters()[counter->name];
        else if (!frames.empty())
            frames.back().counters[name] = counters()[counter->name];
    }
    frames.push_back(std::move(frame));
    return {};
}

Status LevelRun::finish(std::vector<gate::Frame>& frames) {
    SUNFLECK_TRY(render());
    for (const gi::Counter* counter : gi::all_counters())
        if (counter->from_gpu && !frames.empty())
            frames.back().counters[std::string(counter->name)] = counters()[counter->name];
    return {};
}

Status LevelRun::write_picture(const std::string& file) {
    SUNFLECK_ASSIGN(const io::Picture picture, renderer_->read_back());
    return io::write_picture(file, picture);
}

} // namespace sunfleck::command_line
