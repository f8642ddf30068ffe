#include "own_projection.h"

#include "vulkan_program.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <sunfleck/host.h>

namespace host = sunfleck::host;

namespace {

constexpr std::uint64_t frames = 8;
constexpr std::uint32_t width = VulkanProgram::width, height = VulkanProgram::height;
const host::Camera own_camera{{1.0f, 1.2f, 2.9f}, {0.0f, -0.1f, -1.0f}, {0.0f, 1.0f, 0.0f}, 1.0f};

enum class Texture { none, plain, half_black };

struct Run {
    GeometryFormats formats;
    bool own_view = true;
    Texture texture = Texture::plain;
    bool refused_frame = false; // the last but one has no images of any size
    const char* name = "";
};

struct Outcome {
    std::vector<float> irradiance, specular;
    host::Statistics statistics;
    int messages = 0;
    bool failed = false;
};

void require(const sunfleck::Status& status) {
    if (status)
        return;
    std::fprintf(stderr, "%s\n", status.error().message.c_str());
    std::exit(1);
}

template <typename T>
T require(sunfleck::Result<T> result) {
    require(result ? sunfleck::Status() : sunfleck::Status(result.error()));
    return std::move(result).value();
}

// As the texture's texels are decoded: the albedo that a plain texture stands for.
float linear(std::uint8_t code) {
    return std::pow((float(code) / 255.0f + 0.055f) / 1.055f, 2.4f);
}

constexpr std::uint8_t codes[3] = {218, 203, 188};

std::vector<std::uint8_t> texels_of(Texture texture) {
    std::vector<std::uint8_t> texels;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int c = 0; c < 4; ++c)
                texels.push_back(c == 3 ? 255 : texture == Texture::half_black && x < 4 ? 0 : codes[c]);
    return texels;
}

struct Lighting {
    std::unique_ptr<host::Context> context;
    std::uint32_t room = 0, box = 0;
};

std::uint32_t add_room(host::Context& context, Texture texture) {
    const std::vector<float> corners = cube_positions();
    std::vector<float> coordinates;
    for (std::size_t face = 0; face < corners.size() / 12; ++face)
        coordinates.insert(coordinates.end(), {0, 0, 1, 0, 1, 1, 0, 1});
    const std::uint32_t mesh = require(context.add_mesh({corners, {}, cube_indices(true), coordinates}));
    const host::Matrix4 larger = {3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1};
    host::InstanceData room{
        mesh, larger, host::Mobility::fixed, {linear(codes[0]), linear(codes[1]), linear(codes[2])}};
    if (texture == Texture::none)
        return require(context.add_instance(room));
    host::MaterialData material;
    material.albedo = {1.0f, 1.0f, 1.0f};
    const std::vector<std::uint8_t> texels = texels_of(texture);
    material.albedo_texture = {texels, 8, 8};
    room.material = require(context.add_material(material));
    return require(context.add_instance(room));
}

Lighting make_lighting(const VulkanProgram& program, Texture texture) {
    Lighting lighting;
    lighting.context =
        require(host::Context::create({program.instance, program.physical_device, program.device, program.queue, 0}));
    require(lighting.context->set("lights", "60"));
    lighting.room = add_room(*lighting.context, texture);
    const std::vector<float> corners = cube_positions();
    const std::uint32_t mesh = require(lighting.context->add_mesh({corners, {}, cube_indices(false)}));
    lighting.box = require(lighting.context->add_instance({mesh, host::identity, host::Mobility::moving}));
    require(lighting.context->add_light({host::LightKind::point, {5, 4, 3}, {1.5f, 2.7f, 1.5f}}));
    return lighting;
}

// own_camera as many programs would have it: view space looks along -Z with Y up; depth is 0 at 0.1 m and 1 at 20 m.
host::View view_of(float jitter_x, float jitter_y) {
    const float near_distance = 0.1f, far_distance = 20.0f;
    const auto& [x, y, z] = own_camera.position;
    const float length = std::hypot(own_camera.forward[1], own_camera.forward[2]); // it looks along no X
    const float fy = own_camera.forward[1] / length, fz = own_camera.forward[2] / length;
    host::View view;
    view.world_to_view = {1, 0, 0, 0, 0, -fz, -fy, 0, 0, fy, -fz, 0, -x, fz * y - fy * z, fy * y + fz * z, 1};
    const float scale = 1.0f / std::tan(0.5f * own_camera.vertical_field_of_view);
    const float range = far_distance / (near_distance - far_distance);
    view.view_to_clip = {scale * float(height) / float(width),
                         0,
                         0,
                         0,
                         0,
                         -scale,
                         0,
                         0,
                         jitter_x / float(width),
                         jitter_y / float(height),
                         range,
                         -1,
                         0,
                         0,
                         range * near_distance,
                         0};
    return view;
}

host::Matrix4 product(const host::Matrix4& a, const host::Matrix4& b) {
    host::Matrix4 result{};
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t r = 0; r < 4; ++r)
            for (std::size_t k = 0; k < 4; ++k)
                result[c * 4 + r] += a[k * 4 + r] * b[c * 4 + k];
    return result;
}

host::HostImage host_image(const TargetImage& image, VkFormat format) {
    const host::ImageState after{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                 VK_ACCESS_2_MEMORY_READ_BIT};
    return {image.image, image.view, {image.now.layout, image.now.stages, image.now.access}, after, format};
}

void record(Lighting& lighting, VulkanProgram& program, VkCommandBuffer commands, const Run& run,
            const host::View& view) {
    host::FrameImages images{width, height};
    images.depth = host_image(program.depth, program.formats.depth);
    images.normals = host_image(program.normals, program.formats.normals);
    images.surface = host_image(program.surface, VK_FORMAT_R32_UINT);
    images.irradiance = host_image(program.irradiance, VK_FORMAT_UNDEFINED);
    images.specular = host_image(program.specular, VK_FORMAT_UNDEFINED);
    require(run.own_view ? lighting.context->record(commands, view, images)
                         : lighting.context->record(commands, own_camera, images));
    for (TargetImage* image :
         {&program.depth, &program.normals, &program.surface, &program.irradiance, &program.specular})
        image->now = {VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT};
}

// The frame is submitted without light. Returns whether the module said so.
bool is_refused(Lighting& lighting, VkCommandBuffer commands, const host::View& view) {
    const sunfleck::Status status = lighting.context->record(commands, view, host::FrameImages{});
    if (!status)
        std::printf("a record without images is refused: %s\n", status.error().message.c_str());
    return !status;
}

void render(VulkanProgram& program, Lighting& lighting, const Run& run, std::uint64_t k, bool& failed) {
    const float t = 0.2f * float(k), s = 0.7f;
    const float x = 1.0f + 0.5f * std::cos(t), z = 1.0f + 0.5f * std::sin(t);
    std::vector<Box> boxes = {{{0, 0, 0}, 3}, {{x, 0.0f, z}, s}};
    const bool last = k + 1 == frames; // still, for the comparison
    const host::View view = view_of(last ? 0.0f : float(k % 3) - 1.0f, last ? 0.0f : float(k % 2) - 0.5f);
    program.frame(
        boxes,
        [&] {
            require(lighting.context->set_transform(lighting.box, {s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0, x, 0, z, 1}));
            require(lighting.context->update({program.serial, program.completed}));
            boxes[0].surface = lighting.context->surface_id(lighting.room);
            boxes[1].surface = lighting.context->surface_id(lighting.box);
        },
        [&] {
            return run.own_view ? product(view.view_to_clip, view.world_to_view)
                                : host::view_projection(own_camera, width, height);
        },
        [&](VkCommandBuffer commands) {
            if (run.refused_frame && k + 2 == frames)
                failed = failed || !is_refused(lighting, commands, view);
            else
                record(lighting, program, commands, run, view);
        });
}

Outcome outcome_of(const Run& run) {
    Outcome outcome;
    VulkanProgram program(1, host::enable_features, run.formats);
    Lighting lighting = make_lighting(program, run.texture);
    for (std::uint64_t k = 0; k < frames; ++k)
        render(program, lighting, run, k, outcome.failed);
    outcome.irradiance = program.read(program.irradiance);
    outcome.specular = program.read(program.specular);
    require(lighting.context->update({program.serial + 1, program.serial}));
    outcome.statistics = lighting.context->statistics();
    lighting.context.reset();
    outcome.messages = program.messages;
    return outcome;
}

double mean(const std::vector<float>& picture) {
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.size(); ++i)
        sum += i % 4 == 3 ? 0.0 : double(picture[i]);
    return sum / (double(picture.size()) * 0.75);
}

// Relative mean square error, and the share of pixels that are off by more than 2 %.
struct Difference {
    double error = 0.0, share = 0.0;
};

Difference difference(const std::vector<float>& a, const std::vector<float>& b) {
    double squares = 0.0, reference = 0.0, off = 0.0;
    for (std::size_t i = 0; i < a.size(); i += 4) {
        bool pixel = false;
        for (std::size_t c = i; c < i + 3; ++c) {
            const double d = double(a[c]) - double(b[c]);
            squares += d * d;
            reference += double(b[c]) * double(b[c]);
            pixel = pixel || std::abs(d) > 0.02 * double(b[c]);
        }
        off += pixel ? 4.0 / double(a.size()) : 0.0;
    }
    return {squares / reference, off};
}

bool has_pass(const host::Statistics& statistics, const std::string& name) {
    for (const host::Statistic& pass : statistics.gpu_passes)
        if (pass.name == name)
            return true;
    return false;
}

int failures = 0;

void expect(bool holds, const std::string& what) {
    if (holds)
        return;
    std::fprintf(stderr, "FAILED: %s\n", what.c_str());
    ++failures;
}

void expect_like(const Outcome& outcome, const Outcome& own, const std::string& name, const Difference& limit) {
    const Difference found = difference(outcome.irradiance, own.irradiance);
    std::printf("%s: mean irradiance %.4f W/m2; against the module's own camera: relative error %.1e, %.2f %% of "
                "pixels beyond 2 %%, %d validation messages\n",
                name.c_str(), mean(outcome.irradiance), found.error, 100.0 * found.share, outcome.messages);
    expect(found.error <= limit.error && found.share <= limit.share, name + ": another picture");
    expect(outcome.messages == 0, name + ": validation messages");
    expect(!outcome.failed, name + ": a record without images was not refused");
    for (const float value : outcome.specular)
        if (value != 0.0f)
            return expect(false, name + ": specular light that nothing reflects");
}

void print_times(const host::Statistics& statistics) {
    std::printf("pass times of frame %llu:", static_cast<unsigned long long>(statistics.gpu_serial));
    for (const host::Statistic& pass : statistics.gpu_passes)
        std::printf(" %s %.2f %s;", pass.name.c_str(), pass.value, pass.unit.c_str());
    std::printf("\n");
}

VkFormat best_depth_format() {
    const VulkanProgram program(1, host::enable_features);
    for (const VkFormat format : {VK_FORMAT_X8_D24_UNORM_PACK32, VK_FORMAT_D32_SFLOAT})
        if (program.has_depth_format(format))
            return format;
    return VK_FORMAT_D16_UNORM;
}

} // namespace

int run_own_projection() {
    const GeometryFormats fine{best_depth_format(), VK_FORMAT_R16G16B16A16_SFLOAT, true};
    const GeometryFormats coarse{VK_FORMAT_D16_UNORM, VK_FORMAT_A2B10G10R10_UNORM_PACK32, true};
    const Outcome own = outcome_of({{}, false, Texture::none});
    const Outcome textured = outcome_of({fine});
    const Outcome half_black = outcome_of({fine, true, Texture::half_black});
    const Outcome rough = outcome_of({coarse});
    const Outcome refused = outcome_of({fine, true, Texture::plain, true});
    // 24 bits tell distances in this room apart by 0.01 mm, 16 bits by 2 mm: shadow edges and creases move by no more.
    expect_like(own, own, "own camera", {0.0, 0.0});
    expect_like(textured, own, "own projection, 24 bits", {5e-5, 0.005});
    expect_like(rough, own, "own projection, 16 bits", {1e-4, 0.01});
    expect_like(refused, textured, "after a refused frame", {0.0, 0.0});
    const double share = mean(half_black.irradiance) / mean(textured.irradiance);
    std::printf("half of the texture black: %.2f of the light\n", share);
    expect(share > 0.3 && share < 0.95, "texels do not count");
    print_times(textured.statistics);
    for (const char* pass : {"depth conversion", "normal conversion"}) {
        expect(has_pass(textured.statistics, pass), std::string(pass) + " was not timed");
        expect(!has_pass(own.statistics, pass), std::string(pass) + " where nothing is to be converted");
    }
    return failures;
}
