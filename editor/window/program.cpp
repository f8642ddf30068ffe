#include "editor/window/program.h"

#include "editor/window/editor.h"
#include "engine/core/exit_status.h"
#include "engine/core/memory_limit.h"
#include "engine/core/output.h"
#include "engine/core/program_end.h"
#include "viewer/options.h"

#include <iostream>

namespace sunfleck::editor {
namespace {

void add_options(CLI::App& program, Options& options, viewer::PictureSize& size) {
    program.footer("Examples: sunfleck_editor\n"
                   "          sunfleck_editor cornell\n"
                   "          sunfleck_editor room.glb --size 1920x1080\n"
                   "Exit status: 0 done, 1 failed, 2 the command line is wrong, 128 + N ended by signal N.");
    viewer::add_name(program, "SCENE", options.scene, "A built-in scene, or a .scene.json, .gltf or .glb file");
    viewer::add_size(program, "--size", size, "Size of the window");
    viewer::add_real(program, "--scale", options.scale, 0.0, 4.0, "Size of text; 0: as the screen asks for");
    viewer::add_name(program, "--device", options.device, "Vulkan device, by index or part of its name");
    viewer::add_whole(program, "--memory", options.memory_mib, 0, 1 << 30,
                      "Memory that may be taken, in MiB; 0: three quarters of what is free");
    viewer::add_flag(program, "--allow-outside", options.allow_outside,
                     "Scenes may read files outside of their folders: for scenes that you trust");
    viewer::add_flag(program, "--validation", options.validation,
                     "Khronos validation layer with synchronization checks");
    viewer::add_name(program, "--shaders", options.shaders,
                     "The project's folder: shaders whose sources change are compiled and used at once", "FOLDER")
        ->check(CLI::ExistingDirectory);
    viewer::add_name(program, "--settings", options.state_file,
                     "Layout, recent files and keys (default: sunfleck/editor.json in the configuration folder)",
                     "FILE");
    viewer::add_name(program, "--widgets", options.widgets,
                     "For scripts: name, place and value of every visible widget, and where the pointer is, as JSON, "
                     "written when all input has been shown",
                     "FILE");
    viewer::add_name(
        program, "--report", options.report,
        "For scripts: frames and their times, edits, messages and uses of commands as JSON, written at the end "
        "(editor/README.md has the fields)",
        "FILE");
}

} // namespace

std::optional<int> read_command_line(int argc, const char* const* argv, Options& options, std::ostream& out,
                                     std::ostream& errors) {
    viewer::PictureSize size{options.width, options.height};
    CLI::App program("The Sunfleck editor: opens a level, lights it, and shows what each choice costs.");
    add_options(program, options, size);
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return program.exit(error, out, errors) == 0 ? exit_done : exit_usage;
    }
    options.width = size.width;
    options.height = size.height;
    return std::nullopt;
}

int run_program(int argc, char** argv) {
    hold_standard_streams();
    Options options;
    if (const std::optional<int> status = read_command_line(argc, argv, options, std::cout, std::cerr))
        return printed(*status);
    set_memory_limit(std::uint64_t(options.memory_mib) << 20);
    return run_to_end([&] { return run(options); });
}

} // namespace sunfleck::editor
