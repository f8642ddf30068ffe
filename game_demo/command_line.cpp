// The options of the demo, and the one place of it that includes CLI11.
#include "game_demo/command_line.h"

#include "engine/core/exit_status.h"
#include "game_demo/presets.h"
#include "viewer/exposure.h"
#include "viewer/options.h"

namespace sunfleck::demo {
namespace {

constexpr int most_frames = 10'000'000;

// Options that are parsed as text and then translated.
struct TextOptions {
    viewer::PictureSize size{1280, 720};
    std::string preset, movers, sensors = "all";
    bool no_indirect = false;
};

void add_run_options(CLI::App& program, Options& options) {
    viewer::add_flag(program, "--headless", options.headless,
                     "Run without a window and write to the folder given by -o");
    viewer::add_whole(program, "--frames", options.frames, 0, most_frames,
                      "Stop after this many frames (0: at the end of the input)");
    viewer::add_name(program, "-o,--output", options.output, "Folder for images and stats.json", "FOLDER");
    viewer::add_name(program, "--input", options.input,
                     "Recorded input to replay when headless (default: the built-in walk)", "FILE");
    viewer::add_name(program, "--record", options.record,
                     "Record the input to this file, which is written every second", "FILE");
    viewer::add_name(program, "--state", options.state,
                     "With a window: keeps what the game does in this file, as JSON, for programs that press its keys",
                     "FILE");
    viewer::add_whole(program, "--pictures", options.pictures, 0, most_frames,
                      "Number of images that a headless run writes, evenly spaced from its first frame to its last");
    viewer::add_whole(program, "--steps-per-frame", options.steps_per_frame, 1, 60,
                      "Simulation steps of 1/60 s per frame of a headless run");
    viewer::add_flag(program, "--hitches", options.hitches,
                     "Print which frames take more than twice the median of the 30 before, and why");
    viewer::add_flag(program, "--each-frame", options.each_frame,
                     "Headless: stats.json also has what every frame took, and every pass and stage in it, in ms");
    viewer::add_name(program, "--device", options.device, "Vulkan device, by index or part of its name");
    viewer::add_flag(program, "--validation", options.validation,
                     "Khronos validation layer with synchronization checks");
}

void add_options(CLI::App& program, Options& options, TextOptions& text) {
    program.footer("Examples: sunfleck_demo\n"
                   "          sunfleck_demo --headless --frames 300 -o out\n"
                   "          sunfleck_demo --headless --input walk.txt --preset high -o out\n"
                   "Exit status: 0 done, 1 failed, 2 the command line is wrong, 128 + N ended by signal N.");
    add_run_options(program, options);
    viewer::add_size(program, "--size", text.size, "Window or image size; the preset sets the render scale");
    viewer::add_name(program, "--scene", options.scene, "A built-in scene, or a .scene.json, .gltf or .glb file")
        ->capture_default_str();
    viewer::add_flag(program, "--allow-outside", options.allow_outside,
                     "The scene may read files outside of its folder: for scenes that you trust");
    viewer::add_choice(program, "--preset", text.preset, {"software", "low", "medium", "high", "ultra"},
                       "Quality (default: chosen for the device)");
    viewer::add_choice(program, "--movers", text.movers,
                       has_transfer() ? std::vector<std::string>{"per_pixel", "prt"}
                                      : std::vector<std::string>{"per_pixel"},
                       "Lighting of complex moving objects; prt: precomputed (default: set by the preset)");
    viewer::add_whole(program, "--memory", options.memory_mib, 0, 1 << 30,
                      "Memory that may be taken, in MiB; 0: three quarters of what is free");
    viewer::add_name(program, "--settings", options.settings_file,
                     "Settings file (default: sunfleck/demo.json in the configuration folder)", "FILE");
    viewer::add_real(program, "--ev100", options.ev100, viewer::lowest_exposure, viewer::highest_exposure,
                     "Exposure, in place of the scene's; it stays, wherever one looks");
    viewer::add_name(program, "--screenshots", options.screenshots, "Folder of the pictures that the key P saves",
                     "FOLDER")
        ->default_str("the current folder");
    viewer::add_flag(program, "--simulate", options.simulate,
                     "Headless: steps only, without pictures or a device; plays lantern_game's solution, or --input");
    viewer::add_choice(program, "--sensors", text.sensors, {"all", "direct"}, "The light that light sensors measure");
    viewer::add_whole(program, "--sensor-rays", options.sensors.sensor_rays, 1, most_frames,
                      "Rays that light sensors trace at a step, about");
    viewer::add_flag(program, "--direct-only", text.no_indirect, "Headless: without indirect light");
}

void translate(const TextOptions& text, Options& options) {
    options.width = text.size.width;
    options.height = text.size.height;
    options.indirect = !text.no_indirect;
    options.sensors.sensors = text.sensors == "direct" ? gi::SensedLight::direct : gi::SensedLight::all;
    if (!text.movers.empty())
        options.transfer = text.movers == "prt";
    const char* names[] = {"software", "low", "medium", "high", "ultra"};
    for (std::uint32_t i = 0; i < 5; ++i)
        if (text.preset == names[i])
            options.preset = Preset(i);
}

} // namespace

std::optional<int> read_command_line(int argc, const char* const* argv, Options& options, std::ostream& out,
                                     std::ostream& errors) {
    TextOptions text;
    CLI::App program("Lantern House, the Sunfleck demo: a house to walk through. Doors, lamps and a lantern move, and\n"
                     "indirect light follows. Escape pauses; Help in the menu lists the keys.");
    add_options(program, options, text);
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return program.exit(error, out, errors) == 0 ? exit_done : exit_usage;
    }
    translate(text, options);
    return std::nullopt;
}

} // namespace sunfleck::demo
