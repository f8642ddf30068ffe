// The options of each command, and the one place that includes CLI11.
#include "editor/command_line/program.h"

#include "editor/command_line/commands.h"
#include "editor/command_line/gate_commands.h"
#include "gi_module/settings_reference.h"

#include <CLI/CLI.hpp>

namespace sunfleck::command_line {
namespace {

// A command is added to the program and, when chosen, run; it returns the exit status.
struct Command {
    CLI::App* app;
    std::function<int()> run;
};

// Lighting settings as options: --direct-share is the setting direct_share. Text, range and default are the setting's.
void add_setting_options(CLI::App& app, std::map<std::string, std::string>& given,
                         std::initializer_list<const char*> settings) {
    const gi::Settings defaults;
    for (const char* setting : settings) {
        std::string option = std::string("--") + setting;
        std::replace(option.begin(), option.end(), '_', '-');
        const Field& field = *gi::Settings::find(setting);
        app.add_option_function<std::string>(
               option, [&given, setting](const std::string& text) { given[setting] = text; },
               std::string(field.tooltip))
            ->type_name(allowed_values(field))
            ->default_str(defaults.get(setting))
            ->check([setting](const std::string& text) {
                const Status status = gi::Settings().set(setting, text);
                return status ? std::string() : status.error().message;
            });
    }
}

// Options that name a scene, a camera and a time, on `render` and `reference` alike.
void add_scene_options(CLI::App& app, SceneOptions& options) {
    app.add_option("SCENE", options.scene, "A .gltf, .glb or .scene.json file, or the name of a built-in scene")
        ->required();
    app.add_option("--size", options.size, "Picture size, WIDTHxHEIGHT")->capture_default_str();
    app.add_option("--camera", options.camera, "Camera by name, number, or px,py,pz,tx,ty,tz,fov (degrees)");
    add_setting_options(app, options.lighting, {"movers"});
    app.add_option_function<std::string>(
           "--motion", [&options](const std::string& text) { options.motion = text == "on"; },
           "on: frame k shows step k; off: movers stay at step 0 (default on)")
        ->check(CLI::IsMember({"on", "off"}));
    app.add_option("--orbit", options.orbit_degrees, "Degrees that the camera turns about its target each frame")
        ->check(CLI::Range(-360.0, 360.0))
        ->capture_default_str();
    app.add_option("--frames", options.frames, "Frames to render after the warm-up; the last is written")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    app.add_option("--warmup", options.warmup, "Frames before those")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
    add_setting_options(app, options.lighting, {"seed", "bounces"});
    app.add_option("--ev100", options.ev100, "EV100, in place of the scene's; where neither is, the picture decides")
        ->check(CLI::Range(viewer::lowest_exposure, viewer::highest_exposure));
    app.add_option("--environment", options.environment,
                   "Light the scene by this picture of its surroundings (equirectangular EXR, HDR, PNG or JPEG)");
    app.add_option("--scene", options.import.scene, "Which scene of a glTF file, by number (default: the file's own)");
    app.add_option("--variant", options.import.variant, "Material variant of a glTF file, by name");
    app.add_option("--animation", options.import.animation, "Which animation of a glTF file plays; -1: none")
        ->capture_default_str();
    app.add_option("--device", options.device, "Vulkan device by number or part of its name");
    app.add_flag("--validation", options.validation, "Khronos validation with synchronisation checks");
}

Command make_render_command(CLI::App& program) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* app = program.add_subcommand("render", "Renders a scene and writes the last frame as PNG or EXR");
    app->footer("Example: sunfleck render four_pillars -o out.png --lights 300 --camera bench_1 --stats out.json\n"
                "A scene in which nothing emits light is lit by a sky of 0.3 W/(sr m2) and a sun of 2 W/m2.");
    add_scene_options(*app, options->scene);
    app->add_option("-o,--output", options->output, "Picture to write: .png (tone-mapped) or .exr (scene-linear)")
        ->required();
    add_setting_options(*app, options->scene.lighting,
                        {"punctual", "direct", "indirect", "specular", "source", "lights", "direct_share"});
    app->add_option("--view", options->view, "What to show")->check(CLI::IsMember(view_names()))->capture_default_str();
    app->add_option("--set", options->settings, "Lighting setting as name=value; repeatable (see sunfleck info)");
    app->add_option("--stats", options->statistics, "Write times, counters and memory as JSON");
    app->add_option("--trace", options->trace,
                    "Write the measured frames as a Chrome trace, for chrome://tracing or ui.perfetto.dev");
    app->add_flag("--print-graph", options->print_graph, "Print the last frame's graph");
    return {app, [options] {
                watch_interrupts();
                return exit_status(render(*options));
            }};
}

Command make_reference_command(CLI::App& program) {
    auto options = std::make_shared<ReferenceOptions>();
    CLI::App* app = program.add_subcommand("reference", "Renders a scene with the path tracer: the truth, slowly");
    app->footer("Example: sunfleck reference cornell -o cornell.exr --spp 1024 --view irradiance\n"
                "Ctrl-C saves what is there; the same command goes on from it.");
    add_scene_options(*app, options->scene);
    app->add_option("-o,--output", options->output, "Picture to write: .exr (scene-linear) or .png (tone-mapped)")
        ->required();
    app->add_option("--spp", options->samples, "Samples per pixel")
        ->check(CLI::Range(1, 1 << 24))
        ->capture_default_str();
    app->add_option("--view", options->view, "What to show")
        ->check(CLI::IsMember({"final", "irradiance", "direct", "indirect"}))
        ->capture_default_str();
    app->add_flag("--antialiasing", options->antialiasing, "Spread samples over the pixel (default: its centre)");
    app->add_flag("--unlimited", options->unlimited, "No limit of bounces");
    app->add_flag("--lambertian", options->lambertian,
                  "Only the materials' base colours: no metal, gloss, glass, normal maps or patterns");
    app->add_option("--stats", options->statistics, "Write seconds and rays per second as JSON");
    return {app, [options] {
                watch_interrupts();
                return exit_status(reference(*options));
            }};
}

Command make_compare_command(CLI::App& program) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* app = program.add_subcommand("compare", "Compares picture A with the reference B of the same size");
    app->footer("Example: sunfleck compare render.exr reference.exr --json --diff difference.png\n"
                "EXR is compared scene-linear, PNG as display values. Pixels with alpha 0 in either are left out.\n"
                "relative_mse: mean of |A-B|^2 / (|B|^2 + 0.01 m^2), m the mean of |B|. ssim and flip of EXR pictures\n"
                "are taken after x / (x + m). psnr is 999 for equal pictures.");
    app->add_option("A", options->a, "Picture to judge")->required();
    app->add_option("B", options->b, "Reference")->required();
    app->add_option("--diff", options->difference, "Write the absolute difference, amplified, as .png");
    app->add_flag("--json", options->as_json, "Print one JSON object");
    return {app, [options] { return exit_status(compare(*options)); }};
}

Command make_bench_command(CLI::App& program) {
    auto options = std::make_shared<BenchOptions>();
    CLI::App* app = program.add_subcommand("bench", "Runs a named experiment and prints its table");
    app->footer("Example: sunfleck bench kernel --repeat 9 --csv kernel.csv\n"
                "kernel       ns per light and pixel of every kernel shape, shadowed and not\n"
                "brute_force  frame and pass times for 64, 300 and 1,024 samples at 640x360 and 1024x768\n"
                "shadow_maps  microseconds per map and per thousand vertices\n"
                "convergence  error against the path tracer over the number of samples (--plot)\n"
                "reference    rays per second of the path tracer\n"
                "thesis       frame times, ablation, map updates, passes and quality, as the thesis's chapter 5\n"
                "             (--part movers runs one of its experiments)");
    const auto run_gate = add_gate_commands(*app);
    app->add_option("SUITE", options->suite, "Name of the experiment")
        ->check(CLI::IsMember({"kernel", "brute_force", "shadow_maps", "convergence", "reference", "thesis"}));
    app->add_flag("--json", options->as_json, "Print one JSON object");
    app->add_option("--csv", options->csv, "Write the rows as CSV");
    app->add_option("--plot", options->plot, "Write a plot as SVG");
    app->add_option("--repeat", options->repeat, "Measurements of each row")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app->add_option("--scene", options->scene, "Scene, where the suite takes one");
    app->add_option("--part", options->part, "One experiment of the thesis")->check(CLI::IsMember(thesis_parts()));
    app->add_option("--device", options->device, "Vulkan device by number or part of its name");
    return {app, [options, run_gate] {
                if (int gate_status = 0; run_gate(gate_status))
                    return gate_status;
                if (options->suite.empty())
                    return fail({"a SUITE, 'level' or 'compare' is needed (sunfleck bench --help)"});
                watch_interrupts();
                return exit_status(bench(*options));
            }};
}

Command make_info_command(CLI::App& program) {
    auto device = std::make_shared<std::string>();
    auto scene = std::make_shared<std::string>();
    auto as_json = std::make_shared<bool>(false), schema = std::make_shared<bool>(false);
    auto reference = std::make_shared<bool>(false);
    CLI::App* app = program.add_subcommand("info", "Shows device, driver, limits, scenes and settings");
    app->footer("Example: sunfleck info --json\nExample: sunfleck info helmet.gltf");
    app->add_option("SCENE", *scene, "Show what is in this scene or glTF file instead");
    app->add_option("--device", *device, "Vulkan device by number or part of its name");
    app->add_flag("--json", *as_json, "Print one JSON object");
    app->add_flag("--schema", *schema, "Print the JSON schema of scene files");
    app->add_flag("--reference", *reference, "Print all settings, counters and views as Markdown (docs/settings.md)");
    return {app, [device, scene, as_json, schema, reference] {
                if (*schema || *reference) {
                    std::fputs((*schema ? io::scene_file_schema() : gi::settings_reference()).c_str(), stdout);
                    return 0;
                }
                return exit_status(scene->empty() ? describe_device(*device, *as_json)
                                                  : describe_scene(*scene, *as_json));
            }};
}

} // namespace

int run_program(int argc, const char* const* argv) {
    CLI::App program("Sunfleck: real-time global illumination with hundreds of shadowed light samples.");
    program.require_subcommand(1);
    program.set_version_flag("--version", "sunfleck 0.1.0");
    program.footer("Example: sunfleck render cornell -o cornell.png --lights 300");
    const Command commands[] = {make_render_command(program), make_reference_command(program),
                                make_compare_command(program), make_bench_command(program), make_info_command(program)};
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const int status = program.exit(error);
        return status == 0 ? 0 : 2;
    }
    for (const Command& command : commands)
        if (command.app->parsed())
            return command.run();
    return 2;
}

} // namespace sunfleck::command_line
