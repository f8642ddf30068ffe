// The demo's command line.
#include "engine/core/log.h"
#include "game_demo/options.h"

#include <CLI/CLI.hpp>
#include <cstdio>

int main(int argc, char** argv) {
    using namespace sunfleck;
    demo::Options options;
    std::string size, preset, movers;
    bool no_indirect = false;
    CLI::App program(
        "Lantern House, Sunfleck's demo: a house to walk through, where doors, lamps and a lantern move and\n"
        "bounced light follows. Escape pauses; the help in the menu lists the keys.");
    program.footer("Examples: sunfleck_demo\n"
                   "          sunfleck_demo --headless --frames 300 -o out\n"
                   "          sunfleck_demo --headless --input walk.txt --preset high -o out");
    program.add_flag("--headless", options.headless, "Play without a window into the folder given by -o");
    program.add_option("--frames", options.frames, "Stop after this many frames; 0: at the end of the input");
    program.add_option("-o,--output", options.output, "Folder for pictures and stats.json");
    program.add_option("--input", options.input, "Recorded input to play (headless); otherwise the built-in walk");
    program.add_option("--record", options.record, "Write what was done to this file at the end");
    program.add_option("--pictures", options.pictures, "Pictures that a headless run writes")->capture_default_str();
    program.add_option("--steps-per-frame", options.steps_per_frame, "Steps of 1/60 s between a headless run's frames")
        ->check(CLI::Range(1, 60))
        ->capture_default_str();
    program.add_option("--size", size,
                       "Window or picture size, WIDTHxHEIGHT; the preset says how much of it is rendered");
    program.add_option("--scene", options.scene, "A built-in scene, or a .scene.json, .gltf or .glb file")
        ->capture_default_str();
    program.add_option("--preset", preset, "Quality: software, low, medium, high or ultra (default: by the device)")
        ->check(CLI::IsMember({"software", "low", "medium", "high", "ultra"}));
    program
        .add_option("--movers", movers,
                    "Light of complex things that move: per_pixel, or prt, precomputed (default: by the preset)")
        ->check(CLI::IsMember({"per_pixel", "prt"}));
    program.add_option("--settings", options.settings_file,
                       "Settings file (default: sunfleck/demo.json in the configuration folder)");
    program.add_flag("--direct-only", no_indirect, "Headless: without bounced light");
    program.add_option("--device", options.device, "Vulkan device by number or part of its name");
    program.add_flag("--validation", options.validation, "Khronos validation with synchronisation checks");
    CLI11_PARSE(program, argc, argv);
    if (!size.empty() && (std::sscanf(size.c_str(), "%ux%u", &options.width, &options.height) != 2 ||
                          options.width < 1 || options.height < 1 || options.width > 16384 || options.height > 16384)) {
        log_error("--size '" + size + "': WIDTHxHEIGHT from 1x1 to 16384x16384 is needed");
        return 2;
    }
    options.indirect = !no_indirect;
    if (!movers.empty())
        options.transfer = movers == "prt";
    const char* names[] = {"software", "low", "medium", "high", "ultra"};
    for (std::uint32_t i = 0; i < 5; ++i)
        if (preset == names[i])
            options.preset = demo::Preset(i);
    const Status status = options.headless ? demo::run_headless(options) : demo::run_window(options);
    if (!status)
        log_error(status.error().message);
    return status ? 0 : 1;
}
