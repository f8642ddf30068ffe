// A foreign Vulkan program that lights its own frames with the installed package: its own device, its own G-buffer, its
// own frame loop. It runs with 1 to 4 frames in flight and hands its images over in all kinds of layouts; then two
// contexts on two devices take turns; then its G-buffer has other forms (own_projection.h). The validation layer must
// stay silent.
#include "vulkan_program.h"

// [sunfleck: begin]
#include <sunfleck/host.h>

namespace host = sunfleck::host;

struct Lighting {
    std::unique_ptr<host::Context> context;
    std::uint32_t room = 0, box = 0, lamp = 0;
    host::Camera camera{{1.0f, 1.2f, 2.9f}, {0.0f, -0.1f, -1.0f}, {0.0f, 1.0f, 0.0f}, 1.0f};
};

sunfleck::Result<Lighting> make_lighting(const VulkanProgram& program) {
    Lighting lighting;
    SUNFLECK_ASSIGN(lighting.context, host::Context::create({program.instance, program.physical_device, program.device,
                                                             program.queue, 0}));
    SUNFLECK_TRY(lighting.context->set("lights", "60"));
    const std::vector<float> corners = cube_positions();
    SUNFLECK_ASSIGN(const std::uint32_t inside, lighting.context->add_mesh({corners, {}, cube_indices(true)}));
    SUNFLECK_ASSIGN(const std::uint32_t outside, lighting.context->add_mesh({corners, {}, cube_indices(false)}));
    const host::Matrix4 larger = {3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1};
    SUNFLECK_ASSIGN(lighting.room,
                    lighting.context->add_instance({inside, larger, host::Mobility::fixed, {0.7f, 0.6f, 0.5f}}));
    SUNFLECK_ASSIGN(lighting.box, lighting.context->add_instance({outside, host::identity, host::Mobility::moving}));
    SUNFLECK_ASSIGN(lighting.lamp,
                    lighting.context->add_light({host::LightKind::point, {5, 4, 3}, {1.5f, 2.7f, 1.5f}}));
    return lighting;
}

sunfleck::Status update(Lighting& lighting, std::vector<Box>& boxes, const VulkanProgram& program) {
    const auto& [x, y, z] = boxes[1].place;
    const float s = boxes[1].scale;
    SUNFLECK_TRY(lighting.context->set_transform(lighting.box, {s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0, x, y, z, 1}));
    SUNFLECK_TRY(lighting.context->update({program.serial, program.completed}));
    boxes[0].surface = lighting.context->surface_id(lighting.room);
    boxes[1].surface = lighting.context->surface_id(lighting.box);
    return {};
}

host::HostImage host_image(const TargetImage& image, const ImageUse& after) {
    return {image.image,
            image.view,
            {image.now.layout, image.now.stages, image.now.access},
            {after.layout, after.stages, after.access}};
}

sunfleck::Status record(Lighting& lighting, VkCommandBuffer commands, VulkanProgram& program,
                        const ImageUse (&after)[4]) {
    host::FrameImages images{VulkanProgram::width, VulkanProgram::height};
    images.depth = host_image(program.depth, after[0]);
    images.normals = host_image(program.normals, after[1]);
    images.surface = host_image(program.surface, after[2]);
    images.irradiance = host_image(program.irradiance, after[3]);
    return lighting.context->record(commands, lighting.camera, images);
}
// [sunfleck: end]

#include "own_loader.h"
#include "own_projection.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

double milliseconds(const std::function<void()>& what) {
    const auto start = std::chrono::steady_clock::now();
    what();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// The geometry pass of this program, on the CPU: a stage that the module knows nothing of.
std::chrono::steady_clock::time_point geometry_begin;
double geometry_ms = 0.0;

void check(const sunfleck::Status& status) {
    if (status)
        return;
    std::fprintf(stderr, "%s\n", status.error().message.c_str());
    std::exit(1);
}

// States that the images are handed over in, and taken back in: every frame others.
ImageUse colour_state(std::uint64_t frame) {
    const ImageUse states[] = {
        {VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
         VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT},
        {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
         VK_ACCESS_2_SHADER_SAMPLED_READ_BIT},
        {VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT},
        {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT}};
    return states[frame % 4];
}

ImageUse depth_state(std::uint64_t frame) {
    const VkPipelineStageFlags2 tests =
        VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
    const ImageUse states[] = {
        {VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, tests, VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT},
        {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
         VK_ACCESS_2_SHADER_SAMPLED_READ_BIT},
        {VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT}};
    return states[frame % 3];
}

void render(VulkanProgram& program, Lighting& lighting, std::uint64_t k) {
    const float t = 0.2f * float(k);
    std::vector<Box> boxes = {{{0, 0, 0}, 3}, {{1.0f + 0.5f * std::cos(t), 0.0f, 1.0f + 0.5f * std::sin(t)}, 0.7f}};
    program.frame(
        boxes,
        [&] {
            check(update(lighting, boxes, program));
            geometry_begin = std::chrono::steady_clock::now();
        },
        [&] { return host::view_projection(lighting.camera, VulkanProgram::width, VulkanProgram::height); },
        [&](VkCommandBuffer commands) {
            geometry_ms =
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - geometry_begin).count();
            program.transition(commands, program.depth, depth_state(k), true);
            program.transition(commands, program.normals, colour_state(k + 1), false);
            program.transition(commands, program.surface, colour_state(k / 2), false);
            const ImageUse after[4] = {depth_state(k / 3), colour_state(k + 2), colour_state(k / 4),
                                       colour_state(k + 3)};
            check(record(lighting, commands, program, after));
            program.depth.now = after[0];
            program.normals.now = after[1];
            program.surface.now = after[2];
            program.irradiance.now = after[3];
        });
}

// The long first update of a level can be stopped; the next one begins again.
void stop_first_update(Lighting& lighting) {
    int calls = 0;
    host::Frame frame;
    frame.progress = [&](float) { return ++calls > 1; };
    const bool went_on = bool(lighting.context->update(frame));
    check(calls == 1 && !went_on ? sunfleck::Status()
                                 : sunfleck::Status(sunfleck::Error{"an update was not stopped by its host"}));
}

std::string json(const std::vector<host::Statistic>& numbers) {
    std::string text;
    for (const host::Statistic& number : numbers)
        text += (text.empty() ? "\"" : ",\"") + number.name + "\":" + std::to_string(number.value);
    return "{" + text + "}";
}

// [gate: begin]
void serve_gate(VulkanProgram& program, Lighting& lighting) {
    std::puts(R"({"sunfleck_gate":1,"device":"","driver":"","recording":"circle","size":"160x120","frames":60})");
    for (unsigned first, count; std::fflush(stdout) == 0 && std::scanf(" frames %u %u", &first, &count) == 2;)
        for (unsigned frame = first; frame < first + count; ++frame) {
            const double ms = milliseconds([&] { render(program, lighting, frame), program.wait(); });
            host::Statistics all = lighting.context->statistics();
            all.cpu_stages.push_back({"own geometry", geometry_ms, "ms"});
            std::printf(R"({"frame":%u,"frame_ms":%f,"passes":%s,"stages":%s,"counters":%s})", frame, ms,
                        json(all.gpu_passes).c_str(), json(all.cpu_stages).c_str(), json(all.counters).c_str());
            std::puts("");
        }
}
// [gate: end]

int finish(VulkanProgram& program, const char* what) {
    bool finite = true;
    const auto mean = program.mean_irradiance(finite);
    std::printf("%s: mean irradiance %.4f %.4f %.4f W/m2, %d validation messages\n", what, mean[0], mean[1], mean[2],
                program.messages);
    const bool lit = finite && mean[0] > 0.2 && mean[0] > mean[2] && mean[2] > 0.05;
    return lit && program.messages == 0 ? 0 : 1;
}

int run_gate() {
    VulkanProgram program(1, host::enable_features);
    auto lighting = make_lighting(program);
    check(lighting ? sunfleck::Status() : sunfleck::Status(lighting.error()));
    serve_gate(program, *lighting);
    lighting->context.reset();
    return program.messages == 0 ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "--gate") == 0)
        return run_gate();
    if (argc > 1 && std::strcmp(argv[1], "--own-loader") == 0)
        return run_own_loader();
    int failures = 0;
    for (std::uint32_t in_flight = 1; in_flight <= 4; ++in_flight) {
        VulkanProgram program(in_flight, host::enable_features);
        auto lighting = make_lighting(program);
        check(lighting ? sunfleck::Status() : sunfleck::Status(lighting.error()));
        if (in_flight == 1)
            stop_first_update(*lighting);
        for (std::uint64_t k = 0; k < 24; ++k)
            render(program, *lighting, k);
        program.wait();
        failures += finish(program, (std::to_string(in_flight) + " in flight").c_str());
        lighting->context.reset();
    }
    VulkanProgram first(2, host::enable_features), second(3, host::enable_features);
    auto one = make_lighting(first), two = make_lighting(second);
    check(one && two ? sunfleck::Status() : sunfleck::Status(sunfleck::Error{"no context on one of two devices"}));
    for (std::uint64_t k = 0; k < 12; ++k) {
        render(first, *one, k);
        render(second, *two, k + 5);
    }
    first.wait();
    second.wait();
    failures += finish(first, "first of two devices") + finish(second, "second of two devices");
    one->context.reset();
    two->context.reset();
    failures += run_own_projection() + run_own_loader();
    return failures == 0 ? 0 : 1;
}
