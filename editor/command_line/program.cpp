// The options of each command, and the one place that includes CLI11.
#include "editor/command_line/program.h"

#include "editor/command_line/commands.h"
#include "editor/command_line/gate_commands.h"
#include "engine/core/caught.h"
#include "engine/core/memory_limit.h"
#include "engine/core/program_end.h"
#include "engine/core/stop_signals.h"
#include "gi_module/settings_reference.h"

#include "viewer/options.h"

#include <iostream>
#include <sstream>

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

// How light becomes a picture, likewise.
void add_picture_options(CLI::App& app, viewer::PictureSettings& given) {
    for (const Field& field : viewer::PictureSettings::description().fields) {
        std::string option = std::string("--") + std::string(field.name);
        std::replace(option.begin(), option.end(), '_', '-');
        app.add_option_function<std::string>(
               option,
               [&given, &field](const std::string& text) { static_cast<void>(field_from_text(field, &given, text)); },
               std::string(field.tooltip))
            ->type_name(allowed_values(field))
            ->default_str(field_to_text(field, &given))
            ->check([&field](const std::string& text) {
                viewer::PictureSettings tried;
                const Status status = field_from_text(field, &tried, text);
                return status ? std::string() : status.error().message;
            });
    }
}

constexpr int most_parts = 1'000'000; // scenes or animations of a file

// Output pictures are known by their extension.
std::string picture_problem(const std::string& text) {
    const auto kind = io::picture_kind(text);
    return kind ? std::string() : kind.error().message;
}

// Options that name a scene, a camera and a time, on `render` and `reference` alike.
void add_scene_options(CLI::App& app, SceneOptions& options) {
    viewer::add_name(app, "SCENE", options.scene, "A .gltf, .glb or .scene.json file, or the name of a built-in scene")
        ->required();
    viewer::add_size(app, "--size", options.size, "Picture size");
    viewer::add_name(app, "--camera", options.camera, "Camera by name, number, or px,py,pz,tx,ty,tz,fov (m; degrees)");
    add_setting_options(app, options.lighting, {"movers"});
    app.add_option_function<std::string>(
           "--motion", [&options](const std::string& text) { options.motion = text == "on"; },
           "on: frame k shows step k; off: movers stay at step 0 (default on)")
        ->type_name("on | off")
        ->check([](const std::string& text) {
            return text == "on" || text == "off" ? std::string() : "'" + text + "' is neither on nor off";
        });
    viewer::add_real(app, "--orbit", options.orbit_degrees, -360.0, 360.0,
                     "Degrees that the camera turns about its target each frame");
    viewer::add_whole(app, "--frames", options.frames, 1, 1000000,
                      "Frames to render after the warm-up; the last is written");
    viewer::add_whole(app, "--warmup", options.warmup, 0, 1000000, "Frames before those");
    add_setting_options(app, options.lighting, {"seed", "bounces"});
    viewer::add_real(app, "--ev100", options.ev100, viewer::lowest_exposure, viewer::highest_exposure,
                     "EV100, in place of the scene's; where neither is, the picture decides");
    viewer::add_name(app, "--environment", options.environment,
                     "Light the scene by this picture of its surroundings (equirectangular EXR, HDR, PNG or JPEG)",
                     "FILE");
    viewer::add_whole(app, "--scene", options.import.scene, -1, most_parts,
                      "Which scene of a glTF file, by number; -1: the file's own choice");
    viewer::add_name(app, "--variant", options.import.variant, "Material variant of a glTF file, by name");
    viewer::add_whole(app, "--animation", options.import.animation, -1, most_parts,
                      "Which animation of a glTF file plays; -1: none");
    viewer::add_flag(app, "--allow-outside", options.import.allow_outside,
                     "The scene may read files outside of its folder: for scenes that you trust");
    viewer::add_whole(app, "--memory", options.memory_mib, 0, 1 << 30,
                      "Memory that may be taken, in MiB; 0: three quarters of what is free");
    viewer::add_name(app, "--device", options.device, "Vulkan device by number or part of its name");
    viewer::add_flag(app, "--validation", options.validation, "Khronos validation with synchronisation checks");
}

Command make_render_command(CLI::App& program) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* app = program.add_subcommand("render", "Renders a scene and writes the last frame as PNG or EXR");
    app->footer("Example: sunfleck render four_pillars -o out.png --lights 300 --camera bench_1 --stats out.json\n"
                "A scene in which nothing emits light is lit by a sky of 0.3 W/(sr m2) and a sun of 2 W/m2.");
    add_scene_options(*app, options->scene);
    app->add_option("-o,--output", options->output, "Picture to write: .png (tone-mapped) or .exr (scene-linear)")
        ->type_name("FILE")
        ->check(picture_problem)
        ->required();
    add_setting_options(*app, options->scene.lighting,
                        {"punctual", "direct", "indirect", "specular", "source", "lights", "direct_share"});
    viewer::add_choice(*app, "--view", options->view, view_names(), "What to show")->capture_default_str();
    add_picture_options(*app, options->picture);
    app->add_option("--set", options->settings, "Lighting setting; repeatable (see sunfleck info)")
        ->type_name("NAME=VALUE")
        ->check(setting_problem);
    viewer::add_name(*app, "--stats", options->statistics, "Write times, counters and memory as JSON", "FILE");
    viewer::add_name(*app, "--trace", options->trace,
                     "Write the measured frames as a Chrome trace, for chrome://tracing or ui.perfetto.dev", "FILE");
    viewer::add_flag(*app, "--print-graph", options->print_graph, "Print the last frame's graph");
    return {app, [options] {
                end_at_interrupts();
                return exit_status(render(*options));
            }};
}

void add_light_paths(CLI::App& app, ReferenceOptions& options) {
    viewer::add_flag(app, "--light-paths", options.light_paths,
                     "Trace particles from the emitters and connect them with the camera (light tracing): finds the "
                     "light of point, spot and directional lights through smooth glass, which paths from the camera "
                     "cannot, but not what is seen through glass. Pixels show the mean over their area")
        ->excludes("--caustics");
}

Command make_reference_command(CLI::App& program) {
    auto options = std::make_shared<ReferenceOptions>();
    CLI::App* app = program.add_subcommand("reference", "Renders a scene with the path tracer: the truth, slowly");
    app->footer(
        "Example: sunfleck reference cornell -o cornell.exr --spp 1024 --view irradiance\n"
        "Example: sunfleck reference glass -o caustic.exr --spp 1024 --view irradiance --light-paths\n"
        "Whatever ends it, the same command goes on from what was saved last: beside the picture there are two\n"
        "files, NAME.state and NAME.state2, until it is done. Ctrl-C and other signals save first.");
    add_scene_options(*app, options->scene);
    app->add_option("-o,--output", options->output, "Picture to write: .exr (scene-linear) or .png (tone-mapped)")
        ->type_name("FILE")
        ->check(picture_problem)
        ->required();
    viewer::add_whole(*app, "--spp", options->samples, 1, 1 << 24, "Samples per pixel");
    viewer::add_choice(*app, "--view", options->view, {"final", "irradiance", "direct", "indirect"}, "What to show")
        ->capture_default_str();
    viewer::add_flag(*app, "--antialiasing", options->antialiasing,
                     "Spread samples over the pixel (default: its centre)");
    viewer::add_flag(*app, "--unlimited", options->unlimited, "No limit of bounces");
    app->add_option_function<std::string>(
           "--caustics", [options](const std::string& text) { options->caustics = text == "on"; },
           "off: light that reaches a surface by way of gloss or glass is left out where a diffuse surface was before "
           "on the path from the eye: it is what makes fireflies, and no light sample carries it (default on)")
        ->type_name("on | off")
        ->check(CLI::IsMember({"on", "off"}));
    add_light_paths(*app, *options);
    viewer::add_flag(*app, "--lambertian", options->lambertian,
                     "Only the materials' base colours: no metal, gloss, glass, normal maps or patterns");
    viewer::add_name(*app, "--stats", options->statistics, "Write seconds and rays per second as JSON", "FILE");
    viewer::add_real(*app, "--save-interval", options->save_interval, 0.05, 86400.0,
                     "Seconds between saves of what is there so far; more where they would take over 2 % of the time");
    return {app, [options] {
                end_at_interrupts();
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
    viewer::add_name(*app, "A", options->a, "Picture to judge", "FILE")->required();
    viewer::add_name(*app, "B", options->b, "Reference", "FILE")->required();
    app->add_option("--diff", options->difference, "Write the absolute difference, amplified, as .png")
        ->type_name("FILE")
        ->check(picture_problem);
    viewer::add_flag(*app, "--json", options->as_json, "Print one JSON object");
    return {app, [options] { return exit_status(compare(*options)); }};
}

// Parts of all suites that have some.
std::vector<std::string> all_parts() {
    std::vector<std::string> parts = thesis_parts();
    for (const std::vector<std::string>& others : {picture_parts(), splatting_parts()})
        for (const std::string& part : others)
            if (std::find(parts.begin(), parts.end(), part) == parts.end())
                parts.push_back(part);
    return parts;
}

Command make_bench_command(CLI::App& program) {
    auto options = std::make_shared<BenchOptions>();
    CLI::App* app = program.add_subcommand("bench", "Runs a named experiment and prints its table");
    app->footer("Example: sunfleck bench kernel --repeat 9 --csv kernel.csv\n"
                "kernel       ns per light and pixel of every kernel shape, shadowed and not\n"
                "brute_force  frame and pass times for 64, 300 and 1,024 samples at 640x360 and 1024x768\n"
                "shadow_maps  microseconds per map and per thousand vertices\n"
                "convergence  error against the path tracer over the number of samples (--plot)\n"
                "picture      edges, stains and crawl of the quality presets' pictures against brute force with 1,024\n"
                "             samples at four times the size, and P, their FLIP against the path tracer; about two\n"
                "             minutes a view (--views 4 --part software --folder kept)\n"
                "reference    rays per second of the path tracer\n"
                "thesis       frame times, ablation, map updates, passes and quality, as the thesis's chapter 5\n"
                "             (--part movers runs one of its experiments)\n"
                "splatting    errors, flicker and cost of splatted indirect light, the paper's figures beside ours");
    const auto run_gate = add_gate_commands(*app);
    viewer::add_choice(
        *app, "SUITE", options->suite,
        {"kernel", "brute_force", "shadow_maps", "convergence", "picture", "reference", "thesis", "splatting"},
        "Name of the experiment");
    viewer::add_flag(*app, "--json", options->as_json, "Print one JSON object");
    viewer::add_name(*app, "--csv", options->csv, "Write the rows as CSV", "FILE");
    viewer::add_name(*app, "--plot", options->plot, "Write a plot as SVG", "FILE");
    viewer::add_whole(*app, "--repeat", options->repeat, 1, 1000, "Measurements of each row");
    viewer::add_whole(*app, "--turns", options->turns, 1, 1000, "Turns of those whose ratios are taken (thesis)");
    viewer::add_name(*app, "--scene", options->scene,
                     "Scene, where the suite takes one (kernel, convergence, picture, thesis)");
    viewer::add_choice(*app, "--part", options->part, all_parts(),
                       "One experiment of the suite (thesis, splatting), or one preset of the suite picture");
    viewer::add_whole(*app, "--views", options->views, 1, 8, "Of the suite picture: how many views are measured");
    viewer::add_whole(*app, "--spp", options->samples, 1, 1 << 20,
                      "Of the suite picture: samples per pixel of the path tracer");
    viewer::add_name(*app, "--folder", options->folder,
                     "Of the suite picture: keeps there what is finished, and goes on with what is not", "FOLDER");
    viewer::add_name(*app, "--device", options->device, "Vulkan device by number or part of its name");
    viewer::add_whole(*app, "--memory", options->memory_mib, 0, 1 << 30,
                      "Memory that may be taken, in MiB; 0: three quarters of what is free");
    return {app, [options, run_gate] {
                set_memory_limit(std::uint64_t(options->memory_mib) << 20);
                if (int gate_status = 0; run_gate(gate_status))
                    return gate_status;
                if (options->suite.empty()) {
                    fail({"a SUITE, 'level' or 'compare' is needed (sunfleck bench --help)"});
                    return int(exit_usage);
                }
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
    auto allow_outside = std::make_shared<bool>(false);
    viewer::add_name(*app, "SCENE", *scene, "Show what is in this scene or glTF file instead");
    viewer::add_flag(*app, "--allow-outside", *allow_outside, "The scene may read files outside of its folder");
    viewer::add_name(*app, "--device", *device, "Vulkan device by number or part of its name");
    viewer::add_flag(*app, "--json", *as_json, "Print one JSON object");
    viewer::add_flag(*app, "--schema", *schema, "Print the JSON schema of scene files");
    viewer::add_flag(*app, "--reference", *reference,
                     "Print all settings, counters and views as Markdown (docs/settings.md)");
    return {app, [device, scene, allow_outside, as_json, schema, reference] {
                if (*schema || *reference) {
                    std::fputs((*schema ? io::scene_file_schema() : gi::settings_reference()).c_str(), stdout);
                    return 0;
                }
                return exit_status(scene->empty() ? describe_device(*device, *as_json)
                                                  : describe_scene(*scene, *allow_outside, *as_json));
            }};
}

class Program {
public:
    Program() {
        app_.require_subcommand(1);
        app_.set_version_flag("--version", "sunfleck 0.1.0");
        app_.footer(
            "Example: sunfleck render cornell -o cornell.png --lights 300\n"
            "Exit status: 0 done, 1 failed, 2 the command line is wrong, 128 + N ended by signal N; of the gate\n"
            "(sunfleck bench compare --help) also 3 and 4.");
        for (const auto make :
             {make_render_command, make_reference_command, make_compare_command, make_bench_command, make_info_command})
            commands_.push_back(make(app_));
    }

    // The exit status where there is nothing to run: help was asked for, or the command line is wrong.
    std::optional<int> parse(int argc, const char* const* argv, std::ostream& out, std::ostream& errors) {
        if (argc > 1 && argv[1][0] != '-' && argv[1][0] != '\0' && !is_command(argv[1])) {
            errors << "error: there is no command '" << argv[1] << "'" << suggestion_of(argv[1])
                   << " (sunfleck --help lists them)\n";
            return exit_usage;
        }
        try {
            app_.parse(argc, argv);
        } catch (const CLI::ParseError& error) {
            return app_.exit(error, out, errors) == 0 ? exit_done : exit_usage;
        }
        return std::nullopt;
    }

    int run() const {
        for (const Command& command : commands_)
            if (command.app->parsed())
                return command.run();
        return exit_usage;
    }

private:
    bool is_command(const std::string& name) const {
        return std::any_of(commands_.begin(), commands_.end(),
                           [&](const Command& command) { return command.app->get_name() == name; });
    }
    std::string suggestion_of(const std::string& name) const {
        std::vector<std::string> names;
        names.reserve(commands_.size());
        for (const Command& command : commands_)
            names.push_back(command.app->get_name());
        return viewer::suggestion(name, names);
    }

    CLI::App app_{"Sunfleck: real-time global illumination with hundreds of shadowed light samples."};
    std::vector<Command> commands_;
};

} // namespace

int run_program(int argc, const char* const* argv) {
    Program program;
    const std::optional<int> status = program.parse(argc, argv, std::cout, std::cerr);
    const Result<int> ended = status ? Result<int>(*status) : caught([&] { return Result<int>(program.run()); });
    return ended ? printed(*ended) : fail(ended.error());
}

int check_command_line(int argc, const char* const* argv, std::string& message) {
    Program program;
    std::ostringstream text;
    const int status = program.parse(argc, argv, text, text).value_or(exit_done);
    message = text.str();
    return status;
}

} // namespace sunfleck::command_line
