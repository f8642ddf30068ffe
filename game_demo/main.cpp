// The demo. With a window: real time, the simulation on its fixed step. Headless: one step a frame, pictures and times
// into a folder.
#include "game_demo/fly_through.h"

#include "engine/app/window.h"
#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/simulation/path_movers.h"
#include "viewer/scene_renderer.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <nlohmann/json.hpp>

namespace {

using namespace sunfleck;
using Clock = std::chrono::steady_clock;

struct Options {
    bool headless = false, validation = false;
    std::uint32_t frames = 0; // 0: until the window is closed
    std::string output, device;
    std::string size = "640x360";
    std::uint32_t lights = 64;
    std::uint32_t width = 640, height = 360;
};

std::filesystem::path scene_file() {
    std::error_code code;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", code);
    const std::filesystem::path installed = program.parent_path() / "../share/sunfleck/scenes/four_pillars.scene.json";
    return std::filesystem::exists(installed, code) ? installed
                                                    : program.parent_path() / "../scenes/four_pillars.scene.json";
}

Status prepare(viewer::SceneRenderer& renderer, const Options& options, viewer::FrameRequest& request) {
    SUNFLECK_TRY(renderer.load(scene_file()));
    gi::Settings settings;
    settings.lights = options.lights;
    settings.shadow_map_resolution = 128;
    request.width = options.width;
    request.height = options.height;
    request.ev100 = viewer::scene_exposure(renderer.registry());
    return renderer.lighting().set_settings(settings);
}

Status write_shot(viewer::SceneRenderer& renderer, const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const io::Picture picture, renderer.read_back());
    return io::write_picture(path, picture);
}

Status run_headless(const Options& options) {
    if (options.output.empty())
        return Error{"--headless needs a folder for its pictures: -o DIR"};
    std::error_code code;
    std::filesystem::create_directories(options.output, code);
    if (code)
        return Error{"cannot make folder '" + options.output + "': " + code.message()};
    SUNFLECK_ASSIGN(const auto device, gpu::Device::create({options.device, options.validation, {}}));
    SUNFLECK_ASSIGN(const auto renderer, viewer::SceneRenderer::create(*device));
    viewer::FrameRequest request;
    SUNFLECK_TRY(prepare(*renderer, options, request));
    const std::uint32_t frames = std::max(options.frames, 1u);
    std::vector<double> times;
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        request.step = frame;
        request.camera = demo::fly_through(frame);
        SUNFLECK_TRY(renderer->render_and_wait(request));
        times.push_back(renderer->statistics().frame_ms);
        if (frame == 0 || frame + 1 == frames || frame == frames / 2) {
            char name[32];
            std::snprintf(name, sizeof name, "frame_%05u.png", frame);
            SUNFLECK_TRY(write_shot(*renderer, std::filesystem::path(options.output) / name));
        }
    }
    std::sort(times.begin(), times.end());
    nlohmann::ordered_json statistics = {{"device", device->traits().name},
                                         {"scene", "four_pillars"},
                                         {"frames", frames},
                                         {"frame_ms",
                                          {{"median", times[times.size() / 2]},
                                           {"p95", times[times.size() * 95 / 100]},
                                           {"min", times.front()},
                                           {"max", times.back()}}},
                                         {"gpu_ms", renderer->statistics().gpu_ms},
                                         {"light_samples", renderer->statistics().counters.light_samples}};
    SUNFLECK_TRY(write_file(std::filesystem::path(options.output) / "stats.json", statistics.dump(2) + "\n"));
    if (device->validation_messages() > 0)
        return Error{"validation printed messages (see above)"};
    return {};
}

// What keys change.
struct Controls {
    bool paused = false, indirect = true, show_samples = false, shot = false;
};

void connect_keys(app::Window& window, Controls& controls) {
    window.on_key = [&](app::Key key) {
        switch (key) {
        case app::Key::escape:
            window.close();
            break;
        case app::Key::space:
            controls.paused = !controls.paused;
            break;
        case app::Key::i:
            controls.indirect = !controls.indirect;
            break;
        case app::Key::s:
            controls.show_samples = !controls.show_samples;
            break;
        case app::Key::p:
            controls.shot = true;
            break;
        case app::Key::f:
            window.toggle_full_screen();
            break;
        }
    };
}

Status run_window(const Options& options) {
    SUNFLECK_ASSIGN(const auto window, app::Window::create("Sunfleck", options.width, options.height));
    SUNFLECK_ASSIGN(const auto device,
                    gpu::Device::create({options.device, options.validation, window->instance_extensions()}));
    SUNFLECK_ASSIGN(const auto renderer, viewer::SceneRenderer::create(*device));
    SUNFLECK_ASSIGN(const auto swapchain, app::Swapchain::create(*device, *window, 2));
    viewer::FrameRequest request;
    SUNFLECK_TRY(prepare(*renderer, options, request));
    gpu::FrameResources blit_resources(*device);
    Controls controls;
    connect_keys(*window, controls);
    log_information("space: pause   i: indirect light   s: light samples   p: picture   f: full screen   esc: quit");

    double simulated = 0;
    auto last = Clock::now();
    for (std::uint32_t frame = 0; !window->should_close() && (options.frames == 0 || frame < options.frames);) {
        window->poll();
        const double elapsed = std::chrono::duration<double>(Clock::now() - last).count();
        last = Clock::now();
        if (!controls.paused)
            simulated += std::min(elapsed, 0.25); // a long stall does not make the world leap
        request.step = std::uint64_t(simulated / simulation::step_seconds);
        request.camera = demo::fly_through(request.step);
        request.show_samples = controls.show_samples;
        gi::Settings settings = renderer->lighting().settings();
        settings.indirect = controls.indirect ? gi::IndirectTechnique::light_samples : gi::IndirectTechnique::none;
        SUNFLECK_TRY(renderer->lighting().set_settings(settings));
        SUNFLECK_ASSIGN(const bool visible, swapchain->acquire(renderer->submission().serial()));
        if (!visible) {
            window->wait(0.05);
            continue;
        }
        SUNFLECK_TRY(renderer->update(request));
        SUNFLECK_ASSIGN(const VkCommandBuffer commands, renderer->submission().begin());
        SUNFLECK_TRY(renderer->record(commands, request));
        SUNFLECK_TRY(swapchain->record_blit(commands, blit_resources, renderer->output()));
        SUNFLECK_TRY(renderer->submission().submit(&swapchain->semaphores()));
        SUNFLECK_TRY(swapchain->present());
        if (controls.shot) {
            controls.shot = false;
            SUNFLECK_TRY(write_shot(*renderer, "sunfleck.png"));
            log_information("wrote sunfleck.png");
        }
        char title[128];
        std::snprintf(title, sizeof title, "Sunfleck  %.0f ms  %u light samples%s%s", elapsed * 1e3, settings.lights,
                      controls.indirect ? "" : "  direct light only", controls.paused ? "  paused" : "");
        window->set_title(title);
        ++frame;
    }
    SUNFLECK_TRY(device->wait_idle());
    if (device->validation_messages() > 0)
        return Error{"validation printed messages (see above)"};
    return {};
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App program("Sunfleck's demo: a fly-through of four_pillars, its movers going round.");
    program.footer("Example: sunfleck_demo --headless --frames 60 -o out");
    program.add_flag("--headless", options.headless, "Render without a window into the folder given by -o");
    program.add_option("--frames", options.frames, "Stop after this many frames");
    program.add_option("-o,--output", options.output, "Folder for pictures and stats.json");
    program.add_option("--size", options.size, "Render size, WIDTHxHEIGHT")->capture_default_str();
    program.add_option("--lights", options.lights, "Light samples")->check(CLI::Range(0, 65536))->capture_default_str();
    program.add_option("--device", options.device, "Vulkan device by number or part of its name");
    program.add_flag("--validation", options.validation, "Khronos validation with synchronisation checks");
    CLI11_PARSE(program, argc, argv);
    if (std::sscanf(options.size.c_str(), "%ux%u", &options.width, &options.height) != 2 || options.width < 1 ||
        options.height < 1 || options.width > 16384 || options.height > 16384) {
        log_error("--size '" + options.size + "': WIDTHxHEIGHT from 1x1 to 16384x16384 is needed");
        return 2;
    }
    const Status status = options.headless ? run_headless(options) : run_window(options);
    if (!status)
        log_error(status.error().message);
    return status ? 0 : 1;
}
