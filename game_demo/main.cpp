// The demo's command line.
#include "engine/core/log.h"
#include "game_demo/options.h"
#include "game_demo/presets.h"

#include <CLI/CLI.hpp>
#include <cstdio>

namespace sunfleck {
namespace {

// Options that are parsed as text and then translated.
struct TextOptions {
    std::string size, preset, movers;
    bool no_indirect = false;
};

void add_options(CLI::App& program, demo::Options& options, TextOptions& text) {
    program.footer("Examples: sunfleck_demo\n"
                   "          sunfleck_demo --headless --frames 300 -o out\n"
                   "          sunfleck_demo --headless --input walk.txt --preset high -o out");
    program.add_flag("--headless", options.headless, "Run without a window and write to the folder given by -o");
    program.add_option("--frames", options.frames, "Stop after this many frames (0: at the end of the input)");
    program.add_option("-o,--output", options.output, "Folder for images and stats.json");
    program.add_option("--input", options.input, "Recorded input to replay when headless (default: the built-in walk)");
    program.add_option("--record", options.record, "Record the input to this file");
    program.add_option("--pictures", options.pictures, "Number of images that a headless run writes")
        ->capture_default_str();
    program
        .add_option("--steps-per-frame", options.steps_per_frame,
                    "Simulation steps of 1/60 s per frame of a headless run")
        ->check(CLI::Range(1, 60))
        ->capture_default_str();
    program.add_option("--size", text.size, "Window or image size, WIDTHxHEIGHT; the preset sets the render scale");
    program.add_option("--scene", options.scene, "A built-in scene, or a .scene.json, .gltf or .glb file")
        ->capture_default_str();
    program
        .add_option("--preset", text.preset,
                    "Quality: software, low, medium, high or ultra (default: chosen for the device)")
        ->check(CLI::IsMember({"software", "low", "medium", "high", "ultra"}));
    program
        .add_option("--movers", text.movers,
                    "Lighting of complex moving objects: per_pixel or prt, precomputed (default: set by the preset)")
        ->check(CLI::IsMember(demo::has_transfer() ? std::vector<std::string>{"per_pixel", "prt"}
                                                   : std::vector<std::string>{"per_pixel"}));
    program.add_option("--settings", options.settings_file,
                       "Settings file (default: sunfleck/demo.json in the configuration folder)");
    program.add_flag("--direct-only", text.no_indirect, "Headless: without indirect light");
    program.add_option("--device", options.device, "Vulkan device, by index or part of its name");
    program.add_flag("--validation", options.validation, "Khronos validation layer with synchronization checks");
}

Status translate(const TextOptions& text, demo::Options& options) {
    if (!text.size.empty() &&
        (std::sscanf(text.size.c_str(), "%ux%u", &options.width, &options.height) != 2 || options.width < 1 ||
         options.height < 1 || options.width > 16384 || options.height > 16384))
        return Error{"--size '" + text.size + "': WIDTHxHEIGHT from 1x1 to 16384x16384 is needed"};
    options.indirect = !text.no_indirect;
    if (!text.movers.empty())
        options.transfer = text.movers == "prt";
    const char* names[] = {"software", "low", "medium", "high", "ultra"};
    for (std::uint32_t i = 0; i < 5; ++i)
        if (text.preset == names[i])
            options.preset = demo::Preset(i);
    return {};
}

} // namespace
} // namespace sunfleck

int main(int argc, char** argv) {
    using namespace sunfleck;
    demo::Options options;
    TextOptions text;
    CLI::App program("Lantern House, the Sunfleck demo: a house to walk through. Doors, lamps and a lantern move, and\n"
                     "indirect light follows. Escape pauses; Help in the menu lists the keys.");
    add_options(program, options, text);
    CLI11_PARSE(program, argc, argv);
    if (const Status status = translate(text, options); !status) {
        log_error(status.error().message);
        return 2;
    }
    const Status status = options.headless ? demo::run_headless(options) : demo::run_window(options);
    if (!status)
        log_error(status.error().message);
    return status ? 0 : 1;
}
